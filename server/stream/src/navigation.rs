//! Messages about steering: how, how far, what lies under the pointer, why a picture is black.

use serde::{Deserialize, Serialize};
use ts_rs::TS;
use tyndall_scene::description::{Bounds, Navigation};

/// Where the eye is; exposure stays as it is, keyframes are left.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, TS)]
#[serde(deny_unknown_fields)]
pub struct CameraPose {
    /// Unit: m.
    pub position: [f64; 3],
    /// The point looked at. Unit: m.
    pub target: [f64; 3],
    /// Any length; not parallel to the view direction.
    pub up: [f64; 3],
    /// Full vertical field of view. Unit: degree.
    pub vertical_fov_degrees: f64,
}

/// Asks what lies under a place of the picture that the session's camera sees.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, TS)]
#[serde(deny_unknown_fields)]
pub struct Pick {
    /// The client's number of the question; the answer carries it.
    pub request: u32,
    /// Shares of the picture's width and height, from the left upper corner. Range: 0 to 1.
    pub place: [f64; 2],
}

/// Asks why the picture that the session's camera sees is black.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, TS)]
#[serde(deny_unknown_fields)]
pub struct ExplainDarkness {
    /// The client's number of the question; the answer carries it.
    pub request: u32,
}

/// How to steer through the open scene. Follows the scene as soon as it is known.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, TS)]
pub struct NavigationMessage {
    /// The scene's epoch.
    pub epoch: u32,
    /// What the scene says, or what suits it.
    pub mode: Navigation,
    /// Box around what is worth looking at. Unit: m.
    pub bounds: Bounds,
    /// What an orbit of the scene's own camera turns about. Unit: m.
    pub pivot: [f64; 3],
    /// Where to stand to see most of a scene whose surfaces surround its camera.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[ts(optional)]
    pub overview: Option<ViewPoint>,
}

/// A place to stand and a point to look at.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, TS)]
pub struct ViewPoint {
    /// Unit: m.
    pub position: [f64; 3],
    /// Unit: m.
    pub target: [f64; 3],
}

/// A surface stopped the eye: the camera that is shown instead of the one that was sent.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, TS)]
pub struct CameraMessage {
    /// Input number of the camera that was sent.
    pub input: u64,
    /// Where the eye is.
    pub camera: CameraPose,
}

/// Answers a pick.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, TS)]
pub struct PickedMessage {
    /// Number of the question.
    pub request: u32,
    /// What lies there; nothing where one sees past everything.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[ts(optional)]
    pub hit: Option<PickedPoint>,
}

/// A point of the scene under a place of the picture.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, TS)]
pub struct PickedPoint {
    /// Of what.
    pub kind: PickedKind,
    /// Unit: m.
    pub point: [f64; 3],
    /// Unit normal of a surface, toward the eye.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[ts(optional)]
    pub normal: Option<[f64; 3]>,
}

/// What was picked.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, TS)]
#[serde(rename_all = "snake_case")]
pub enum PickedKind {
    /// A surface.
    Surface,
    /// The middle of smoke, a cloud or bounded fog.
    Medium,
}

/// Answers the question why the picture is black.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, TS)]
pub struct DarknessMessage {
    /// Number of the question.
    pub request: u32,
    /// The first reason that applies.
    pub cause: DarknessCause,
}

/// Why a picture is black.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, TS)]
#[serde(rename_all = "snake_case")]
pub enum DarknessCause {
    /// Nothing in the scene gives light.
    NoLight,
    /// The eye is inside a solid thing.
    InsideSolid,
    /// A surface right in front of the eye hides everything.
    AtSurface,
    /// Nothing of the scene is in the picture.
    LooksAway,
    /// What is in the picture gets no light, or too little for the exposure.
    Unlit,
}
