//! Scene description, version 1: the JSON that users, the page and jobs exchange.
//!
//! SI units; right-handed, +Y up; linear Rec. 709 RGB; angles in degrees and named so. Every
//! object refuses unknown fields; every union is tagged by `kind`. The types only hold what was
//! written: ranges are checked by `validate`, files are read by `import`.

pub mod camera;
pub mod geometry;
pub mod lights;
pub mod media;
pub mod navigation;
pub mod parse;
pub mod phase;
pub mod render;
mod tagged;
pub mod values;

use std::sync::Arc;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use ts_rs::TS;

use crate::error::{SceneError, abbreviate};
use crate::limits::Limits;

pub use camera::{CameraDescription, CameraKeyframe};
pub use geometry::{GeometryDescription, MaterialDescription};
pub use lights::LightDescription;
pub use media::MediumDescription;
pub use navigation::Navigation;
pub use phase::PhaseDescription;
pub use render::RenderDescription;
pub use values::{Bounds, Rgb, Scale, Transform};

/// The version of the format this library reads.
pub const VERSION: u32 = 1;

/// A whole scene.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema, TS)]
#[serde(deny_unknown_fields)]
#[ts(optional_fields)]
pub struct SceneDescription {
    /// Version of the format: 1.
    #[schemars(range(min = 1, max = 1))]
    pub version: u32,
    /// Name shown to users. At most 200 characters.
    #[serde(default)]
    pub name: String,
    /// The eye.
    pub camera: CameraDescription,
    /// How a page steers the camera. If left out: `look` where surfaces surround the camera, else `orbit`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub navigation: Option<Navigation>,
    /// Surfaces. Shared, since edits never change it.
    #[serde(default)]
    pub geometry: Arc<Vec<GeometryDescription>>,
    /// Lights, at most one of them an environment.
    #[serde(default)]
    pub lights: Vec<LightDescription>,
    /// Participating media; where they overlap their coefficients add up.
    #[serde(default)]
    pub media: Vec<MediumDescription>,
    /// How to render.
    #[serde(default)]
    pub render: RenderDescription,
    /// How time goes on; matters only with keyframes.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub animation: Option<AnimationDescription>,
}

/// How time goes on.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema, TS)]
#[serde(deny_unknown_fields, default)]
#[ts(optional_fields)]
pub struct AnimationDescription {
    /// After which everything starts over; without it everything keeps the state of its last
    /// keyframe. Unit: s. Range: 0.001 to 1e6.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub period_seconds: Option<f64>,
}

impl SceneDescription {
    /// Parses without checking ranges.
    pub(crate) fn parse(text: &str, limits: &Limits) -> Result<Self, SceneError> {
        let found = text.len() as u64;
        if found > limits.scene_bytes {
            return Err(SceneError::Limit {
                path: String::new(),
                what: "size in bytes",
                found,
                limit: limits.scene_bytes,
            });
        }
        // The version first: fields unknown to this version should not hide the cause.
        let probe: VersionProbe = parse::parse_json(text)?;
        if probe.version != VERSION {
            let found = match &probe.version {
                serde_json::Value::Null => "nothing".to_owned(),
                other => abbreviate(&other.to_string()),
            };
            return Err(SceneError::invalid("version", found, "1"));
        }
        parse::parse_json(text)
    }

    /// The scene as indented JSON text.
    ///
    /// # Errors
    /// Only if a number is not finite, which validated descriptions exclude.
    pub fn to_json(&self) -> Result<String, SceneError> {
        serde_json::to_string_pretty(self)
            .map_err(|error| SceneError::invalid("", error.to_string(), "finite numbers"))
    }
}

/// Reads the version and nothing else.
#[derive(Deserialize)]
struct VersionProbe {
    #[serde(default)]
    version: serde_json::Value,
}
