//! The still surfaces of a scene as a camera meets them: a BVH, and which thing each triangle belongs to.

use std::sync::Arc;

use glam::{DVec3, Vec3A};
use tyndall_scene::{Aabb, Geometry, Instance, Scene};

use super::framing::Framing;
use super::parts::{Part, Parts};
use crate::error::RenderError;
use crate::gpu_scene::{CpuBvh, CpuHit};

/// How near a step leads to a surface, as a share of the scene's diagonal.
const MARGIN: f64 = 0.012;
/// The largest such margin. Unit: m.
const LARGEST_MARGIN: f64 = 0.4;

/// Surfaces that no keyframes move.
#[derive(Debug)]
pub(super) struct Solids {
    bvh: CpuBvh,
    /// Point that the BVH's coordinates are relative to. Unit: m.
    anchor: DVec3,
    parts: Parts,
    /// Of each part, whether it is a ground plane or a sky: such surround no camera.
    backdrops: Vec<bool>,
    /// Box around what is worth looking at. Unit: m.
    pub(super) bounds: Aabb,
}

impl Solids {
    pub(super) fn build(scene: &Scene) -> Result<Self, RenderError> {
        let still = Geometry {
            surfaces: Arc::clone(&scene.geometry.surfaces),
            instances: still_instances(&scene.geometry),
            tracks: Arc::default(),
        };
        let parts = Parts::of(&still);
        let framing = Framing::of(scene, &parts);
        let is_backdrop = |part: &Part| framing.is_backdrop(&part.bounds);
        let anchor = still.bounds().map_or(DVec3::ZERO, |b| middle(&b));
        Ok(Self {
            bvh: CpuBvh::build(&still, anchor)?,
            anchor,
            backdrops: parts.all.iter().map(is_backdrop).collect(),
            parts,
            bounds: framing.bounds,
        })
    }

    /// Length of the diagonal of what is worth looking at. Unit: m.
    pub(super) fn extent(&self) -> f64 {
        (self.bounds.max - self.bounds.min).length()
    }

    /// How near a step leads to a surface. Unit: m.
    pub(super) fn margin(&self) -> f64 {
        (MARGIN * self.extent()).min(LARGEST_MARGIN)
    }

    /// The nearest surface along a unit direction, as the picture shows it. Unit: m.
    pub(super) fn closest(&self, from: DVec3, direction: DVec3, limit: f64) -> Option<CpuHit> {
        let origin = (from - self.anchor).as_vec3a();
        let direction = direction.as_vec3a();
        self.bvh.closest(origin, direction, limit as f32)
    }

    /// Whether the nearest surface along a unit direction shows its back. Unit: m.
    pub(super) fn shows_back(&self, from: DVec3, direction: DVec3, limit: f64) -> bool {
        let origin = (from - self.anchor).as_vec3a();
        let direction: Vec3A = direction.as_vec3a();
        let hit = self
            .bvh
            .closest_of_both_sides(origin, direction, limit as f32);
        hit.is_some_and(|hit| self.bvh.normal(hit.triangle).dot(direction) > 0.0)
    }

    /// Unit normal of a triangle on the side that a direction comes from.
    pub(super) fn normal_against(&self, triangle: u32, direction: DVec3) -> DVec3 {
        let normal = self.bvh.normal(triangle).as_dvec3();
        if normal.dot(direction) > 0.0 {
            -normal
        } else {
            normal
        }
    }

    /// Box around the thing that a triangle belongs to. Unit: m.
    pub(super) fn thing_of(&self, triangle: u32) -> Aabb {
        self.parts.all[self.part_of(triangle)].bounds
    }

    /// Whether a triangle belongs to a ground plane or a sky.
    pub(super) fn is_backdrop(&self, triangle: u32) -> bool {
        self.backdrops[self.part_of(triangle)]
    }

    fn part_of(&self, triangle: u32) -> usize {
        self.parts.of_triangle[triangle as usize] as usize
    }
}

/// Instances that no track moves.
fn still_instances(geometry: &Geometry) -> Vec<Instance> {
    let mut moves = vec![false; geometry.instances.len()];
    for (index, _) in geometry.tracks.iter().flat_map(|track| &track.instances) {
        moves[*index] = true;
    }
    let instances = geometry.instances.iter().zip(moves);
    instances
        .filter(|(_, moves)| !moves)
        .map(|(instance, _)| *instance)
        .collect()
}

pub(super) fn middle(bounds: &Aabb) -> DVec3 {
    0.5 * (bounds.min + bounds.max)
}

pub(super) fn contains(bounds: &Aabb, point: DVec3) -> bool {
    bounds.min.cmple(point).all() && point.cmple(bounds.max).all()
}
