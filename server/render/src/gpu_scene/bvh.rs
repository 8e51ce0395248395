//! The BVH for compute traversal: built on the CPU, binary nodes as `wesl/geometry/bvh.wesl` reads them.

use glam::{DVec3, Vec3A};
use obvhs::BvhBuildParams;
use obvhs::bvh2::Bvh2;
use obvhs::triangle::Triangle;
use tyndall_scene::Geometry;
use tyndall_shaders::types::BvhNode;

use super::geometry::{buffer, check};
use crate::device::Device;
use crate::error::RenderError;

/// Deepest tree the traversal's stack holds (`STACK_SIZE` in `geometry/bvh.wesl`).
const MAX_DEPTH: usize = 48;

/// Nodes and triangles on the device, relative to the geometry's anchor.
#[derive(Debug)]
pub(crate) struct GpuBvh {
    pub nodes: wgpu::Buffer,
    pub vertices: wgpu::Buffer,
}

impl GpuBvh {
    /// Builds over all instances. Serial, so equal geometry gives equal bits.
    pub fn build(device: &Device, source: &Geometry, anchor: DVec3) -> Result<Self, RenderError> {
        let limit = device.device.limits().max_storage_buffer_binding_size;
        let (nodes, vertices) = bvh_bytes(source, anchor)?;
        check("bytes of BVH nodes", nodes.len() as u64, limit)?;
        check("bytes of BVH triangles", vertices.len() as u64, limit)?;
        let storage = wgpu::BufferUsages::STORAGE;
        Ok(Self {
            nodes: buffer(device, "bvh.nodes", &nodes, storage),
            vertices: buffer(device, "bvh.vertices", &vertices, storage),
        })
    }
}

/// Nodes and triangle vertices as the shader reads them.
pub(crate) fn bvh_bytes(
    source: &Geometry,
    anchor: DVec3,
) -> Result<(Vec<u8>, Vec<u8>), RenderError> {
    let triangles = world_triangles(source, anchor);
    let mut duration = std::time::Duration::ZERO;
    let parameters = BvhBuildParams::medium_build();
    let bvh = obvhs::bvh2::builder::build_bvh2_from_tris(&triangles, parameters, &mut duration);
    check("levels of the BVH", depth_of(&bvh) as u64, MAX_DEPTH as u64)?;
    let nodes: Vec<BvhNode> = bvh
        .nodes
        .iter()
        .map(|node| BvhNode {
            min: node.aabb().min.to_array(),
            primitive_count: node.prim_count,
            max: node.aabb().max.to_array(),
            first_index: node.first_index,
        })
        .collect();
    let vertices: Vec<[f32; 4]> = bvh
        .primitive_indices
        .iter()
        .flat_map(|index| {
            let triangle = &triangles[*index as usize];
            [triangle.v0, triangle.v1, triangle.v2].map(|v| [v.x, v.y, v.z, 0.0])
        })
        .collect();
    Ok((
        bytemuck::cast_slice(&nodes).to_vec(),
        bytemuck::cast_slice(&vertices).to_vec(),
    ))
}

/// Triangles of all instances relative to `anchor`.
fn world_triangles(source: &Geometry, anchor: DVec3) -> Vec<Triangle> {
    let mut triangles = Vec::new();
    for instance in &source.instances {
        let mesh = &source.meshes[instance.mesh];
        let place = |index: u32| -> Vec3A {
            let p = DVec3::from(mesh.positions[index as usize].map(f64::from));
            (instance.world_from_object.transform_point3(p) - anchor).as_vec3a()
        };
        triangles.extend(mesh.indices.chunks_exact(3).map(|t| Triangle {
            v0: place(t[0]),
            v1: place(t[1]),
            v2: place(t[2]),
        }));
    }
    triangles
}

/// Levels below the root; the tree's own `max_depth` is an upper estimate only.
fn depth_of(bvh: &Bvh2) -> usize {
    if bvh.nodes.is_empty() {
        return 0;
    }
    let mut deepest = 0;
    let mut stack = vec![(0_usize, 1_usize)];
    while let Some((index, depth)) = stack.pop() {
        deepest = deepest.max(depth);
        let node = &bvh.nodes[index];
        if !node.is_leaf() {
            let first = node.first_index as usize;
            stack.extend([(first, depth + 1), (first + 1, depth + 1)]);
        }
    }
    deepest
}
