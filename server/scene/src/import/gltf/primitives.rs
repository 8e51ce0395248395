//! Primitives of meshes: attributes and indices to triangles.

use std::collections::HashMap;

use gltf::json::mesh::{Mode, Primitive, Semantic};
use gltf::json::validation::Checked;

use super::accessor::Accessor;
use super::document::Document;
use super::materials::Materials;
use crate::error::{SceneError, abbreviate};
use crate::import::importer::Importer;
use crate::import::surface::{self, RawMesh};

/// The meshes of a glTF mesh, one a primitive that has triangles.
pub(super) fn meshes(
    document: &Document,
    importer: &mut Importer,
    materials: &mut Materials,
    index: usize,
) -> Result<Vec<usize>, SceneError> {
    let mesh = &document.root.meshes[index];
    let name = mesh.name.clone().unwrap_or_else(|| format!("mesh {index}"));
    let name = abbreviate(&name);
    let mut meshes = Vec::new();
    for (i, primitive) in mesh.primitives.iter().enumerate() {
        let reader = Reader {
            document,
            location: format!("meshes[{index}].primitives[{i}]"),
            primitive,
        };
        let Some(mut raw) = reader.read(importer)? else {
            continue;
        };
        raw.name.clone_from(&name);
        let material = primitive.material.map(|material| material.value());
        raw.material = materials.index(document, importer, material, &reader.location)?;
        zero_missing_texcoords(importer, document, &mut raw);
        let cleaned = surface::clean(raw).map_err(|refused| {
            let location = format!("{}.{}", reader.location, refused.part);
            document.file.refused(location, refused.message)
        })?;
        let place = format!("{}: {}", document.file.name, reader.location);
        importer.warn_of(&place, &name, &cleaned);
        if let Some(mesh) = cleaned.mesh {
            meshes.push(importer.add_mesh(&document.file.path, mesh)?);
        }
    }
    Ok(meshes)
}

/// Textures need coordinates: where the primitive has none, all are zero.
fn zero_missing_texcoords(importer: &mut Importer, document: &Document, raw: &mut RawMesh) {
    let material = &importer.geometry.materials[raw.material];
    let uses = [
        material.base_color_texture,
        material.emission_texture,
        material.metallic_roughness_texture,
        material.normal_texture,
    ];
    let mut missing = false;
    for texture in uses.into_iter().flatten() {
        let texcoords = &mut raw.texcoords[usize::from(texture.texcoord_set & 1)];
        if texcoords.is_empty() && !raw.positions.is_empty() {
            *texcoords = vec![[0.0; 2]; raw.positions.len()];
            missing = true;
        }
    }
    if missing {
        let (file, mesh) = (document.file.name, &raw.name);
        importer.warn(format!(
            "{file}: mesh \"{mesh}\" is textured but has no texture coordinates"
        ));
    }
}

/// A primitive under reading.
struct Reader<'a> {
    document: &'a Document<'a>,
    /// For messages.
    location: String,
    primitive: &'a Primitive,
}

impl<'a> Reader<'a> {
    /// Reads the vertices that triangles use; `None` without triangles.
    fn read(&self, importer: &mut Importer) -> Result<Option<RawMesh>, SceneError> {
        let file = self.document.file;
        let Checked::Valid(mode) = self.primitive.mode else {
            return Err(file.refused(&self.location, "unknown mode"));
        };
        if !matches!(
            mode,
            Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan
        ) {
            let (name, location) = (file.name, &self.location);
            importer.warn(format!("{name}: {location}: points and lines left out"));
            return Ok(None);
        }
        let most = importer.limits.vertices;
        let Some(positions) = self.attribute(&Semantic::Positions, "POSITION", 3..=3, most)? else {
            let (name, location) = (file.name, &self.location);
            importer.warn(format!("{name}: {location}: has no POSITION: left out"));
            return Ok(None);
        };
        let vertices = positions.count();
        let corners = triangles(mode, &self.corners(vertices, importer)?);
        // Shared accessors could make a small file into endless work: every triangle counts,
        // dropped ones too.
        importer.count_raw_triangles(&file.path, corners.len() / 3)?;
        let (used, indices) = compact(&corners, vertices);

        let pick3 = |accessor: &Accessor| {
            let read = used.iter().map(|i| accessor.floats::<3>(*i as usize));
            read.collect::<Vec<_>>()
        };
        let of_all = |part: &str, accessor: &Accessor| {
            if accessor.count() == vertices {
                return Ok(());
            }
            let found = accessor.count();
            let message = format!("{found} elements, but POSITION has {vertices}");
            Err(file.refused(format!("{}.attributes.{part}", self.location), message))
        };
        let mut raw = RawMesh {
            positions: pick3(&positions),
            indices,
            ..RawMesh::default()
        };
        if let Some(normals) = self.attribute(&Semantic::Normals, "NORMAL", 3..=3, most)? {
            of_all("NORMAL", &normals)?;
            raw.normals = Some(pick3(&normals));
        }
        for set in 0..2_u32 {
            let name = format!("TEXCOORD_{set}");
            let semantic = Semantic::TexCoords(set);
            if let Some(texcoords) = self.attribute(&semantic, &name, 2..=2, most)? {
                of_all(&name, &texcoords)?;
                let read = used.iter().map(|i| texcoords.floats::<2>(*i as usize));
                raw.texcoords[set as usize] = read.collect();
            }
        }
        if let Some(colors) = self.attribute(&Semantic::Colors(0), "COLOR_0", 3..=4, most)? {
            of_all("COLOR_0", &colors)?;
            raw.colors = self.colors(importer, &colors, &used);
        }
        Ok(Some(raw))
    }

    /// Opens an attribute and checks its type.
    fn attribute(
        &self,
        semantic: &Semantic,
        name: &str,
        components: std::ops::RangeInclusive<usize>,
        most: u64,
    ) -> Result<Option<Accessor<'a>>, SceneError> {
        let attributes = &self.primitive.attributes;
        let Some(index) = attributes.get(&Checked::Valid(semantic.clone())) else {
            return Ok(None);
        };
        let location = format!("{}.attributes.{name}", self.location);
        let accessor = self.document.accessor(index.value(), &location, most)?;
        if !components.contains(&accessor.components()) || accessor.is_u32() {
            let message = format!("accessors[{}] has the wrong type", index.value());
            return Err(self.document.file.refused(location, message));
        }
        Ok(Some(accessor))
    }

    /// The vertex of each corner, in the order of the mode.
    fn corners(&self, vertices: usize, importer: &Importer) -> Result<Vec<u32>, SceneError> {
        let Some(index) = self.primitive.indices else {
            return Ok((0..vertices as u32).collect());
        };
        let file = self.document.file;
        let location = format!("{}.indices", self.location);
        let most = importer.limits.triangles.saturating_mul(3);
        let accessor = self.document.accessor(index.value(), &location, most)?;
        if accessor.components() != 1 || !accessor.is_unsigned() {
            let message = format!("accessors[{}] has the wrong type", index.value());
            return Err(file.refused(location, message));
        }
        let corners: Vec<u32> = (0..accessor.count())
            .map(|i| accessor.unsigned(i))
            .collect();
        match corners.iter().position(|i| *i as usize >= vertices) {
            None => Ok(corners),
            Some(at) => {
                let index = corners[at];
                Err(file.refused(
                    location,
                    format!("element {at} is {index}, but there are {vertices} vertices"),
                ))
            }
        }
    }

    /// Linear colours in bytes.
    fn colors(&self, importer: &mut Importer, accessor: &Accessor, used: &[u32]) -> Vec<[u8; 4]> {
        let mut outside = 0_usize;
        let mut byte = |value: f32| {
            if !(0.0..=1.0).contains(&value) {
                outside += 1;
            }
            // A NaN becomes 0.
            (value.clamp(0.0, 1.0) * 255.0).round() as u8
        };
        let opaque = accessor.components() == 3;
        let colors = used
            .iter()
            .map(|i| {
                let [r, g, b, a] = accessor.floats::<4>(*i as usize);
                [r, g, b, if opaque { 1.0 } else { a }].map(&mut byte)
            })
            .collect();
        if outside > 0 {
            let (name, location) = (self.document.file.name, &self.location);
            importer.warn(format!(
                "{name}: {location}: {outside} components of COLOR_0 outside 0 to 1 clamped"
            ));
        }
        colors
    }
}

/// Three corners a triangle; strips and fans unrolled, an incomplete last triangle left out.
fn triangles(mode: Mode, corners: &[u32]) -> Vec<u32> {
    match mode {
        Mode::TriangleStrip => corners
            .windows(3)
            .enumerate()
            .flat_map(|(i, w)| {
                // Every other triangle of a strip runs the other way.
                if i % 2 == 0 {
                    [w[0], w[1], w[2]]
                } else {
                    [w[1], w[0], w[2]]
                }
            })
            .collect(),
        Mode::TriangleFan => corners
            .get(1..)
            .unwrap_or_default()
            .windows(2)
            .flat_map(|w| [corners[0], w[0], w[1]])
            .collect(),
        _ => corners[..corners.len() - corners.len() % 3].to_vec(),
    }
}

/// The vertices that are used, and the corners as indices into them.
///
/// Primitives often share one large vertex buffer; each keeps its own part only.
fn compact(corners: &[u32], vertices: usize) -> (Vec<u32>, Vec<u32>) {
    let mut used = Vec::new();
    let mut indices = Vec::with_capacity(corners.len());
    if corners.len() >= vertices / 8 {
        const UNSEEN: u32 = u32::MAX;
        let mut place = vec![UNSEEN; vertices];
        for corner in corners {
            let place = &mut place[*corner as usize];
            if *place == UNSEEN {
                *place = used.len() as u32;
                used.push(*corner);
            }
            indices.push(*place);
        }
    } else {
        let mut place = HashMap::new();
        for corner in corners {
            let next = used.len() as u32;
            let index = *place.entry(*corner).or_insert(next);
            if index == next {
                used.push(*corner);
            }
            indices.push(index);
        }
    }
    (used, indices)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strips_and_fans_keep_the_winding() {
        assert_eq!(
            triangles(Mode::TriangleStrip, &[0, 1, 2, 3]),
            [0, 1, 2, 2, 1, 3]
        );
        assert_eq!(
            triangles(Mode::TriangleFan, &[0, 1, 2, 3]),
            [0, 1, 2, 0, 2, 3]
        );
        assert_eq!(triangles(Mode::Triangles, &[0, 1, 2, 3]), [0, 1, 2]);
        for mode in [Mode::TriangleStrip, Mode::TriangleFan, Mode::Triangles] {
            assert_eq!(triangles(mode, &[]), [0; 0]);
            assert_eq!(triangles(mode, &[7]), [0; 0]);
        }
    }

    #[test]
    fn compaction_keeps_what_corners_mean() {
        for vertices in [6, 10_000] {
            let corners = [5, 3, 4, 4, 3, 0];
            let (used, indices) = compact(&corners, vertices);
            assert_eq!(used, [5, 3, 4, 0]);
            let back: Vec<u32> = indices.iter().map(|i| used[*i as usize]).collect();
            assert_eq!(back, corners);
        }
    }
}
