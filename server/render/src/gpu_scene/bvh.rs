//! The BVH for compute traversal: built on the CPU, compressed wide nodes as `wesl/geometry/bvh.wesl`
//! reads them.

use glam::{DVec3, Vec3A};
use obvhs::BvhBuildParams;
use obvhs::cwbvh::CwBvh;
use obvhs::cwbvh::builder::build_cwbvh_from_tris;
use obvhs::triangle::Triangle;
use tyndall_scene::{Geometry, Instance, Material, Mesh};

use super::geometry::{buffer, check};
use crate::device::Device;
use crate::error::RenderError;

/// Deepest tree the traversal's stack holds (`STACK_SIZE` in `geometry/bvh.wesl`).
const MAX_DEPTH: usize = 24;

/// Nodes and triangles on the device, relative to the geometry's anchor.
#[derive(Debug)]
pub(crate) struct GpuBvh {
    pub nodes: wgpu::Buffer,
    pub vertices: wgpu::Buffer,
    /// Number of each triangle among those of all instances, in the order of the leaves.
    pub order: Vec<u32>,
}

impl GpuBvh {
    /// Builds over all instances. Serial, so equal geometry gives equal bits.
    pub fn build(device: &Device, source: &Geometry, anchor: DVec3) -> Result<Self, RenderError> {
        let limit = device.device.limits().max_storage_buffer_binding_size;
        let BvhParts {
            nodes,
            vertices,
            order,
        } = bvh_parts(source, anchor)?;
        check("bytes of BVH nodes", nodes.len() as u64, limit)?;
        check("bytes of BVH triangles", vertices.len() as u64, limit)?;
        let storage = wgpu::BufferUsages::STORAGE;
        Ok(Self {
            nodes: buffer(device, "bvh.nodes", &nodes, storage),
            vertices: buffer(device, "bvh.vertices", &vertices, storage),
            order,
        })
    }
}

/// A BVH as the shader reads it.
pub(crate) struct BvhParts {
    pub nodes: Vec<u8>,
    pub vertices: Vec<u8>,
    pub order: Vec<u32>,
}

/// Builds nodes and triangle vertices.
pub(crate) fn bvh_parts(source: &Geometry, anchor: DVec3) -> Result<BvhParts, RenderError> {
    let triangles = world_triangles(source, anchor);
    let flags: Vec<[f32; 3]> = corners(source).map(|corner| corner.flags()).collect();
    let mut duration = std::time::Duration::ZERO;
    let parameters = BvhBuildParams::medium_build();
    let bvh = build_cwbvh_from_tris(&triangles, parameters, &mut duration);
    check("levels of the BVH", depth_of(&bvh) as u64, MAX_DEPTH as u64)?;
    let vertices: Vec<[f32; 4]> = bvh
        .primitive_indices
        .iter()
        .flat_map(|index| {
            let triangle = &triangles[*index as usize];
            let [a, b, c] = flags[*index as usize];
            let corner = |v: Vec3A, flag: f32| [v.x, v.y, v.z, flag];
            [
                corner(triangle.v0, a),
                corner(triangle.v1, b),
                corner(triangle.v2, c),
            ]
        })
        .collect();
    Ok(BvhParts {
        nodes: bytemuck::cast_slice(&bvh.nodes).to_vec(),
        vertices: bytemuck::cast_slice(&vertices).to_vec(),
        order: bvh.primitive_indices,
    })
}

/// A triangle of an instance.
pub(super) struct Corners<'a> {
    pub instance: &'a Instance,
    pub mesh: &'a Mesh,
    pub material: &'a Material,
    /// Vertices, counter-clockwise in the world seen from the front.
    pub vertices: [usize; 3],
}

impl Corners<'_> {
    /// What the traversal wants to know, one number a corner: single-sided, masked, nothing.
    fn flags(&self) -> [f32; 3] {
        let flag = |set: bool| if set { 1.0 } else { 0.0 };
        [
            flag(!self.material.double_sided),
            flag(self.material.alpha_cutoff.is_some()),
            0.0,
        ]
    }
}

/// Triangles of all instances, in the order of their numbers.
pub(super) fn corners(source: &Geometry) -> impl Iterator<Item = Corners<'_>> {
    source.instances.iter().flat_map(move |instance| {
        let mesh = &source.meshes[instance.mesh];
        // A transform that mirrors turns the winding round.
        let mirrored = instance.world_from_object.matrix3.determinant() < 0.0;
        mesh.indices.chunks_exact(3).map(move |t| {
            let t = [t[0] as usize, t[1] as usize, t[2] as usize];
            Corners {
                instance,
                mesh,
                material: &source.materials[mesh.material],
                vertices: if mirrored { [t[0], t[2], t[1]] } else { t },
            }
        })
    })
}

/// Triangles of all instances relative to `anchor`.
pub(super) fn world_triangles(source: &Geometry, anchor: DVec3) -> Vec<Triangle> {
    corners(source)
        .map(|corner| {
            let [v0, v1, v2] = corner.vertices.map(|index| {
                let p = DVec3::from(corner.mesh.positions[index].map(f64::from));
                let world = corner.instance.world_from_object.transform_point3(p);
                (world - anchor).as_vec3a()
            });
            Triangle { v0, v1, v2 }
        })
        .collect()
}

/// Levels of the tree: each may leave one group on the traversal's stack.
fn depth_of(bvh: &CwBvh) -> usize {
    let mut deepest = 0;
    let mut stack = vec![(0_u32, 1_usize)];
    while let Some((index, depth)) = stack.pop() {
        let Some(node) = bvh.nodes.get(index as usize) else {
            continue;
        };
        deepest = deepest.max(depth);
        let children = node.imask.count_ones();
        stack.extend((0..children).map(|i| (node.child_base_idx + i, depth + 1)));
    }
    deepest
}
