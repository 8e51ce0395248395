//! What the user describes: scene description, import, validation, facts. No GPU, no network.
//!
//! The way of a scene: JSON or a bare model file → [`SceneDescription`] (parsed, every error with
//! its JSON path) → validation → files read from the scene's folder → [`Scene`] → [`SceneFacts`].
//! Files are hostile until proven otherwise: everything read from them is bounded by [`Limits`],
//! checked before use, and refused with an error that names its cause.

mod build;
pub mod description;
mod edit;
mod error;
mod facts;
mod files;
mod import;
mod json_path;
mod limits;
mod load;
pub mod presets;
mod range;
mod scene;
mod schema;
mod validate;

pub use build::{Loaded, build, build_with, outline};
pub use description::SceneDescription;
pub use description::parse::{parse_json, parse_value};
pub use edit::{SceneEdit, apply_edit, check_camera, seen_through};
pub use error::SceneError;
pub use facts::{SceneFacts, facts};
pub use limits::Limits;
pub use load::{load, load_with};
pub use scene::*;
pub use schema::json_schema;
