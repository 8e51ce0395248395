//! The validated scene: what the renderer takes.
//!
//! Every value here has passed `validate`: finite, in range, indices in bounds. SI units,
//! right-handed, +Y up, linear Rec. 709 RGB. World positions are `f64` so that the renderer can
//! subtract the camera before it rounds to `f32`; vertices are `f32` in object space.
//!
//! The parts know nothing of the whole, and nothing here knows of descriptions and files.

mod animation;
mod at;
mod camera;
mod change;
mod density_integral;
mod environment;
mod geometry;
mod grid;
mod lights;
mod media;
mod phase;
mod screen_space;
mod settings;
mod space;
mod tracks;

use std::sync::Arc;

pub use animation::{Animation, LightTrack};
pub use camera::Camera;
pub use change::ChangeSet;
pub use environment::{Environment, EnvironmentDistribution, EnvironmentMap, EnvironmentSample};
pub use geometry::{
    ColorSpace, Geometry, Instance, Material, Mesh, PlacementTrack, SharedGeometry, Surfaces,
    Texture, TextureRef, Wrap,
};
pub use grid::{GridStats, SharedGrid};
pub use lights::{DirectionalLight, Light, LightPlace, PointLight, SpotLight};
pub use media::{Medium, MediumShape};
pub use phase::{PhaseFunction, PhaseParameters};
pub use screen_space::{LevelFetch, ScreenSpaceFilter, ScreenSpaceSettings, SpreadModel};
pub use settings::{
    CorrectionMode, MediumOrder, ReferenceSettings, RenderSettings, ShadowMode, ShadowSettings,
    SingleScatteringSettings, StopRule, Technique,
};
pub use space::Aabb;
pub(crate) use space::{Hull, box_corners, is_invertible};
pub use tracks::{CameraKey, Direction, Interpolate, Placement, SpotKey, Track};

/// A scene ready to be rendered. Cloning is cheap: the geometry is shared.
#[derive(Debug, Clone, PartialEq)]
pub struct Scene {
    /// Name shown to users; empty when the description gives none.
    pub name: String,
    /// The eye.
    pub camera: Camera,
    /// Triangles, materials and textures. Compared by identity, not by content.
    pub geometry: SharedGeometry,
    /// Lights with a position or a direction.
    pub lights: Vec<Light>,
    /// Radiance arriving from infinity, if any.
    pub environment: Option<Environment>,
    /// Participating media; where they overlap their coefficients add up.
    pub media: Vec<Medium>,
    /// How to render.
    pub render: RenderSettings,
    /// How camera and lights move; `None` if they stand still. Instances keep their own tracks in
    /// `geometry`.
    pub animation: Option<Arc<Animation>>,
    /// The time at which camera, lights and instances are as they are here. Unit: s.
    pub time_seconds: f64,
}
