//! Geometry under construction: every part that is added is checked, counted and limited here.

use std::collections::HashMap;
use std::sync::Arc;

use glam::DAffine3;

use super::animated::Moving;
use super::images::{self, Image, Source};
use super::mirror;
use super::surface::{self, RawMesh};
use crate::description::{CameraDescription, LightDescription};
use crate::error::SceneError;
use crate::files::Folder;
use crate::limits::{Limits, limit};
use crate::scene::{
    ColorSpace, Geometry, Instance, Material, Mesh, Surfaces, Texture, Wrap, is_invertible,
};

/// Texture coordinates as they are.
pub(super) const IDENTITY_UV: [[f32; 3]; 2] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];

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

/// What has been read so far.
#[derive(Debug, Default)]
pub(super) struct Draft {
    pub(super) meshes: Vec<Mesh>,
    pub(super) instances: Vec<Instance>,
    pub(super) materials: Vec<Material>,
    pub(super) textures: Vec<Texture>,
}

/// Geometry under construction.
pub(super) struct Importer<'a> {
    pub(super) folder: &'a Folder<'a>,
    pub(super) limits: &'a Limits,
    pub(super) geometry: Draft,
    pub(super) lights: Vec<(usize, LightDescription)>,
    pub(super) camera: Option<CameraDescription>,
    pub(super) warnings: Vec<String>,
    triangles: u64,
    /// Triangles read from files, each once, dropped ones included.
    raw_triangles: u64,
    vertices: u64,
    texture_pixels: u64,
    /// Textures of files by what they were made from.
    textures: HashMap<images::Key, usize>,
}

impl<'a> Importer<'a> {
    pub(super) fn new(folder: &'a Folder<'a>, limits: &'a Limits) -> Self {
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
    pub(super) fn warn(&mut self, warning: String) {
        const MOST: usize = 200;
        match self.warnings.len().cmp(&MOST) {
            std::cmp::Ordering::Less => self.warnings.push(warning),
            std::cmp::Ordering::Equal => self.warnings.push("more warnings left out".to_owned()),
            std::cmp::Ordering::Greater => {}
        }
    }

    /// Counts triangles of a file before any of them is dropped.
    pub(super) fn count_raw_triangles(
        &mut self,
        path: &str,
        count: usize,
    ) -> Result<(), SceneError> {
        self.raw_triangles += count as u64;
        limit(
            path,
            "the number of triangles",
            self.raw_triangles,
            self.limits.triangles,
        )
    }

    /// Adds a cleaned mesh.
    pub(super) fn add_mesh(&mut self, path: &str, mesh: Mesh) -> Result<usize, SceneError> {
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
    pub(super) fn add_instance(
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
    pub(super) fn add_light(
        &mut self,
        path: &str,
        entry: usize,
        light: LightDescription,
    ) -> Result<(), SceneError> {
        self.lights.push((entry, light));
        let lights = self.lights.len() as u64;
        limit(path, "the number of lights", lights, self.limits.lights)
    }

    pub(super) fn finish(mut self, moving: Vec<Moving>) -> Result<Imported, SceneError> {
        mirror::unmirror(&mut self.geometry.meshes, &mut self.geometry.instances);
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

    /// Cleans a mesh, warns of what that left out, and places it.
    ///
    /// `file` names the file for messages; empty for what stands in the scene itself.
    pub(super) fn add_raw(
        &mut self,
        path: &str,
        file: &str,
        raw: RawMesh,
        placed: &[DAffine3],
    ) -> Result<(), SceneError> {
        let name = raw.name.clone();
        let place = if file.is_empty() { path } else { file };
        let cleaned = surface::clean(raw).map_err(|refused| {
            if file.is_empty() {
                SceneError::invalid(path, refused.message, "a well-formed mesh")
            } else {
                SceneError::Model {
                    path: path.to_owned(),
                    file: file.to_owned(),
                    location: format!("mesh \"{name}\", {}", refused.part),
                    message: refused.message,
                }
            }
        })?;
        self.warn_of(place, &name, &cleaned);
        if let Some(mesh) = cleaned.mesh {
            let mesh = self.add_mesh(path, mesh)?;
            for map in placed {
                self.add_instance(path, mesh, *map)?;
            }
        }
        Ok(())
    }

    /// Warns of what a cleaning left out.
    pub(super) fn warn_of(&mut self, place: &str, name: &str, cleaned: &surface::Cleaned) {
        if cleaned.degenerate > 0 {
            let count = cleaned.degenerate;
            self.warn(format!(
                "{place}: mesh \"{name}\": {count} triangles without area dropped"
            ));
        }
        if cleaned.bad_normals > 0 {
            let count = cleaned.bad_normals;
            self.warn(format!(
                "{place}: mesh \"{name}\": {count} normals without direction replaced"
            ));
        }
    }

    /// The index of the texture of an image, read and decoded at its first use.
    pub(super) fn texture(
        &mut self,
        source: Source,
        color_space: ColorSpace,
        wrap: [Wrap; 2],
        read: impl FnOnce(&Self, Source) -> Result<Image, SceneError>,
    ) -> Result<usize, SceneError> {
        let name = format!("{} {}", source.file, source.location);
        let key = images::Key {
            // Images of glTF files are numbered; files are the same wherever they are named.
            identity: name.clone(),
            color_space,
            wrap,
        };
        if let Some(index) = self.textures.get(&key) {
            return Ok(*index);
        }
        let image = read(self, source)?;
        let (width, height, pixels) = image.decode(self.limits, &mut self.texture_pixels)?;
        self.geometry.textures.push(Texture {
            name,
            width,
            height,
            pixels,
            color_space,
            wrap,
        });
        let index = self.geometry.textures.len() - 1;
        self.textures.insert(key, index);
        Ok(index)
    }

    /// The texture of an image file.
    pub(super) fn texture_file(
        &mut self,
        path: &str,
        file: &str,
        color_space: ColorSpace,
    ) -> Result<usize, SceneError> {
        let source = Source {
            path: path.to_owned(),
            file: file.to_owned(),
            location: "image".to_owned(),
        };
        self.texture(
            source,
            color_space,
            [Wrap::Repeat; 2],
            |importer, source| {
                let bytes = importer.folder.read(&source.path, &source.file)?;
                Ok(Image { source, bytes })
            },
        )
    }
}
