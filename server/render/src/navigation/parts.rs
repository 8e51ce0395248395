//! The things that surfaces make: triangles that share corners belong together.
//!
//! Meshes say little about things: a file may hold a whole town in one, and a scene's shapes of one material
//! are one mesh. A ground under a house shares no corner with it.

use std::collections::HashMap;

use glam::{DVec3, Vec3};
use tyndall_scene::{Aabb, Geometry, Mesh};

/// A thing.
#[derive(Debug, Clone, Copy)]
pub(super) struct Part {
    /// Unit: m.
    pub(super) bounds: Aabb,
    /// Its material gives light.
    pub(super) glows: bool,
}

/// The things of a geometry.
#[derive(Debug, Default)]
pub(super) struct Parts {
    pub(super) all: Vec<Part>,
    /// Index of the part of each triangle, triangles in the order of instances.
    pub(super) of_triangle: Vec<u32>,
}

/// The parts of one mesh, in its own space.
struct MeshParts {
    bounds: Vec<Aabb>,
    of_triangle: Vec<u32>,
}

impl Parts {
    /// Cost: one pass over the corners of all meshes, and one over the triangles of all instances.
    pub(super) fn of(geometry: &Geometry) -> Self {
        let mut known: HashMap<usize, MeshParts> = HashMap::new();
        let mut parts = Self::default();
        for instance in &geometry.instances {
            let mesh = &geometry.meshes[instance.mesh];
            let own = known
                .entry(instance.mesh)
                .or_insert_with(|| mesh_parts(mesh));
            let first = parts.all.len() as u32;
            let glows = geometry.materials[mesh.material].emission != [0.0; 3];
            let placed = own.bounds.iter().map(|local| {
                let world = |corner: usize| {
                    let high = |axis: usize| corner >> axis & 1 == 1;
                    let local = DVec3::from_array(std::array::from_fn(|axis| {
                        if high(axis) {
                            local.max[axis]
                        } else {
                            local.min[axis]
                        }
                    }));
                    instance.world_from_object.transform_point3(local)
                };
                let bounds = around((0..8).map(world));
                Part { bounds, glows }
            });
            parts.all.extend(placed);
            let numbers = own.of_triangle.iter().map(|part| first + part);
            parts.of_triangle.extend(numbers);
        }
        parts
    }
}

fn mesh_parts(mesh: &Mesh) -> MeshParts {
    let mut joined = Joined::new(mesh.positions.len());
    let mut first_at: HashMap<[u32; 3], usize> = HashMap::with_capacity(mesh.positions.len());
    for (vertex, position) in mesh.positions.iter().enumerate() {
        // Both zeros are one place.
        let place = position.map(|coordinate| (coordinate + 0.0).to_bits());
        joined.join(*first_at.entry(place).or_insert(vertex), vertex);
    }
    for triangle in mesh.indices.chunks_exact(3) {
        joined.join(triangle[0] as usize, triangle[1] as usize);
        joined.join(triangle[0] as usize, triangle[2] as usize);
    }
    let mut numbers: HashMap<usize, u32> = HashMap::new();
    let mut bounds: Vec<Aabb> = Vec::new();
    let mut of_triangle = Vec::with_capacity(mesh.indices.len() / 3);
    for triangle in mesh.indices.chunks_exact(3) {
        let corners = triangle.iter().map(|index| {
            let position = mesh.positions[*index as usize];
            Vec3::from_array(position).as_dvec3()
        });
        let own = around(corners);
        let number = *numbers
            .entry(joined.root(triangle[0] as usize))
            .or_insert(bounds.len() as u32);
        match bounds.get_mut(number as usize) {
            Some(known) => *known = union(known, &own),
            None => bounds.push(own),
        }
        of_triangle.push(number);
    }
    MeshParts {
        bounds,
        of_triangle,
    }
}

/// Sets of vertices that belong together (union–find with path halving).
struct Joined(Vec<usize>);

impl Joined {
    fn new(count: usize) -> Self {
        Self((0..count).collect())
    }

    fn root(&mut self, mut vertex: usize) -> usize {
        while self.0[vertex] != vertex {
            self.0[vertex] = self.0[self.0[vertex]];
            vertex = self.0[vertex];
        }
        vertex
    }

    fn join(&mut self, a: usize, b: usize) {
        let (a, b) = (self.root(a), self.root(b));
        // The smaller number leads, so that equal meshes give equal parts.
        self.0[a.max(b)] = a.min(b);
    }
}

/// The box around points; around the origin without any. Unit: m.
pub(super) fn around(points: impl Iterator<Item = DVec3>) -> Aabb {
    let boxes = points.map(|point| Aabb {
        min: point,
        max: point,
    });
    let nowhere = Aabb {
        min: DVec3::ZERO,
        max: DVec3::ZERO,
    };
    boxes.reduce(|a, b| union(&a, &b)).unwrap_or(nowhere)
}

/// The box around two boxes.
pub(super) fn union(a: &Aabb, b: &Aabb) -> Aabb {
    Aabb {
        min: a.min.min(b.min),
        max: a.max.max(b.max),
    }
}
