//! Attributes of triangles in the order of the BVH's leaves, and the emissive ones by power.

use glam::{DMat3, DVec3, Vec3A};
use obvhs::triangle::Triangle;
use tyndall_scene::Geometry;
use tyndall_shaders::types::{Emitter, TriangleSurface};

use super::bvh::{Corners, GpuBvh, corners, world_triangles};
use super::upload::{buffer, check};
use crate::engine::Device;
use crate::error::RenderError;

/// What a path tracer wants to know of triangles, on the device.
#[derive(Debug)]
pub(crate) struct GpuTriangles {
    pub surfaces: wgpu::Buffer,
    pub emitters: wgpu::Buffer,
    pub emitter_count: u32,
}

impl GpuTriangles {
    /// Uploads for the triangles of `bvh`.
    pub fn upload(device: &Device, source: &Geometry, bvh: &GpuBvh) -> Result<Self, RenderError> {
        let (surfaces, emitters) = triangle_values(source, bvh.source.order());
        let limit = device.device.limits().max_storage_buffer_binding_size;
        let bytes: &[u8] = bytemuck::cast_slice(&surfaces);
        check("bytes of triangle attributes", bytes.len() as u64, limit)?;
        let storage = wgpu::BufferUsages::STORAGE;
        Ok(Self {
            surfaces: buffer(device, "triangles.surfaces", bytes, storage),
            emitters: buffer(
                device,
                "triangles.emitters",
                bytemuck::cast_slice(&emitters),
                storage,
            ),
            emitter_count: emitters.len() as u32,
        })
    }
}

/// Attributes in the order of `order`, and the emissive triangles with their cumulative power.
pub(crate) fn triangle_values(
    source: &Geometry,
    order: &[u32],
) -> (Vec<TriangleSurface>, Vec<Emitter>) {
    let all: Vec<Corners<'_>> = corners(source).collect();
    let places = world_triangles(source, DVec3::ZERO);
    let mut surfaces: Vec<TriangleSurface> = order
        .iter()
        .map(|index| surface_value(&all[*index as usize]))
        .collect();
    let areas: Vec<f64> = order
        .iter()
        .map(|index| area(&places[*index as usize]))
        .collect();
    let powers: Vec<f64> = order
        .iter()
        .zip(&areas)
        .map(|(index, area)| emitted(&all[*index as usize]) * area)
        .collect();
    let total: f64 = powers.iter().sum();
    let mut emitters = Vec::new();
    let mut sum = 0.0;
    for (triangle, power) in powers.iter().enumerate() {
        if *power > 0.0 {
            sum += power;
            surfaces[triangle].emitter_density = (power / total / areas[triangle]) as f32;
            emitters.push(Emitter {
                cumulative: (sum / total) as f32,
                triangle: triangle as u32,
            });
        }
    }
    (surfaces, emitters)
}

/// Radiant exitance up to a factor: what emitter sampling follows.
fn emitted(corner: &Corners<'_>) -> f64 {
    let [r, g, b] = corner.material.emission.map(f64::from);
    let sides = if corner.material.double_sided {
        2.0
    } else {
        1.0
    };
    sides * (0.2126 * r + 0.7152 * g + 0.0722 * b)
}

fn area(triangle: &Triangle) -> f64 {
    let edge = |a: Vec3A, b: Vec3A| (b - a).as_dvec3();
    0.5 * edge(triangle.v0, triangle.v1)
        .cross(edge(triangle.v0, triangle.v2))
        .length()
}

fn surface_value(corner: &Corners<'_>) -> TriangleSurface {
    let (mesh, vertices) = (corner.mesh, corner.vertices);
    let to_world = normal_matrix(corner.instance.world_from_object.matrix3);
    let normal = |index: usize| {
        let n = DVec3::from(mesh.normals[index].map(f64::from));
        (to_world * n).normalize_or_zero().as_vec3().to_array()
    };
    let color = |index: usize| {
        let color = mesh.colors.get(index).copied().unwrap_or([255; 4]);
        u32::from_le_bytes(color)
    };
    let texcoord = |set: usize, index: usize| {
        let found = mesh.texcoords[set].get(index);
        found.copied().unwrap_or_default()
    };
    let pair = |a: [f32; 2], b: [f32; 2]| [a[0], a[1], b[0], b[1]];
    let [i, j, k] = vertices;
    TriangleSurface {
        normal0: normal(i),
        material: mesh.material as u32,
        normal1: normal(j),
        color0: color(i),
        normal2: normal(k),
        color1: color(j),
        texcoords_a: pair(texcoord(0, i), texcoord(0, j)),
        texcoords_b: pair(texcoord(0, k), texcoord(1, i)),
        texcoords_c: pair(texcoord(1, j), texcoord(1, k)),
        emitter_density: 0.0,
        color2: color(k),
        padding: [0; 2],
    }
}

/// Cofactors with the sign that keeps the outside outside where the transform mirrors.
fn normal_matrix(m: DMat3) -> DMat3 {
    let (x, y, z) = (m.x_axis, m.y_axis, m.z_axis);
    let sign = m.determinant().signum();
    DMat3::from_cols(y.cross(z), z.cross(x), x.cross(y)) * sign
}
