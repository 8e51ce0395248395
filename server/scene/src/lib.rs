//! What the user describes: scene description, import, validation, facts. No GPU, no network.
//!
//! The way of a scene: JSON or a bare model file → [`SceneDescription`] (parsed, every error with
//! its JSON path) → validation → files read from the scene's folder → [`Scene`] → [`SceneFacts`].
//! Files are hostile until proven otherwise: everything read from them is bounded by [`Limits`],
//! checked before use, and refused with an error that names its cause.

mod animation;
mod build;
pub mod description;
mod edit;
mod environment;
mod error;
mod facts;
mod files;
mod geometry;
mod hull;
mod import;
mod json_path;
mod limits;
mod load;
pub mod presets;
mod scene;
mod schema;
mod shared_grid;
mod tracks;
mod validate;

pub use animation::{
    Animation, CameraKey, Direction, Interpolate, LightTrack, Placement, SpotKey, Track,
};
pub use build::{Loaded, build, build_with};
pub use description::SceneDescription;
pub use description::parse::{parse_json, parse_value};
pub use edit::{SceneEdit, apply_edit, steer};
pub use environment::{EnvironmentDistribution, EnvironmentMap, EnvironmentSample};
pub use error::SceneError;
pub use facts::{SceneFacts, facts};
pub use geometry::*;
pub use limits::Limits;
pub use load::{load, load_with};
pub use scene::*;
pub use schema::json_schema;
pub use shared_grid::{GridStats, SharedGrid};
