//! The rules a description has to keep: finite, in range, not degenerate, not too much.
//!
//! Every rule answers with the JSON path, what was found and what is allowed. Nothing is clamped.

mod camera;
mod geometry;
mod infinite;
mod lights;
mod media;
mod render;
mod rules;

use crate::description::{SceneDescription, VERSION};
use crate::error::SceneError;
use crate::json_path::JsonPath;
use crate::limits::Limits;

pub(crate) use infinite::light_can_arrive;
pub(crate) use media::placed_grid;

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
    camera::check(&scene.camera, &root.field("camera"))?;

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
    render::check(&scene.render, &root.field("render"))
}
