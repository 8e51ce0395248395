//! From a description to the scene that the renderer takes.

mod parts;
mod tracks;

use std::path::Path;
use std::sync::Arc;

use crate::description::{CameraDescription, GeometryDescription, SceneDescription};
use crate::error::SceneError;
use crate::files::Folder;
use crate::import::{self, Assets, Grids, Imported};
use crate::limits::Limits;
use crate::scene::{Geometry, Scene, SharedGeometry};
use crate::validate;

pub(crate) use parts::{camera, scene};

/// A scene together with what it was made from.
#[derive(Debug, Clone)]
pub struct Loaded {
    /// The description. Lights of glTF files have moved into `lights`, and `import_lights` is
    /// off, so that building it again gives the same scene.
    pub description: SceneDescription,
    /// What the renderer takes.
    pub scene: Scene,
    /// What was left out or approximated, one sentence each.
    pub warnings: Vec<String>,
    /// Files that it was made from, by their names in the scene's folder.
    pub files: Vec<String>,
}

/// Validates a description, reads its files from `folder` and builds the scene.
///
/// Without a folder the description may not refer to files.
///
/// # Errors
/// [`SceneError`] with the JSON path of what is wrong.
pub fn build(description: SceneDescription, folder: Option<&Path>) -> Result<Loaded, SceneError> {
    build_with(description, folder, &Limits::default())
}

/// [`build`] with other limits.
///
/// # Errors
/// [`SceneError`] with the JSON path of what is wrong.
pub fn build_with(
    description: SceneDescription,
    folder: Option<&Path>,
    limits: &Limits,
) -> Result<Loaded, SceneError> {
    with_file_camera(description, folder, limits).map(|(loaded, _)| loaded)
}

/// [`build_with`] of a scene without files, for what only asks how large things are: every procedural
/// grid stands as a block of density 1 where it would be, so that its making takes no time. What follows
/// from the densities is the most that it could be.
///
/// # Errors
/// [`SceneError`] with the JSON path of what is wrong.
pub fn outline(description: SceneDescription, limits: &Limits) -> Result<Loaded, SceneError> {
    whole(description, None, limits, Grids::Outlined).map(|(loaded, _)| loaded)
}

/// [`build_with`], and the first perspective camera of the files.
pub(crate) fn with_file_camera(
    description: SceneDescription,
    folder: Option<&Path>,
    limits: &Limits,
) -> Result<(Loaded, Option<CameraDescription>), SceneError> {
    whole(description, folder, limits, Grids::Made)
}

fn whole(
    mut description: SceneDescription,
    folder: Option<&Path>,
    limits: &Limits,
    grids: Grids,
) -> Result<(Loaded, Option<CameraDescription>), SceneError> {
    validate::description(&description, limits)?;
    let folder = Folder::open(folder, limits)?;
    let mut imported = import::geometry(&description.geometry, &folder, limits)?;
    let file_camera = imported.camera.take();
    let (geometry, mut warnings) = adopt(&mut description, imported, limits)?;
    let assets = Assets::load(&description, &folder, limits, grids, &mut warnings)?;
    let scene = scene(
        &description,
        SharedGeometry(Arc::new(geometry)),
        assets,
        0.0,
    )?;
    let loaded = Loaded {
        description,
        scene,
        warnings,
        files: folder.found(),
    };
    Ok((loaded, file_camera))
}

/// Moves the lights of glTF files into the description.
fn adopt(
    description: &mut SceneDescription,
    imported: Imported,
    limits: &Limits,
) -> Result<(Geometry, Vec<String>), SceneError> {
    let has_files = |entry: &GeometryDescription| matches!(entry, GeometryDescription::Gltf(gltf) if gltf.import_lights);
    if description.geometry.iter().any(has_files) {
        for entry in Arc::make_mut(&mut description.geometry) {
            if let GeometryDescription::Gltf(gltf) = entry {
                gltf.import_lights = false;
            }
        }
    }
    for (entry, light) in imported.lights {
        let path = format!("geometry[{entry}].path");
        validate::light_can_arrive(&light, &path, &description.media)?;
        description.lights.push(light);
    }
    // The file's lights keep the same rules as written ones.
    validate::all_but_geometry(description, limits)?;
    Ok((imported.geometry, imported.warnings))
}
