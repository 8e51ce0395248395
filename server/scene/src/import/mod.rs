//! Geometry of a description: model files, inline meshes and primitives, all through one set of
//! limits and one cleaning step.

mod animated;
mod assets;
mod environment;
mod gltf;
mod images;
mod importer;
mod inline;
mod mirror;
mod obj;
mod shapes;
mod surface;
mod transform;

use crate::description::GeometryDescription;
use crate::error::SceneError;
use crate::files::Folder;
use crate::limits::Limits;

use importer::Importer;

pub(crate) use assets::{Assets, Grids};
pub(crate) use importer::Imported;

/// Imports all geometry of a validated description.
pub(crate) fn geometry(
    entries: &[GeometryDescription],
    folder: &Folder,
    limits: &Limits,
) -> Result<Imported, SceneError> {
    let mut importer = Importer::new(folder, limits);
    let mut inline = inline::Inline::default();
    let mut moving = Vec::new();
    for (i, entry) in entries.iter().enumerate() {
        let path = format!("geometry[{i}]");
        let (instances, lights) = (importer.geometry.instances.len(), importer.lights.len());
        match entry {
            GeometryDescription::Gltf(entry) => gltf::import(&mut importer, i, entry)?,
            GeometryDescription::Obj(entry) => obj::import(&mut importer, &path, entry)?,
            _ => inline.add(&mut importer, &path, entry)?,
        }
        if !entry.keyframes().is_empty() {
            let placed = instances..importer.geometry.instances.len();
            moving.extend(animated::Moving::new(&path, entry.keyframes(), placed)?);
            if importer.lights.len() > lights {
                importer.warn(format!(
                    "{path}: the lights of the file stay where they are at time 0"
                ));
            }
        }
    }
    inline.finish(&mut importer)?;
    importer.finish(moving)
}
