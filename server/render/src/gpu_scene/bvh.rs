//! The BVH: built on the CPU, kept there for tracing, and uploaded as compressed wide nodes as
//! `wesl/geometry/bvh.wesl` reads them.

use std::sync::Arc;

use glam::{DVec3, Vec3A};
use obvhs::BvhBuildParams;
use obvhs::cwbvh::CwBvh;
use obvhs::cwbvh::builder::build_cwbvh_from_tris;
use obvhs::ray::{Ray, RayHit};
use obvhs::triangle::Triangle;
use tyndall_scene::{Geometry, Instance, Material, Mesh};

use super::upload::{buffer, check};
use crate::engine::Device;
use crate::error::RenderError;

/// Deepest tree the traversal's stack holds (`STACK_SIZE` in `geometry/bvh.wesl`).
const MAX_DEPTH: usize = 24;

/// The BVH on the CPU, of all instances, relative to the geometry's anchor.
#[derive(Debug)]
pub(crate) struct CpuBvh {
    tree: CwBvh,
    /// In the order of their numbers, which `tree.primitive_indices` gives for those of the leaves.
    triangles: Vec<Triangle>,
    /// What the traversal wants to know of each: single-sided, masked, nothing.
    flags: Vec<[f32; 3]>,
}

/// What a ray meets.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct CpuHit {
    /// Unit: m.
    pub distance: f32,
    /// Number of the triangle among those of all instances.
    pub triangle: u32,
}

impl CpuBvh {
    /// Builds over all instances. Serial, so equal geometry gives equal bits.
    pub fn build(source: &Geometry, anchor: DVec3) -> Result<Self, RenderError> {
        let triangles = world_triangles(source, anchor);
        let flags = corners(source).map(|corner| corner.flags()).collect();
        let mut duration = std::time::Duration::ZERO;
        let parameters = BvhBuildParams::medium_build();
        let tree = build_cwbvh_from_tris(&triangles, parameters, &mut duration);
        check(
            "levels of the BVH",
            depth_of(&tree) as u64,
            MAX_DEPTH as u64,
        )?;
        Ok(Self {
            tree,
            triangles,
            flags,
        })
    }

    /// The nearest triangle along a ray, within `limit`; `origin` is relative to the anchor, `direction`
    /// unit. Single-sided triangles are not met from behind. Holes of alpha masks are met as if they were
    /// none. Unit: m.
    pub fn closest(&self, origin: Vec3A, direction: Vec3A, limit: f32) -> Option<CpuHit> {
        self.nearest(origin, direction, limit, true)
    }

    /// [`Self::closest`], but single-sided triangles are met from behind, too.
    pub fn closest_of_both_sides(
        &self,
        origin: Vec3A,
        direction: Vec3A,
        limit: f32,
    ) -> Option<CpuHit> {
        self.nearest(origin, direction, limit, false)
    }

    /// Unit normal of a triangle, toward its front.
    pub fn normal(&self, triangle: u32) -> Vec3A {
        let normal = self.triangles[triangle as usize].compute_normal();
        normal.normalize_or(Vec3A::Y)
    }

    fn nearest(&self, origin: Vec3A, direction: Vec3A, limit: f32, culled: bool) -> Option<CpuHit> {
        if self.triangles.is_empty() {
            return None;
        }
        let mut hit = RayHit::none();
        let ray = Ray::new(origin, direction, 0.0, limit);
        let number = |leaf: usize| self.tree.primitive_indices[leaf] as usize;
        let found = self.tree.ray_traverse(ray, &mut hit, |ray, leaf| {
            let number = number(leaf);
            let triangle = &self.triangles[number];
            let [single_sided, ..] = self.flags[number];
            let from_behind = triangle.compute_normal().dot(ray.direction) > 0.0;
            if culled && single_sided > 0.0 && from_behind {
                f32::MAX
            } else {
                triangle.intersect(ray)
            }
        });
        found.then(|| CpuHit {
            distance: hit.t,
            triangle: number(hit.primitive_id as usize) as u32,
        })
    }

    /// Nodes and triangle vertices as the shader reads them.
    pub fn bytes(&self) -> (Vec<u8>, Vec<u8>) {
        let leaves = self.tree.primitive_indices.iter();
        let vertices: Vec<[f32; 4]> = leaves
            .flat_map(|index| {
                let triangle = &self.triangles[*index as usize];
                let [a, b, c] = self.flags[*index as usize];
                let corner = |v: Vec3A, flag: f32| [v.x, v.y, v.z, flag];
                [
                    corner(triangle.v0, a),
                    corner(triangle.v1, b),
                    corner(triangle.v2, c),
                ]
            })
            .collect();
        (
            bytemuck::cast_slice(&self.tree.nodes).to_vec(),
            bytemuck::cast_slice(&vertices).to_vec(),
        )
    }

    /// Number of each triangle, in the order of the leaves.
    pub fn order(&self) -> &[u32] {
        &self.tree.primitive_indices
    }
}

/// Nodes and triangles on the device, relative to the geometry's anchor.
#[derive(Debug)]
pub(crate) struct GpuBvh {
    pub nodes: wgpu::Buffer,
    pub vertices: wgpu::Buffer,
    /// Where they come from.
    pub source: Arc<CpuBvh>,
}

impl GpuBvh {
    /// Uploads it.
    pub fn upload(device: &Device, source: Arc<CpuBvh>) -> Result<Self, RenderError> {
        let limit = device.device.limits().max_storage_buffer_binding_size;
        let (nodes, vertices) = source.bytes();
        check("bytes of BVH nodes", nodes.len() as u64, limit)?;
        check("bytes of BVH triangles", vertices.len() as u64, limit)?;
        let storage = wgpu::BufferUsages::STORAGE;
        Ok(Self {
            nodes: buffer(device, "bvh.nodes", &nodes, storage),
            vertices: buffer(device, "bvh.vertices", &vertices, storage),
            source,
        })
    }
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
pub(crate) fn world_triangles(source: &Geometry, anchor: DVec3) -> Vec<Triangle> {
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rays_meet_the_nearest_triangle_that_faces_them() {
        let description = tyndall_scene::presets::description("cornell_fog").expect("a preset");
        let scene = tyndall_scene::build(description, None)
            .expect("valid")
            .scene;
        let bvh = CpuBvh::build(&scene.geometry, DVec3::ZERO).expect("built");
        let mut met = 0;
        for i in 0..4000_u32 {
            // Directions spread over the sphere (golden angle).
            let z = 1.0 - 2.0 * (i as f32 + 0.5) / 4000.0;
            let turn = i as f32 * 2.399_963_2;
            let flat = (1.0 - z * z).sqrt();
            let direction = Vec3A::new(flat * turn.cos(), flat * turn.sin(), z);
            let origin = scene.camera.position.as_vec3a();
            let ray = Ray::new(origin, direction, 0.0, 1e4);
            let nearest = bvh
                .triangles
                .iter()
                .zip(&bvh.flags)
                .filter(|(triangle, flags)| {
                    flags[0] <= 0.0 || triangle.compute_normal().dot(direction) <= 0.0
                })
                .map(|(triangle, _)| triangle.intersect(&ray))
                .fold(1e4, f32::min);
            let hit = bvh.closest(origin, direction, 1e4);
            assert_eq!(hit.map_or(1e4, |hit| hit.distance), nearest, "{direction}");
            met += u32::from(hit.is_some());
        }
        assert!(met > 100, "only {met} rays met anything");
    }
}
