//! Meshes, materials and textures for the peer, triangles in world space.

use std::collections::BTreeSet;

use glam::{DVec3, Vec2, Vec3};
use serde_json::{Value, json};
use tyndall_scene::{ColorSpace, Material, Mesh, Scene, TextureRef, Wrap};

use super::files::Files;
use crate::error::BenchError;

/// Cosine between a vertex normal and its triangle's below which a mesh counts as smooth.
const FLAT: f64 = 0.9999;

/// As JSON. Textures have the scene's indices; those that nothing uses are null.
pub(super) struct Surfaces {
    pub meshes: Vec<Value>,
    pub textures: Vec<Value>,
}

/// The inner error names what the peer can't be given.
pub(super) fn surfaces(
    scene: &Scene,
    files: &mut Files<'_>,
    remarks: &mut Vec<String>,
) -> Result<Result<Surfaces, String>, BenchError> {
    let mut meshes = Vec::new();
    let mut used = BTreeSet::new();
    let mut counts = Counts::default();
    for i in 0..scene.geometry.instances.len() {
        match mesh(scene, i, files, &mut used, &mut counts)? {
            Ok(mesh) => meshes.push(mesh),
            Err(what) => return Ok(Err(what)),
        }
    }
    counts.tell(remarks);
    let mut textures = vec![Value::Null; scene.geometry.textures.len()];
    for index in used {
        textures[index] = texture(scene, index, files)?;
    }
    Ok(Ok(Surfaces { meshes, textures }))
}

/// All corners of triangles, three a triangle.
pub(super) fn corners(scene: &Scene) -> Vec<DVec3> {
    let mut corners = Vec::new();
    for (i, instance) in scene.geometry.instances.iter().enumerate() {
        let positions: Vec<DVec3> = world(scene, i).collect();
        let indices = &scene.geometry.meshes[instance.mesh].indices;
        corners.extend(indices.iter().map(|index| positions[*index as usize]));
    }
    corners
}

/// World positions of an instance's vertices.
fn world(scene: &Scene, instance: usize) -> impl Iterator<Item = DVec3> {
    let instance = &scene.geometry.instances[instance];
    let positions = &scene.geometry.meshes[instance.mesh].positions;
    let transform = instance.world_from_object;
    positions
        .iter()
        .map(move |p| transform.transform_point3(DVec3::from(p.map(f64::from))))
}

/// What is nearly the same in the peer.
#[derive(Default)]
struct Counts {
    one_sided: usize,
    glowing_backs: usize,
    smooth: usize,
    mapped: usize,
}

impl Counts {
    fn tell(&self, remarks: &mut Vec<String>) {
        for (count, what) in [
            (
                self.one_sided,
                "one-sided surfaces: black from behind in the peer, not there in tyndall",
            ),
            (
                self.glowing_backs,
                "two-sided emitters: their back is dark in the peer",
            ),
            (
                self.smooth,
                "smooth meshes: where their normals look away from the viewer, the triangle's counts in \
                 tyndall",
            ),
            (
                self.mapped,
                "normal maps: where they look away from the viewer, the triangle's normal counts in \
                 tyndall",
            ),
        ] {
            if count > 0 {
                remarks.push(format!("{count} {what}"));
            }
        }
    }
}

fn mesh(
    scene: &Scene,
    i: usize,
    files: &mut Files<'_>,
    used: &mut BTreeSet<usize>,
    counts: &mut Counts,
) -> Result<Result<Value, String>, BenchError> {
    let instance = &scene.geometry.instances[i];
    let mesh = &scene.geometry.meshes[instance.mesh];
    let material = &scene.geometry.materials[mesh.material];
    let uses = [
        material.base_color_texture,
        material.emission_texture,
        material.metallic_roughness_texture,
        material.normal_texture,
    ];
    let coordinates = match coordinates(mesh, material, &uses) {
        Ok(coordinates) => coordinates,
        Err(what) => return Ok(Err(format!("mesh \"{}\": {what}", mesh.name))),
    };
    used.extend(uses.iter().flatten().map(|use_| use_.texture));
    let texcoords = match coordinates {
        None => None,
        Some(use_) => {
            let [u, v] = use_.uv_transform.map(Vec3::from_array);
            let moved = mesh.texcoords[usize::from(use_.texcoord_set)]
                .iter()
                .flat_map(|uv| {
                    let uv = Vec2::from_array(*uv).extend(1.0);
                    [u.dot(uv), v.dot(uv)]
                });
            Some(files.floats(&format!("mesh{i}.uv"), moved)?)
        }
    };
    let glows = material.emission.iter().any(|value| *value > 0.0);
    counts.one_sided += usize::from(!material.double_sided && !glows);
    counts.glowing_backs += usize::from(material.double_sided && glows);
    counts.mapped += usize::from(material.normal_texture.is_some());
    let corners: Vec<DVec3> = world(scene, i).collect();
    let positions = corners.iter().flat_map(|p| p.as_vec3().to_array());
    let positions = files.floats(&format!("mesh{i}.f32"), positions)?;
    let mirrored = instance.world_from_object.matrix3.determinant() < 0.0;
    let order: [usize; 3] = if mirrored { [0, 2, 1] } else { [0, 1, 2] };
    let indices: Vec<u32> = mesh
        .indices
        .chunks_exact(3)
        .flat_map(|triangle| order.map(|corner| triangle[corner]))
        .collect();
    let normals = smooth_normals(scene, i, &corners, &indices);
    counts.smooth += usize::from(normals.is_some());
    let normals = normals
        .map(|normals| {
            let values = normals.iter().flat_map(|n| n.as_vec3().to_array());
            files.floats(&format!("mesh{i}.normal"), values)
        })
        .transpose()?;
    let colors = (!mesh.colors.is_empty())
        .then(|| {
            let rgb = mesh.colors.iter().flat_map(|c| [c[0], c[1], c[2]]);
            files.floats(&format!("mesh{i}.color"), rgb.map(|c| f32::from(c) / 255.0))
        })
        .transpose()?;
    let bytes: Vec<u8> = indices.into_iter().flat_map(u32::to_le_bytes).collect();
    let texture = |use_: Option<TextureRef>| use_.map(|use_| use_.texture);
    Ok(Ok(json!({
        "positions": positions,
        "normals": normals,
        "texcoords": texcoords,
        "colors": colors,
        "indices": files.write(&format!("mesh{i}.u32"), &bytes)?,
        "two_sided": material.double_sided,
        "reflectance": &material.base_color[..3],
        "alpha": material.base_color[3],
        "alpha_cutoff": material.alpha_cutoff,
        "emission": material.emission,
        "metallic": material.metallic,
        "roughness": material.roughness,
        "normal_scale": material.normal_scale,
        "base_color_texture": texture(material.base_color_texture),
        "emission_texture": texture(material.emission_texture),
        "surface_texture": texture(material.metallic_roughness_texture),
        "normal_texture": texture(material.normal_texture),
    })))
}

/// The one set of coordinates, placed one way, that all textures of a mesh use: the peer has no other.
fn coordinates(
    mesh: &Mesh,
    material: &Material,
    uses: &[Option<TextureRef>; 4],
) -> Result<Option<TextureRef>, &'static str> {
    let mut known: Option<TextureRef> = None;
    for use_ in uses.iter().flatten() {
        let place = |use_: &TextureRef| (use_.texcoord_set, use_.uv_transform);
        if known.is_some_and(|known| place(&known) != place(use_)) {
            return Err("textures with different coordinates");
        }
        known = Some(*use_);
    }
    if known.is_some_and(|known| mesh.texcoords[usize::from(known.texcoord_set)].is_empty()) {
        return Err("textures without texture coordinates");
    }
    let colored = !mesh.colors.is_empty();
    if colored && (material.base_color_texture.is_some() || material.alpha_cutoff.is_some()) {
        return Err("vertex colours together with a texture or an alpha mask");
    }
    if material.alpha_cutoff.is_some() && material.emission_texture.is_some() {
        return Err("an alpha mask together with a texture of emission");
    }
    Ok(known)
}

/// The world's vertex normals, unless all are those of their triangles.
fn smooth_normals(
    scene: &Scene,
    instance: usize,
    corners: &[DVec3],
    indices: &[u32],
) -> Option<Vec<DVec3>> {
    let instance = &scene.geometry.instances[instance];
    let mesh = &scene.geometry.meshes[instance.mesh];
    let turn = instance.world_from_object.matrix3.inverse().transpose();
    let normals: Vec<DVec3> = mesh
        .normals
        .iter()
        .map(|n| (turn * DVec3::from(n.map(f64::from))).normalize_or_zero())
        .collect();
    let flat = indices.chunks_exact(3).all(|triangle| {
        let [a, b, c] = [0, 1, 2].map(|i| corners[triangle[i] as usize]);
        let plane = (b - a).cross(c - a).normalize_or_zero();
        triangle
            .iter()
            .all(|i| normals[*i as usize].dot(plane) > FLAT)
    });
    (!flat).then_some(normals)
}

fn texture(scene: &Scene, index: usize, files: &mut Files<'_>) -> Result<Value, BenchError> {
    let texture = &scene.geometry.textures[index];
    let wrap = texture.wrap.map(|wrap| match wrap {
        Wrap::Repeat => "repeat",
        Wrap::MirroredRepeat => "mirror",
        Wrap::ClampToEdge => "clamp",
    });
    Ok(json!({
        "file": files.write(&format!("texture{index}.u8"), &texture.pixels)?,
        "width": texture.width,
        "height": texture.height,
        "srgb": texture.color_space == ColorSpace::Srgb,
        "wrap": wrap,
    }))
}
