//! Changes to an open scene that leave its geometry alone.

use std::sync::Arc;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use ts_rs::TS;

use crate::build;
use crate::description::{
    CameraDescription, LightDescription, MediumDescription, RenderDescription, SceneDescription,
};
use crate::error::SceneError;
use crate::import::Assets;
use crate::limits::Limits;
use crate::scene::{Animation, Scene, SharedGeometry};
use crate::validate;

/// A change to a scene. What is left out stays as it is; a list replaces the whole list.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema, TS)]
#[serde(deny_unknown_fields, default)]
#[ts(optional_fields)]
pub struct SceneEdit {
    /// The new camera.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub camera: Option<CameraDescription>,
    /// The camera's new exposure, after `camera`. Unit: EV. Range: −24 to 24.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub exposure_ev: Option<f64>,
    /// All lights, the environment among them.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lights: Option<Vec<LightDescription>>,
    /// All media.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub media: Option<Vec<MediumDescription>>,
    /// How to render.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub render: Option<RenderDescription>,
    /// The time to show. Unit: s. Range: 0 to 1e6.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub time_seconds: Option<f64>,
    /// Whether time goes on from there; only a session has a clock.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub playing: Option<bool>,
}

/// Applies an edit to a scene and its description.
///
/// Geometry, grids and the environment map are shared with the scene before, so nothing is read or
/// uploaded again. An edit can't name files and procedural grids that the scene doesn't hold
/// already: there is no folder to look files up in, and an edit takes no longer than a frame.
///
/// # Errors
/// [`SceneError`] with the JSON path in the edited scene; the scene before stays valid.
pub fn apply_edit(
    description: &SceneDescription,
    scene: &Scene,
    edit: &SceneEdit,
) -> Result<(SceneDescription, Scene), SceneError> {
    let mut edited = description.clone();
    if let Some(camera) = &edit.camera {
        edited.camera = camera.clone();
    }
    if let Some(exposure_ev) = edit.exposure_ev {
        edited.camera.exposure_ev = exposure_ev;
    }
    if let Some(lights) = &edit.lights {
        edited.lights.clone_from(lights);
    }
    if let Some(media) = &edit.media {
        edited.media.clone_from(media);
    }
    if let Some(render) = &edit.render {
        edited.render = render.clone();
    }
    validate::all_but_geometry(&edited, &Limits::default())?;
    let assets = Assets::kept(description, scene, &edited)?;
    let geometry = SharedGeometry(scene.geometry.0.clone());
    let seconds = edit.time_seconds.unwrap_or(scene.time_seconds);
    let scene = build::scene(&edited, geometry, assets, seconds)?;
    Ok((edited, scene))
}

/// Checks a camera alone: what [`seen_through`] asks of it. Looks at nothing else of a scene.
///
/// # Errors
/// [`SceneError`] with the JSON path in the camera.
pub fn check_camera(camera: &CameraDescription) -> Result<(), SceneError> {
    validate::camera(camera)
}

/// A scene seen through another camera, which [`check_camera`] let pass; its keyframes are left out: a
/// camera that is steered follows no track. Gives what [`apply_edit`] gives with that camera, but builds
/// nothing else anew.
pub fn seen_through(scene: &Scene, camera: &CameraDescription) -> Scene {
    let mut seen = Scene {
        camera: build::camera(camera),
        ..scene.clone()
    };
    let followed = seen.animation.as_ref().filter(|a| a.camera.is_some());
    if let Some(animation) = followed {
        let animation = Animation {
            camera: None,
            ..Animation::clone(animation)
        };
        seen.animation = (animation != Animation::default()).then(|| Arc::new(animation));
    }
    seen
}
