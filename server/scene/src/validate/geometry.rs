//! Rules of geometry that need no file.

use glam::DVec3;

use super::rules;
use crate::description::geometry::{MeshGeometry, QuadGeometry};
use crate::description::{GeometryDescription, MaterialDescription};
use crate::error::SceneError;
use crate::json_path::JsonPath;
use crate::limits::Limits;

/// Endings of glTF files.
const GLTF: &[&str] = &["gltf", "glb"];
/// Endings of textures.
const IMAGES: &[&str] = &["png", "jpg", "jpeg"];

pub(super) fn check(
    entry: &GeometryDescription,
    path: &JsonPath,
    limits: &Limits,
) -> Result<(), SceneError> {
    rules::optional_name(path, entry.name())?;
    if let Some(transform) = entry.transform() {
        rules::transform(&path.field("transform"), transform)?;
    }
    let keyframes = path.field("keyframes");
    rules::times(
        &keyframes,
        entry.keyframes().iter().map(|key| key.time_seconds),
    )?;
    for (i, keyframe) in entry.keyframes().iter().enumerate() {
        let path = keyframes.index(i);
        let transform = path.field("transform");
        rules::transform(&transform, &keyframe.transform)?;
        // On its way through zero a factor would flatten what it scales.
        let before = i.checked_sub(1).map(|i| &entry.keyframes()[i].transform);
        for axis in 0..3 {
            let factor = keyframe.transform.scale.0[axis];
            if before.is_some_and(|before| before.scale.0[axis] * factor < 0.0) {
                return Err(SceneError::invalid(
                    transform.field("scale").index(axis),
                    rules::found(factor),
                    "a factor of the sign that it has in the keyframe before",
                ));
            }
        }
    }
    if let Some(surface) = entry.material() {
        material(surface, &path.field("material"))?;
    }
    match entry {
        GeometryDescription::Gltf(entry) => {
            rules::file(&path.field("path"), &entry.path, GLTF)?;
            let efficacy = path.field("luminous_efficacy");
            rules::range(&efficacy, entry.luminous_efficacy, 1e-3, 1e6)
        }
        GeometryDescription::Obj(entry) => rules::file(&path.field("path"), &entry.path, &["obj"]),
        GeometryDescription::Mesh(entry) => mesh(entry, path, limits),
        GeometryDescription::Box(entry) => rules::corners(
            &path.field("min"),
            &entry.min,
            &path.field("max"),
            &entry.max,
        ),
        GeometryDescription::Sphere(entry) => {
            rules::position(&path.field("center"), &entry.center)?;
            rules::range(&path.field("radius"), entry.radius, 1e-6, 1e6)
        }
        GeometryDescription::Quad(entry) => quad(entry, path),
    }
}

fn material(material: &MaterialDescription, path: &JsonPath) -> Result<(), SceneError> {
    rules::rgb(&path.field("base_color"), &material.base_color, 0.0, 1.0)?;
    rules::range(&path.field("metallic"), material.metallic, 0.0, 1.0)?;
    rules::range(&path.field("roughness"), material.roughness, 0.0, 1.0)?;
    let emission = path.field("emission");
    rules::rgb(&emission, &material.emission, 0.0, rules::RADIANCE)?;
    if let Some(cutoff) = material.alpha_cutoff {
        rules::range(&path.field("alpha_cutoff"), cutoff, 0.0, 1.0)?;
    }
    match &material.base_color_texture {
        Some(file) => rules::file(&path.field("base_color_texture"), file, IMAGES),
        None => Ok(()),
    }
}

fn mesh(mesh: &MeshGeometry, path: &JsonPath, limits: &Limits) -> Result<(), SceneError> {
    let vertices = mesh.positions.len();
    let positions = path.field("positions");
    rules::count(&positions, vertices, limits.vertices)?;
    for (i, position) in mesh.positions.iter().enumerate() {
        rules::position(&positions.index(i), position)?;
    }
    let indices = path.field("indices");
    rules::count(&indices, mesh.indices.len(), limits.triangles)?;
    for (i, triangle) in mesh.indices.iter().enumerate() {
        for (corner, index) in triangle.iter().enumerate() {
            if *index as usize >= vertices {
                return Err(SceneError::invalid(
                    indices.index(i).index(corner),
                    index.to_string(),
                    format!("less than the number of positions, {vertices}"),
                ));
            }
        }
    }
    if let Some(normals) = &mesh.normals {
        let path = path.field("normals");
        one_a_position(&path, normals.len(), vertices)?;
        for (i, normal) in normals.iter().enumerate() {
            rules::direction(&path.index(i), normal)?;
        }
    }
    if mesh.texcoords.is_none() && mesh.material.base_color_texture.is_some() {
        return Err(SceneError::invalid(
            path.field("texcoords"),
            "nothing",
            "one a position, since the material has a texture",
        ));
    }
    if let Some(texcoords) = &mesh.texcoords {
        let path = path.field("texcoords");
        one_a_position(&path, texcoords.len(), vertices)?;
        for (i, texcoord) in texcoords.iter().enumerate() {
            for (axis, value) in texcoord.iter().enumerate() {
                rules::range(&path.index(i).index(axis), *value, -1e6, 1e6)?;
            }
        }
    }
    Ok(())
}

fn one_a_position(path: &JsonPath, found: usize, vertices: usize) -> Result<(), SceneError> {
    if found == vertices {
        return Ok(());
    }
    Err(SceneError::invalid(
        path,
        format!("{found} entries"),
        format!("one a position, {vertices}"),
    ))
}

fn quad(quad: &QuadGeometry, path: &JsonPath) -> Result<(), SceneError> {
    rules::position(&path.field("corner"), &quad.corner)?;
    let (u_path, v_path) = (path.field("edge_u"), path.field("edge_v"));
    rules::direction(&u_path, &quad.edge_u)?;
    rules::direction(&v_path, &quad.edge_v)?;
    let (u, v) = (
        DVec3::from_array(quad.edge_u),
        DVec3::from_array(quad.edge_v),
    );
    if u.cross(v).length() < 1e-6 * u.length() * v.length() {
        return Err(SceneError::invalid(
            v_path,
            format!("{}, parallel to edge_u", rules::list(&quad.edge_v)),
            "an edge that spans an area with edge_u",
        ));
    }
    Ok(())
}
