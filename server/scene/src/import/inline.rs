//! Meshes and primitives written into the scene.
//!
//! Primitives of equal material are merged into one mesh, so that a hall of a hundred boxes is a
//! handful of draws. Merged vertices are relative to an anchor close by: `f32` keeps 0.1 mm.

use std::collections::HashMap;

use glam::{DAffine3, DVec3};

use super::importer::{IDENTITY_UV, Importer};
use super::shapes::Shape;
use super::surface::RawMesh;
use super::transform::initial;
use crate::description::geometry::MeshGeometry;
use crate::description::{GeometryDescription, MaterialDescription};
use crate::error::SceneError;
use crate::limits::limit;
use crate::scene::{ColorSpace, Material, TextureRef};

/// Farthest vertex from the anchor of its mesh. Unit: m.
const REACH: f64 = 1000.0;

/// Primitives under collection.
#[derive(Default)]
pub(super) struct Inline {
    /// Materials by their JSON text.
    materials: HashMap<String, usize>,
    /// The open batch of each material.
    open: HashMap<usize, Batch>,
    /// Full batches and those of far-away shapes.
    closed: Vec<Batch>,
}

/// Primitives of one material that become one mesh.
struct Batch {
    path: String,
    anchor: DVec3,
    raw: RawMesh,
}

impl Inline {
    /// Adds an inline mesh or a primitive.
    pub(super) fn add(
        &mut self,
        importer: &mut Importer,
        path: &str,
        entry: &GeometryDescription,
    ) -> Result<(), SceneError> {
        let placed = initial(entry.transform(), entry.keyframes());
        let Some(description) = entry.material() else {
            return Ok(());
        };
        let material = self.material(importer, path, description)?;
        let shape = match entry {
            GeometryDescription::Box(entry) => Shape::cuboid(entry),
            GeometryDescription::Sphere(entry) => Shape::sphere(entry),
            GeometryDescription::Quad(entry) => Shape::quad(entry),
            GeometryDescription::Mesh(entry) => {
                return mesh(importer, path, entry, material, placed);
            }
            GeometryDescription::Gltf(_) | GeometryDescription::Obj(_) => return Ok(()),
        };
        if !entry.keyframes().is_empty() {
            return alone(importer, path, material, &shape, placed);
        }
        self.collect(importer, path, material, &shape.placed(&placed))
    }

    /// Appends a shape to the open batch of its material.
    fn collect(
        &mut self,
        importer: &Importer,
        path: &str,
        material: usize,
        shape: &Shape,
    ) -> Result<(), SceneError> {
        let Some(first) = shape.positions.first().copied() else {
            return Ok(());
        };
        let in_reach = |anchor: DVec3| shape.positions.iter().all(|p| p.distance(anchor) < REACH);
        let fits = |batch: &Batch| in_reach(batch.anchor);
        if !self.open.get(&material).is_some_and(fits) {
            let batch = Batch {
                path: path.to_owned(),
                anchor: first,
                raw: RawMesh {
                    name: importer.geometry.materials[material].name.clone(),
                    material,
                    normals: Some(Vec::new()),
                    ..RawMesh::default()
                },
            };
            self.closed.extend(self.open.insert(material, batch));
        }
        let Some(Batch { anchor, raw, .. }) = self.open.get_mut(&material) else {
            return Ok(());
        };
        let vertices = (raw.positions.len() + shape.positions.len()) as u64;
        limit(
            path,
            "the number of vertices",
            vertices,
            importer.limits.vertices,
        )?;
        append(raw, *anchor, shape);
        Ok(())
    }

    /// The index of a material, equal ones shared.
    fn material(
        &mut self,
        importer: &mut Importer,
        path: &str,
        description: &MaterialDescription,
    ) -> Result<usize, SceneError> {
        let key = serde_json::to_string(description)
            .map_err(|error| SceneError::invalid(path, error.to_string(), "finite numbers"))?;
        if let Some(index) = self.materials.get(&key) {
            return Ok(*index);
        }
        let texture = match &description.base_color_texture {
            None => None,
            Some(file) => {
                let path = format!("{path}.material.base_color_texture");
                let texture = importer.texture_file(&path, file, ColorSpace::Srgb)?;
                Some(TextureRef {
                    texture,
                    texcoord_set: 0,
                    uv_transform: IDENTITY_UV,
                })
            }
        };
        let [r, g, b] = description.base_color.0.map(|c| c as f32);
        let index = importer.geometry.materials.len();
        importer.geometry.materials.push(Material {
            name: format!("inline {index}"),
            base_color: [r, g, b, 1.0],
            base_color_texture: texture,
            emission: description.emission.0.map(|c| c as f32),
            metallic: description.metallic as f32,
            roughness: description.roughness as f32,
            alpha_cutoff: description.alpha_cutoff.map(|c| c as f32),
            double_sided: description.double_sided,
            ..Material::default()
        });
        self.materials.insert(key, index);
        Ok(index)
    }

    /// Turns the batches into meshes, in an order that depends on the description only.
    pub(super) fn finish(self, importer: &mut Importer) -> Result<(), SceneError> {
        let mut batches = self.closed;
        let first_open = batches.len();
        batches.extend(self.open.into_values());
        batches[first_open..].sort_by_key(|batch| batch.raw.material);
        for Batch { path, anchor, raw } in batches {
            let placed = DAffine3::from_translation(anchor);
            importer.add_raw(&path, "", raw, &[placed])?;
        }
        Ok(())
    }
}

/// Adds a shape's triangles, its vertices relative to `anchor`.
fn append(raw: &mut RawMesh, anchor: DVec3, shape: &Shape) {
    let start = raw.positions.len();
    let narrow = |v: DVec3| v.as_vec3().to_array();
    raw.positions
        .extend(shape.positions.iter().map(|p| narrow(*p - anchor)));
    if let Some(normals) = &mut raw.normals {
        let unit = |n: &DVec3| narrow(*n / n.length());
        normals.extend(shape.normals.iter().map(unit));
    }
    raw.texcoords[0].extend(shape.texcoords.iter().map(|uv| uv.as_vec2().to_array()));
    let indices = shape.indices.iter().flatten();
    raw.indices.extend(indices.map(|i| start as u32 + i));
}

/// A shape that moves: a mesh of its own, with a placement of its own.
fn alone(
    importer: &mut Importer,
    path: &str,
    material: usize,
    shape: &Shape,
    placed: DAffine3,
) -> Result<(), SceneError> {
    let Some(anchor) = shape.positions.first().copied() else {
        return Ok(());
    };
    let mut raw = RawMesh {
        name: importer.geometry.materials[material].name.clone(),
        material,
        normals: Some(Vec::new()),
        ..RawMesh::default()
    };
    append(&mut raw, anchor, shape);
    let placed = placed * DAffine3::from_translation(anchor);
    importer.add_raw(path, "", raw, &[placed])
}

fn mesh(
    importer: &mut Importer,
    path: &str,
    entry: &MeshGeometry,
    material: usize,
    placed: DAffine3,
) -> Result<(), SceneError> {
    let narrow = |v: &[f64; 3]| v.map(|c| c as f32);
    // Normalized in double precision: a short or long normal would leave the range of f32.
    let unit = |v: &[f64; 3]| {
        let wide = DVec3::from_array(*v);
        (wide / wide.length()).as_vec3().to_array()
    };
    let texcoords = entry.texcoords.iter().flatten();
    let raw = RawMesh {
        name: entry.name.clone().unwrap_or_default(),
        positions: entry.positions.iter().map(narrow).collect(),
        normals: entry
            .normals
            .as_ref()
            .map(|normals| normals.iter().map(unit).collect()),
        texcoords: [
            texcoords.map(|uv| uv.map(|c| c as f32)).collect(),
            Vec::new(),
        ],
        colors: Vec::new(),
        indices: entry.indices.iter().flatten().copied().collect(),
        material,
    };
    importer.add_raw(path, "", raw, &[placed])
}
