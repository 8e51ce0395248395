//! Changes to an open scene that leave its geometry alone.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use ts_rs::TS;

use crate::build;
use crate::description::{
    CameraDescription, LightDescription, MediumDescription, RenderDescription, SceneDescription,
};
use crate::error::SceneError;
use crate::limits::Limits;
use crate::scene::{Scene, SharedGeometry};
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
}

/// Applies an edit to a scene and its description.
///
/// The geometry is shared with the scene before, so nothing is read or uploaded again. An edit
/// can't name files that the scene doesn't use already: there is no folder to look them up in.
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
    no_new_files(description, &edited)?;
    let scene = build::scene(&edited, SharedGeometry(scene.geometry.0.clone()));
    Ok((edited, scene))
}

/// Files of the edited scene are files of the scene before.
fn no_new_files(before: &SceneDescription, after: &SceneDescription) -> Result<(), SceneError> {
    let known: Vec<&str> = files(before).map(|(_, file)| file).collect();
    match files(after).find(|(_, file)| !known.contains(file)) {
        None => Ok(()),
        Some((path, file)) => Err(SceneError::invalid(
            path,
            format!("\"{}\"", crate::description::parse::abbreviate(file)),
            "a file that the scene uses already; open a scene to use another",
        )),
    }
}

/// Files of lights and media with their JSON paths.
fn files(scene: &SceneDescription) -> impl Iterator<Item = (String, &str)> {
    let maps = scene.lights.iter().enumerate().filter_map(|(i, light)| {
        let LightDescription::Environment(light) = light else {
            return None;
        };
        let map = light.map.as_deref()?;
        Some((format!("lights[{i}].map"), map))
    });
    let grids = scene.media.iter().enumerate().filter_map(|(i, medium)| {
        let MediumDescription::Grid(grid) = medium else {
            return None;
        };
        Some((format!("media[{i}].path"), grid.path.as_str()))
    });
    maps.chain(grids)
}
