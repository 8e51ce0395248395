//! The eye.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use ts_rs::TS;

/// Perspective pinhole camera.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema, TS)]
#[serde(deny_unknown_fields)]
pub struct CameraDescription {
    /// Unit: m.
    pub position: [f64; 3],
    /// The point looked at; at least 1e−6 m from `position`. Unit: m.
    pub target: [f64; 3],
    /// Any length; not parallel to the view direction.
    #[serde(default = "up")]
    pub up: [f64; 3],
    /// Full vertical field of view. Unit: degree. Range: 0.1 to 170.
    #[serde(default = "vertical_fov_degrees")]
    pub vertical_fov_degrees: f64,
    /// Exposure value: displayed = curve(radiance · 2^`exposure_ev`). Range: −24 to 24.
    #[serde(default)]
    pub exposure_ev: f64,
    /// Where the camera is at which time, in order of time; replaces the pose above.
    /// Linear in between.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[ts(optional, as = "Option<Vec<CameraKeyframe>>")]
    pub keyframes: Vec<CameraKeyframe>,
}

/// The camera at one time.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema, TS)]
#[serde(deny_unknown_fields)]
#[ts(optional_fields)]
pub struct CameraKeyframe {
    /// Later than the keyframe before. Unit: s. Range: 0 to 1e6.
    pub time_seconds: f64,
    /// Unit: m.
    pub position: [f64; 3],
    /// Unit: m.
    pub target: [f64; 3],
    /// The camera's own field of view if left out. Unit: degree. Range: 0.1 to 170.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub vertical_fov_degrees: Option<f64>,
}

pub(crate) fn up() -> [f64; 3] {
    [0.0, 1.0, 0.0]
}

pub(crate) fn vertical_fov_degrees() -> f64 {
    50.0
}
