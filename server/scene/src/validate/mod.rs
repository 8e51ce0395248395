//! The rules a description has to keep: finite, in range, not degenerate, not too much.
//!
//! Every rule answers with the JSON path, what was found and what is allowed. Nothing is clamped.

mod camera;
mod geometry;
mod infinite;
mod lights;
mod media;
mod phase;
mod render;
mod rules;

use crate::description::{CameraDescription, SceneDescription, VERSION};
use crate::error::SceneError;
use crate::json_path::JsonPath;
use crate::limits::Limits;

pub(crate) use infinite::light_can_arrive;
pub(crate) use media::placed_grid;

impl SceneDescription {
    /// Parses and validates a scene's JSON text; reads no other file.
    ///
    /// # Errors
    /// [`SceneError::Syntax`] if the text is not JSON, [`SceneError::Invalid`] with path, found
    /// and allowed if a value is wrong, [`SceneError::Limit`] if there is too much of something.
    pub fn from_json(text: &str) -> Result<Self, SceneError> {
        let limits = Limits::default();
        let scene = Self::parse(text, &limits)?;
        description(&scene, &limits)?;
        Ok(scene)
    }
}

/// Checks the camera alone.
pub(crate) fn camera(camera: &CameraDescription) -> Result<(), SceneError> {
    camera::check(camera, &JsonPath::Root.field("camera"))
}

/// Checks a whole description; reads no file.
pub(crate) fn description(scene: &SceneDescription, limits: &Limits) -> Result<(), SceneError> {
    all_but_geometry(scene, limits)?;
    let path = JsonPath::Root.field("geometry");
    rules::count(&path, scene.geometry.len(), limits.geometry_entries)?;
    for (i, entry) in scene.geometry.iter().enumerate() {
        geometry::check(entry, &path.index(i), limits)?;
    }
    Ok(())
}

/// Checks everything that an edit can change.
pub(crate) fn all_but_geometry(
    scene: &SceneDescription,
    limits: &Limits,
) -> Result<(), SceneError> {
    let root = JsonPath::Root;
    if scene.version != VERSION {
        return Err(SceneError::invalid(
            root.field("version"),
            scene.version.to_string(),
            VERSION.to_string(),
        ));
    }
    rules::name(&root.field("name"), &scene.name)?;
    camera(&scene.camera)?;

    let path = root.field("lights");
    rules::count(&path, scene.lights.len(), limits.lights)?;
    for (i, light) in scene.lights.iter().enumerate() {
        lights::check(light, &path.index(i))?;
    }
    lights::at_most_one_environment(&scene.lights, &path)?;

    let path = root.field("media");
    rules::count(&path, scene.media.len(), limits.media)?;
    for (i, medium) in scene.media.iter().enumerate() {
        media::check(medium, &path.index(i))?;
    }
    for (i, light) in scene.lights.iter().enumerate() {
        light_can_arrive(light, &format!("lights[{i}]"), &scene.media)?;
    }
    let path = root.field("animation");
    let period = scene.animation.as_ref().and_then(|a| a.period_seconds);
    if let Some(period) = period {
        rules::range(&path.field("period_seconds"), period, 1e-3, rules::LATEST)?;
    }
    render::check(&scene.render, &root.field("render"))
}
