//! Wavefront OBJ with MTL materials, both confined to the scene's folder.
//!
//! `tobj` parses, but panics on some malformed lines; a first pass over the text finds those and
//! names the line.

use std::collections::HashMap;
use std::io::Cursor;
use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

use tyndall_files::guarded;
use tyndall_files::relative::why_not_relative;

use super::importer::{IDENTITY_UV, Importer};
use super::surface::RawMesh;
use super::transform::initial;
use crate::description::geometry::ObjGeometry;
use crate::error::{SceneError, abbreviate};
use crate::files::Folder;
use crate::scene::{ColorSpace, Material, TextureRef};

/// Largest index; more elements would not fit the limits of any scene.
const LARGEST_INDEX: u64 = 1 << 31;
/// Opacity below which a surface is left out.
const OPACITY: f32 = 0.5;
/// Material libraries a file may name; each is read again at every mention.
const LIBRARIES: usize = 64;

/// Imports an OBJ file.
pub(super) fn import(
    importer: &mut Importer,
    entry_path: &str,
    entry: &ObjGeometry,
) -> Result<(), SceneError> {
    let file = File {
        path: format!("{entry_path}.path"),
        name: &entry.path,
    };
    let bytes = importer.folder.read(&file.path, file.name)?;
    check_obj(&file, &bytes)?;

    let options = tobj::LoadOptions {
        single_index: true,
        triangulate: true,
        ignore_points: true,
        ignore_lines: true,
    };
    let problem = Mutex::new(None);
    let libraries = AtomicUsize::new(0);
    let folder = importer.folder;
    let load_library = |name: &Path| {
        let loaded = if libraries.fetch_add(1, Ordering::Relaxed) >= LIBRARIES {
            Err(file.refused(
                "mtllib",
                format!("more than {LIBRARIES} material libraries"),
            ))
        } else {
            library(&file, folder, name)
        };
        loaded.or_else(|error| {
            let mut problem = problem.lock().unwrap_or_else(PoisonError::into_inner);
            problem.get_or_insert(error);
            tobj::load_mtl_buf(&mut Cursor::new(b""))
        })
    };
    let parsed = guarded("OBJ and MTL", || {
        tobj::load_obj_buf(&mut Cursor::new(&bytes), &options, load_library)
    });
    if let Some(error) = problem.into_inner().unwrap_or_else(PoisonError::into_inner) {
        return Err(error);
    }
    let parsed = parsed.map_err(|failed| file.refused("OBJ", failed.to_string()))?;
    let (models, materials) = parsed.map_err(|error| file.refused("OBJ", error.to_string()))?;
    let materials = materials.map_err(|error| file.refused("MTL", error.to_string()))?;

    let mut indices = Vec::new();
    for material in &materials {
        let material = convert(importer, &file, material)?;
        importer.geometry.materials.push(material);
        indices.push(importer.geometry.materials.len() - 1);
    }
    let placed = [initial(entry.transform.as_ref(), &entry.keyframes)];
    let mut plain = None;
    for model in models {
        let material = model
            .mesh
            .material_id
            .and_then(|id| indices.get(id).copied());
        let material = material.unwrap_or_else(|| {
            *plain.get_or_insert_with(|| {
                importer.geometry.materials.push(Material {
                    name: "default".to_owned(),
                    double_sided: true,
                    ..Material::default()
                });
                importer.geometry.materials.len() - 1
            })
        });
        let raw = raw_mesh(importer, &file, &model, material)?;
        importer.add_raw(&file.path, file.name, raw, &placed)?;
    }
    Ok(())
}

/// A file and the JSON path that names it.
struct File<'a> {
    path: String,
    name: &'a str,
}

impl File<'_> {
    fn refused(&self, location: impl Into<String>, message: impl Into<String>) -> SceneError {
        SceneError::Model {
            path: self.path.clone(),
            file: self.name.to_owned(),
            location: location.into(),
            message: message.into(),
        }
    }

    /// The name of a file next to this one.
    fn beside(&self, name: &str, location: &str) -> Result<String, SceneError> {
        if let Some(why) = why_not_relative(name) {
            let shown = abbreviate(name);
            let message =
                format!("\"{shown}\", {why}; allowed is a relative path inside the scene's folder");
            return Err(self.refused(location, message));
        }
        Ok(match self.name.rsplit_once('/') {
            Some((folder, _)) => format!("{folder}/{name}"),
            None => name.to_owned(),
        })
    }
}

/// Refuses face indices that would overflow.
fn check_obj(file: &File, bytes: &[u8]) -> Result<(), SceneError> {
    for (i, line) in bytes.split(|byte| *byte == b'\n').enumerate() {
        let refused = |message: &str| Err(file.refused(format!("line {}", i + 1), message));
        let Ok(line) = std::str::from_utf8(line) else {
            return refused("not UTF-8");
        };
        let mut words = line.split_whitespace();
        if !matches!(words.next(), Some("f" | "l")) {
            continue;
        }
        for index in words.flat_map(|word| word.split('/')) {
            let index: Option<i64> = if index.is_empty() {
                Some(1)
            } else {
                index.parse().ok()
            };
            match index {
                None => return refused("an index is not a whole number"),
                Some(0) => return refused("index 0, allowed from 1 or negative"),
                Some(index) if index.unsigned_abs() > LARGEST_INDEX => {
                    return refused("an index is too large");
                }
                Some(_) => {}
            }
        }
    }
    Ok(())
}

/// Materials and their indices by name.
type Library = (Vec<tobj::Material>, HashMap<String, usize>);

/// Reads a material library next to the OBJ file.
fn library(file: &File, folder: &Folder, name: &Path) -> Result<Library, SceneError> {
    let name = name.to_str().unwrap_or_default();
    let beside = file.beside(name, "mtllib")?;
    let bytes = folder
        .read(&file.path, &beside)
        .map_err(|error| match error {
            SceneError::Io { source, .. } => {
                file.refused("mtllib", format!("\"{}\": {source}", abbreviate(&beside)))
            }
            other => other,
        })?;
    for (i, line) in bytes.split(|byte| *byte == b'\n').enumerate() {
        let mut words = line
            .split(u8::is_ascii_whitespace)
            .filter(|w| !w.is_empty());
        let is_color = matches!(words.next(), Some(b"Ka" | b"Kd" | b"Ks" | b"Ke"));
        if is_color && words.count() < 3 {
            let location = format!("{}, line {}", abbreviate(&beside), i + 1);
            return Err(file.refused(location, "fewer than three numbers"));
        }
    }
    tobj::load_mtl_buf(&mut Cursor::new(&bytes))
        .map_err(|error| file.refused(abbreviate(&beside), error.to_string()))
}

/// A Phong material as a metallic-roughness one.
fn convert(
    importer: &mut Importer,
    file: &File,
    material: &tobj::Material,
) -> Result<Material, SceneError> {
    let location = format!("material \"{}\"", abbreviate(&material.name));
    let [r, g, b] = material.diffuse.unwrap_or([0.8; 3]);
    let opacity = material.dissolve.unwrap_or(1.0);
    if [r, g, b, opacity].iter().any(|c| !(0.0..=1.0).contains(c)) {
        return Err(file.refused(location, "Kd or d is outside 0 to 1"));
    }
    let emission = material.emissive.unwrap_or([0.0; 3]);
    if emission.iter().any(|e| !(0.0..=1e9).contains(e)) {
        return Err(file.refused(location, "Ke is outside 0 to 1e9"));
    }
    let base_color_texture = match &material.diffuse_texture {
        None => None,
        Some(name) => {
            let beside = file.beside(name, &location)?;
            let texture = importer.texture_file(&file.path, &beside, ColorSpace::Srgb)?;
            Some(TextureRef {
                texture,
                texcoord_set: 0,
                uv_transform: IDENTITY_UV,
            })
        }
    };
    if material.normal_texture.is_some() || material.dissolve_texture.is_some() {
        let name = file.name;
        importer.warn(format!(
            "{name}: {location}: bump and opacity maps left out"
        ));
    }
    if opacity < 1.0 {
        let name = file.name;
        importer.warn(format!(
            "{name}: {location}: opacity {opacity} is approximated by {}",
            if opacity < OPACITY {
                "a hole"
            } else {
                "an opaque surface"
            }
        ));
    }
    let exponent = material.shininess.unwrap_or(0.0);
    let exponent = if exponent.is_finite() {
        exponent.max(0.0)
    } else {
        0.0
    };
    Ok(Material {
        name: material.name.clone(),
        base_color: [r, g, b, opacity],
        base_color_texture,
        emission,
        // The width of a Phong lobe of this exponent, as perceptual roughness.
        roughness: (2.0 / (exponent + 2.0)).sqrt().sqrt(),
        alpha_cutoff: (opacity < 1.0).then_some(OPACITY),
        double_sided: true,
        ..Material::default()
    })
}

/// A model's triangles; texture coordinates turned to an origin at the top.
fn raw_mesh(
    importer: &mut Importer,
    file: &File,
    model: &tobj::Model,
    material: usize,
) -> Result<RawMesh, SceneError> {
    let mesh = &model.mesh;
    importer.count_raw_triangles(&file.path, mesh.indices.len() / 3)?;
    let vertices = mesh.positions.len() / 3;
    let name = abbreviate(&model.name);
    let mut texcoords: Vec<[f32; 2]> = mesh
        .texcoords
        .as_chunks::<2>()
        .0
        .iter()
        .map(|[u, v]| [*u, 1.0 - v])
        .collect();
    if texcoords.len() != vertices {
        if !texcoords.is_empty() {
            let name = file.name;
            importer.warn(format!(
                "{name}: some vertices have no texture coordinates: zero used"
            ));
        }
        let textured = importer.geometry.materials[material]
            .base_color_texture
            .is_some();
        texcoords = if textured {
            vec![[0.0; 2]; vertices]
        } else {
            Vec::new()
        };
    }
    // Normals of some vertices only can't be told apart: flat ones instead.
    let normals = mesh.normals.as_chunks::<3>().0.to_vec();
    let normals = (normals.len() == vertices).then_some(normals);
    Ok(RawMesh {
        name,
        positions: mesh.positions.as_chunks::<3>().0.to_vec(),
        normals,
        texcoords: [texcoords, Vec::new()],
        colors: Vec::new(),
        indices: mesh.indices.clone(),
        material,
    })
}
