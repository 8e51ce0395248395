//! The validated scene: what the renderer takes.
//!
//! Every value here has passed `validate`: finite, in range, indices in bounds. SI units,
//! right-handed, +Y up, linear Rec. 709 RGB. World positions are `f64` so that the renderer can
//! subtract the camera before it rounds to `f32`; vertices are `f32` in object space.

use std::sync::Arc;

use glam::{DAffine3, DVec3, Vec3};

use crate::animation::Animation;
use crate::environment::EnvironmentMap;
use crate::geometry::SharedGeometry;
use crate::phase::PhaseFunction;
use crate::shared_grid::SharedGrid;

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

/// Perspective pinhole camera.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Camera {
    /// Unit: m.
    pub position: DVec3,
    /// The point looked at; differs from `position`. Unit: m.
    pub target: DVec3,
    /// Not parallel to the view direction; need not be unit.
    pub up: Vec3,
    /// Full vertical field of view. Unit: radian. Range: (0, π).
    pub vertical_fov: f32,
    /// Exposure value: displayed = curve(radiance · 2^`exposure_ev`). Range: [−24, 24].
    pub exposure_ev: f32,
}

/// A light with a position or a direction.
#[derive(Debug, Clone, PartialEq)]
pub enum Light {
    /// Radiates alike in all directions.
    Point(PointLight),
    /// Radiates into a cone.
    Spot(SpotLight),
    /// Arrives from infinity along one direction.
    Directional(DirectionalLight),
}

impl Light {
    /// Name given by the user, or empty.
    pub fn name(&self) -> &str {
        match self {
            Self::Point(light) => &light.name,
            Self::Spot(light) => &light.name,
            Self::Directional(light) => &light.name,
        }
    }

    /// Whether surfaces block this light.
    pub fn casts_shadows(&self) -> bool {
        match self {
            Self::Point(light) => light.casts_shadows,
            Self::Spot(light) => light.casts_shadows,
            Self::Directional(light) => light.casts_shadows,
        }
    }

    /// Where its light comes from.
    pub fn place(&self) -> LightPlace {
        match self {
            Self::Point(light) => LightPlace::At(light.position),
            Self::Spot(light) => LightPlace::At(light.position),
            Self::Directional(light) => LightPlace::Infinity(light.direction),
        }
    }

    /// Where it is; `None` at infinity. Unit: m.
    pub fn position(&self) -> Option<DVec3> {
        match self.place() {
            LightPlace::At(position) => Some(position),
            LightPlace::Infinity(_) => None,
        }
    }

    /// Distances below this count as this in 1/d²; 0 at infinity. Unit: m.
    pub fn radius(&self) -> f32 {
        match self {
            Self::Point(light) => light.radius,
            Self::Spot(light) => light.radius,
            Self::Directional(_) => 0.0,
        }
    }

    /// Its intensity (W·sr⁻¹), or the irradiance of a light at infinity (W·m⁻²), per channel.
    pub fn strength(&self) -> [f32; 3] {
        match self {
            Self::Point(light) => light.intensity,
            Self::Spot(light) => light.intensity,
            Self::Directional(light) => light.irradiance,
        }
    }

    /// Whether it sends anything at all.
    pub fn is_lit(&self) -> bool {
        self.strength().iter().any(|channel| *channel > 0.0)
    }
}

/// Where a light's rays start.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LightPlace {
    /// At a point. Unit: m.
    At(DVec3),
    /// Infinitely far away, travelling along this unit direction.
    Infinity(Vec3),
}

/// Isotropic point light.
#[derive(Debug, Clone, PartialEq)]
pub struct PointLight {
    /// Name given by the user, or empty.
    pub name: String,
    /// Unit: m.
    pub position: DVec3,
    /// Unit: W·sr⁻¹ per channel; ≥ 0.
    pub intensity: [f32; 3],
    /// Distances below this count as this in 1/d². Unit: m; > 0.
    pub radius: f32,
    /// Whether surfaces block this light.
    pub casts_shadows: bool,
}

/// Point light restricted to a cone, glTF's angular falloff:
/// `clamp((cosθ − cos_outer) / (cos_inner − cos_outer), 0, 1)²`.
#[derive(Debug, Clone, PartialEq)]
pub struct SpotLight {
    /// Name given by the user, or empty.
    pub name: String,
    /// Unit: m.
    pub position: DVec3,
    /// Unit axis of the cone, along propagation.
    pub direction: Vec3,
    /// On the axis. Unit: W·sr⁻¹ per channel; ≥ 0.
    pub intensity: [f32; 3],
    /// Full intensity inside. Unit: radian. 0 ≤ inner < outer.
    pub inner_angle: f32,
    /// Dark outside. Unit: radian. Range: (0, π/2).
    pub outer_angle: f32,
    /// Distances below this count as this in 1/d². Unit: m; > 0.
    pub radius: f32,
    /// Whether surfaces block this light.
    pub casts_shadows: bool,
}

/// Parallel light from infinity.
#[derive(Debug, Clone, PartialEq)]
pub struct DirectionalLight {
    /// Name given by the user, or empty.
    pub name: String,
    /// Unit direction in which the light travels.
    pub direction: Vec3,
    /// On a plane perpendicular to `direction`. Unit: W·m⁻² per channel; ≥ 0.
    pub irradiance: [f32; 3],
    /// Whether surfaces block this light.
    pub casts_shadows: bool,
}

/// Radiance from infinity.
#[derive(Debug, Clone, PartialEq)]
pub struct Environment {
    /// Multiplies the map, or is the radiance itself. Unit: W·m⁻²·sr⁻¹.
    pub radiance: [f32; 3],
    /// Equirectangular map, if any.
    pub map: Option<EnvironmentMap>,
    /// Rotation of the map about +Y: a direction of the world is this rotation times a direction of
    /// the map, so a positive angle turns −Z toward −X. Unit: radian.
    pub rotation: f32,
}

/// One participating medium.
#[derive(Debug, Clone, PartialEq)]
pub struct Medium {
    /// Name given by the user, or empty.
    pub name: String,
    /// Scattering coefficient where the relative density is 1. Unit: m⁻¹ per channel; ≥ 0.
    pub sigma_s: [f32; 3],
    /// Absorption coefficient where the relative density is 1. Unit: m⁻¹ per channel; ≥ 0.
    pub sigma_a: [f32; 3],
    /// Into which directions it scatters.
    pub phase: PhaseFunction,
    /// Emitted radiance per metre where the relative density is 1. Unit: W·m⁻³·sr⁻¹.
    pub emission: [f32; 3],
    /// Where it is and how its relative density varies.
    pub shape: MediumShape,
}

/// Spatial distribution of a medium's relative density.
#[derive(Debug, Clone, PartialEq)]
pub enum MediumShape {
    /// Density 1 inside the bounds, or everywhere.
    Homogeneous {
        /// `None` fills space.
        bounds: Option<Aabb>,
    },
    /// Density `exp(−falloff · ⟨x − origin, up⟩)` inside the bounds, or everywhere.
    HeightFog {
        /// Unit direction in which the density falls.
        up: Vec3,
        /// Unit: m⁻¹; ≥ 0.
        falloff: f32,
        /// A point where the density is 1. Unit: m.
        origin: DVec3,
        /// `None` fills space.
        bounds: Option<Aabb>,
    },
    /// Density `1 − r²/R²` inside the sphere.
    Sphere {
        /// Unit: m.
        center: DVec3,
        /// R. Unit: m; > 0.
        radius: f64,
    },
    /// Density of a voxel grid, trilinear between its samples, 0 outside its clip box.
    Grid {
        /// Samples. Compared by identity, not by content.
        grid: SharedGrid,
        /// From lattice points to the world: the description's transform after the grid's own
        /// placement. Unit: m. Invertible.
        world_from_lattice: DAffine3,
    },
}

/// Axis-aligned box, `min < max` in every component. Unit: m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Aabb {
    /// Lowest corner.
    pub min: DVec3,
    /// Highest corner.
    pub max: DVec3,
}

/// How to render: technique, size, when to stop.
#[derive(Debug, Clone, PartialEq)]
pub struct RenderSettings {
    /// What transports the light.
    pub technique: Technique,
    /// Pixels. Range: [1, 16384].
    pub width: u32,
    /// Pixels. Range: [1, 16384].
    pub height: u32,
    /// When a still picture is finished.
    pub stop: StopRule,
    /// When traced samples correct the technique's picture.
    pub correction: CorrectionMode,
    /// Seed of every random number.
    pub seed: u64,
    /// Settings of the `single_scattering` march.
    pub single_scattering: SingleScatteringSettings,
    /// Which paths the `reference` counts.
    pub reference: ReferenceSettings,
    /// How visibility toward lights is found.
    pub shadows: ShadowSettings,
}

/// When unbiased traced samples correct the technique's picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum CorrectionMode {
    /// Never.
    Off,
    /// Where nothing moves.
    AtRest,
    /// In every frame.
    Always,
}

/// The techniques of the design; not all are rendered yet (the renderer refuses by name).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[allow(
    missing_docs,
    reason = "the names are the field's and are documented in ARCHITECTURE.md"
)]
pub enum Technique {
    Auto,
    SingleScattering,
    InstantVpl,
    PrincipalOrdinates,
    ScreenSpace,
    Reference,
}

impl Technique {
    /// The technique's one name: JSON key, file, metric label.
    pub fn name(self) -> &'static str {
        match self {
            Self::Auto => "auto",
            Self::SingleScattering => "single_scattering",
            Self::InstantVpl => "instant_vpl",
            Self::PrincipalOrdinates => "principal_ordinates",
            Self::ScreenSpace => "screen_space",
            Self::Reference => "reference",
        }
    }
}

/// When a still picture is finished.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum StopRule {
    /// After so many accumulated samples a pixel. Range: [1, 65536].
    Samples(u32),
    /// After so many seconds of rendering.
    Seconds(f32),
    /// When the estimated relative error falls below this.
    RelativeError(f32),
}

/// Settings of the ray march.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SingleScatteringSettings {
    /// Strata a ray, each sampled once. Range: [1, 4096].
    pub steps: u32,
    /// Random position inside each stratum; otherwise its midpoint.
    pub jitter: bool,
    /// Side M of the tile of pixels that share the strata of one ray: 1, 2, 4 or 8.
    pub interleave: u32,
    /// Whether one of every 2×2 pixels is marched and the others are interpolated.
    pub half_resolution: bool,
    /// Whether half of the strata of lights with a position are equiangular about them.
    pub equiangular: bool,
}

/// Which paths the `reference` counts: those that keep all three rules.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct ReferenceSettings {
    /// Most scatterings of a path on surfaces and in media.
    pub max_scatterings: Option<u32>,
    /// Most scatterings on surfaces.
    pub max_surface_scatterings: Option<u32>,
    /// How often a path scatters in media.
    pub medium_order: MediumOrder,
}

/// How often a path scatters in media.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum MediumOrder {
    /// Any number of times.
    #[default]
    All,
    /// Never.
    None,
    /// Exactly once.
    Single,
    /// At least twice.
    Multiple,
}

/// How visibility toward lights is found.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ShadowSettings {
    /// Method.
    pub mode: ShadowMode,
    /// Side of a shadow map. Unit: texel. Range: [16, 8192].
    pub resolution: u32,
}

/// Method of visibility.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum ShadowMode {
    /// Every light sees everything.
    Off,
    /// Rasterized depth maps.
    Mapped,
    /// Rays through the BVH: exact, slower.
    Traced,
}
