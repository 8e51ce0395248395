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

/// Looks at a scene through another camera, whose keyframes are left out: a camera that is steered
/// follows no track. Does what [`apply_edit`] does with that camera, but checks the camera alone and
/// builds nothing else anew. On an error both stay as they are.
///
/// # Errors
/// [`SceneError`] with the JSON path in the camera.
pub fn steer(
    description: &mut Arc<SceneDescription>,
    scene: &mut Arc<Scene>,
    camera: &CameraDescription,
) -> Result<(), SceneError> {
    let camera = CameraDescription {
        keyframes: Vec::new(),
        ..camera.clone()
    };
    validate::camera(&camera)?;
    let scene = Arc::make_mut(scene);
    scene.camera = build::camera(&camera);
    let followed = scene.animation.as_ref().filter(|a| a.camera.is_some());
    if let Some(animation) = followed {
        let animation = Animation {
            camera: None,
            ..Animation::clone(animation)
        };
        scene.animation = (animation != Animation::default()).then(|| Arc::new(animation));
    }
    Arc::make_mut(description).camera = camera;
    Ok(())
}
