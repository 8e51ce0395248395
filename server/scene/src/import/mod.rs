//! Geometry of a description: model files, inline meshes and primitives, all through one set of
//! limits and one cleaning step.

mod animated;
mod assets;
mod environment;
mod gltf;
mod images;
mod inline;
mod mirror;
mod obj;
mod shapes;
mod surface;
mod transform;

use std::collections::HashMap;
use std::sync::Arc;

use glam::DAffine3;

use crate::description::{CameraDescription, GeometryDescription, LightDescription};
use crate::error::SceneError;
use crate::files::Folder;
use crate::geometry::{Geometry, Instance, Material, Mesh, Surfaces, Texture};
use crate::limits::Limits;

pub(crate) use assets::Assets;
pub(crate) use transform::is_invertible;

/// What the geometry of a description came to.
#[derive(Debug)]
pub(crate) struct Imported {
    pub(crate) geometry: Geometry,
    /// Lights of files, with the index of their entry in `geometry`.
    pub(crate) lights: Vec<(usize, LightDescription)>,
    /// The first perspective camera of a file.
    pub(crate) camera: Option<CameraDescription>,
    /// What was left out or approximated.
    pub(crate) warnings: Vec<String>,
}

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

/// What has been read so far.
#[derive(Debug, Default)]
struct Draft {
    meshes: Vec<Mesh>,
    instances: Vec<Instance>,
    materials: Vec<Material>,
    textures: Vec<Texture>,
}

/// Geometry under construction.
struct Importer<'a> {
    folder: &'a Folder<'a>,
    limits: &'a Limits,
    geometry: Draft,
    lights: Vec<(usize, LightDescription)>,
    camera: Option<CameraDescription>,
    warnings: Vec<String>,
    triangles: u64,
    /// Triangles read from files, each once, dropped ones included.
    raw_triangles: u64,
    vertices: u64,
    texture_pixels: u64,
    /// Textures of files by what they were made from.
    textures: HashMap<images::Key, usize>,
}

impl<'a> Importer<'a> {
    fn new(folder: &'a Folder<'a>, limits: &'a Limits) -> Self {
        Self {
            folder,
            limits,
            geometry: Draft::default(),
            lights: Vec::new(),
            camera: None,
            warnings: Vec::new(),
            triangles: 0,
            raw_triangles: 0,
            vertices: 0,
            texture_pixels: 0,
            textures: HashMap::new(),
        }
    }

    /// Notes what was left out or approximated; the list itself is bounded.
    fn warn(&mut self, warning: String) {
        const MOST: usize = 200;
        match self.warnings.len().cmp(&MOST) {
            std::cmp::Ordering::Less => self.warnings.push(warning),
            std::cmp::Ordering::Equal => self.warnings.push("more warnings left out".to_owned()),
            std::cmp::Ordering::Greater => {}
        }
    }

    /// Adds a cleaned mesh.
    fn add_mesh(&mut self, path: &str, mesh: Mesh) -> Result<usize, SceneError> {
        self.vertices = self.vertices.saturating_add(mesh.positions.len() as u64);
        limit(
            path,
            "the number of vertices",
            self.vertices,
            self.limits.vertices,
        )?;
        self.geometry.meshes.push(mesh);
        Ok(self.geometry.meshes.len() - 1)
    }

    /// Places a mesh; a transform that flattens it leaves it out with a warning.
    fn add_instance(
        &mut self,
        path: &str,
        mesh: usize,
        world_from_object: DAffine3,
    ) -> Result<(), SceneError> {
        if !is_invertible(&world_from_object) {
            let name = &self.geometry.meshes[mesh].name;
            let warning =
                format!("{path}: a copy of mesh \"{name}\" is scaled to nothing: left out");
            self.warn(warning);
            return Ok(());
        }
        let triangles = (self.geometry.meshes[mesh].indices.len() / 3) as u64;
        self.triangles = self.triangles.saturating_add(triangles);
        limit(
            path,
            "the number of triangles",
            self.triangles,
            self.limits.triangles,
        )?;
        self.geometry.instances.push(Instance {
            mesh,
            world_from_object,
        });
        let instances = self.geometry.instances.len() as u64;
        limit(
            path,
            "the number of instances",
            instances,
            self.limits.instances,
        )
    }

    /// Adds a light of a file.
    fn add_light(
        &mut self,
        path: &str,
        entry: usize,
        light: LightDescription,
    ) -> Result<(), SceneError> {
        self.lights.push((entry, light));
        let lights = self.lights.len() as u64;
        limit(path, "the number of lights", lights, self.limits.lights)
    }

    fn finish(mut self, moving: Vec<animated::Moving>) -> Result<Imported, SceneError> {
        mirror::unmirror(&mut self.geometry);
        let Draft {
            meshes,
            instances,
            materials,
            textures,
        } = self.geometry;
        let surfaces = Surfaces::new(meshes, materials, textures);
        let tracks = moving
            .into_iter()
            .map(|moving| moving.track(&surfaces, &instances))
            .collect::<Result<_, _>>()?;
        Ok(Imported {
            geometry: Geometry {
                surfaces: Arc::new(surfaces),
                instances,
                tracks: Arc::new(tracks),
            },
            lights: self.lights,
            camera: self.camera,
            warnings: self.warnings,
        })
    }
}

/// Refuses more than the limit.
fn limit(path: &str, what: &'static str, found: u64, limit: u64) -> Result<(), SceneError> {
    if found <= limit {
        return Ok(());
    }
    Err(SceneError::Limit {
        path: path.to_owned(),
        what,
        found,
        limit,
    })
}
