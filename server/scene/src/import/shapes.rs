//! Primitives as triangles, in double precision and already placed in the world.

use std::f64::consts::{PI, TAU};

use glam::{DAffine3, DVec2, DVec3};

use super::transform::normal_matrix;
use crate::description::geometry::{BoxGeometry, QuadGeometry, SphereGeometry};

/// Slices of a sphere around its y axis.
const SLICES: u32 = 32;
/// Stacks of a sphere from pole to pole: 2 · 32 · (16 − 1) = 960 triangles.
const STACKS: u32 = 16;

/// Vertices and counter-clockwise triangles.
#[derive(Debug, Default)]
pub(super) struct Shape {
    pub(super) positions: Vec<DVec3>,
    /// One a vertex, any length above zero.
    pub(super) normals: Vec<DVec3>,
    pub(super) texcoords: Vec<DVec2>,
    pub(super) indices: Vec<[u32; 3]>,
}

impl Shape {
    /// Six quads facing outward.
    pub(super) fn cuboid(geometry: &BoxGeometry) -> Self {
        let (min, max) = (
            DVec3::from_array(geometry.min),
            DVec3::from_array(geometry.max),
        );
        let mut shape = Self::default();
        for axis in 0..3 {
            let (u_axis, v_axis) = ((axis + 1) % 3, (axis + 2) % 3);
            let edge = |i: usize| DVec3::AXES[i] * (max - min)[i];
            let (u, v) = (edge(u_axis), edge(v_axis));
            // u × v points along +axis: the high face as is, the low face with u and v swapped.
            shape.add_quad(min + edge(axis), u, v);
            shape.add_quad(min, v, u);
        }
        shape
    }

    /// Two triangles.
    pub(super) fn quad(geometry: &QuadGeometry) -> Self {
        let mut shape = Self::default();
        shape.add_quad(
            DVec3::from_array(geometry.corner),
            DVec3::from_array(geometry.edge_u),
            DVec3::from_array(geometry.edge_v),
        );
        shape
    }

    /// Slices and stacks with smooth normals; the vertices lie on the sphere.
    pub(super) fn sphere(geometry: &SphereGeometry) -> Self {
        let center = DVec3::from_array(geometry.center);
        let mut shape = Self::default();
        for stack in 0..=STACKS {
            let v = f64::from(stack) / f64::from(STACKS);
            let (sin_polar, cos_polar) = (v * PI).sin_cos();
            for slice in 0..=SLICES {
                let u = f64::from(slice) / f64::from(SLICES);
                let (sin, cos) = (u * TAU).sin_cos();
                let normal = DVec3::new(sin_polar * sin, cos_polar, sin_polar * cos);
                shape.positions.push(center + geometry.radius * normal);
                shape.normals.push(normal);
                shape.texcoords.push(DVec2::new(u, v));
            }
        }
        let row = SLICES + 1;
        for stack in 0..STACKS {
            for slice in 0..SLICES {
                let (a, b) = (stack * row + slice, (stack + 1) * row + slice);
                if stack > 0 {
                    shape.indices.push([a, b, a + 1]);
                }
                if stack + 1 < STACKS {
                    shape.indices.push([a + 1, b, b + 1]);
                }
            }
        }
        shape
    }

    fn add_quad(&mut self, corner: DVec3, u: DVec3, v: DVec3) {
        let first = self.positions.len() as u32;
        self.positions
            .extend([corner, corner + u, corner + u + v, corner + v]);
        self.normals.extend([u.cross(v); 4]);
        let uv = [(0.0, 1.0), (1.0, 1.0), (1.0, 0.0), (0.0, 0.0)];
        self.texcoords.extend(uv.map(DVec2::from));
        let quad = [[0, 1, 2], [0, 2, 3]];
        self.indices.extend(quad.map(|t| t.map(|i| first + i)));
    }

    /// Places the shape; mirroring turns the triangles round again.
    pub(super) fn placed(mut self, map: &DAffine3) -> Self {
        if *map == DAffine3::IDENTITY {
            return self;
        }
        for position in &mut self.positions {
            *position = map.transform_point3(*position);
        }
        let normal_matrix = normal_matrix(map);
        for normal in &mut self.normals {
            *normal = normal_matrix * *normal;
        }
        if map.matrix3.determinant() < 0.0 {
            for triangle in &mut self.indices {
                triangle.swap(1, 2);
            }
        }
        self
    }
}
