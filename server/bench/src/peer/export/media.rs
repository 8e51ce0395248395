//! Media for the peer: boxes around homogeneous coefficients or dense grids.

use glam::{DAffine3, DMat3, DVec3};
use serde_json::{Value, json};
use tyndall_scene::{Aabb, Medium, MediumShape, PhaseFunction, SharedGrid};

use super::files::Files;
use crate::error::BenchError;

/// Voxels along the axis in which height fog falls.
const FOG_VOXELS: usize = 1024;
/// Voxels along each axis of a soft ball.
const BALL_VOXELS: usize = 128;
/// Distance within which a surface lies in a face of a medium's box, as a share of its size.
const FACE_TOLERANCE: f64 = 1e-4;
/// How far such a face moves outward, as a share of the box's size: behind a wall nobody sees it,
/// and two surfaces in one plane would hide one another at random.
const FACE_SHIFT: f64 = 0.01;

/// A medium and the box it lies in, `None` for all of space.
pub(super) fn medium(
    medium: &Medium,
    index: usize,
    corners: &[DVec3],
    files: &mut Files<'_>,
) -> Result<Result<(Value, Option<Aabb>), String>, BenchError> {
    if medium.emission.iter().any(|value| *value > 0.0) {
        return Ok(Err("emission, which its media have not".into()));
    }
    let file = format!("medium{index}.f32");
    let (bounds, grid) = match &medium.shape {
        MediumShape::Homogeneous { bounds } => (*bounds, None),
        MediumShape::HeightFog { bounds: None, .. } => {
            return Ok(Err("height fog without bounds".into()));
        }
        MediumShape::HeightFog {
            up,
            falloff,
            origin,
            bounds: Some(bounds),
        } => {
            let axis = up.abs().as_dvec3();
            let Some(axis) = (0..3).find(|i| axis[*i] > 1.0 - 1e-6) else {
                return Ok(Err("height fog whose up is no axis".into()));
            };
            let (low, high) = (bounds.min[axis], bounds.max[axis]);
            let values = (0..FOG_VOXELS).map(|i| {
                let at = low + (i as f64 + 0.5) / FOG_VOXELS as f64 * (high - low);
                let height = (at - origin[axis]) * f64::from(up[axis]);
                (-f64::from(*falloff) * height).exp() as f32
            });
            let mut shape = [1; 3];
            shape[2 - axis] = FOG_VOXELS;
            let file = files.floats(&file, values)?;
            (Some(*bounds), Some((file, shape, *bounds)))
        }
        MediumShape::Sphere { center, radius } => {
            let bounds = Aabb {
                min: *center - *radius,
                max: *center + *radius,
            };
            let place = |i: usize| 2.0 * (i as f64 + 0.5) / BALL_VOXELS as f64 - 1.0;
            let values = (0..BALL_VOXELS.pow(3)).map(|i| {
                let (x, y) = (place(i % BALL_VOXELS), place(i / BALL_VOXELS % BALL_VOXELS));
                let z = place(i / BALL_VOXELS / BALL_VOXELS);
                (1.0 - (x * x + y * y + z * z)).max(0.0) as f32
            });
            let file = files.floats(&file, values)?;
            (Some(bounds), Some((file, [BALL_VOXELS; 3], bounds)))
        }
        MediumShape::Grid {
            grid,
            world_from_lattice,
        } => {
            let Some(bounds) = placed_box(grid, world_from_lattice) else {
                return Ok(Err("a grid that is turned".into()));
            };
            let [low, high] = grid.clip;
            let side = (high - low).round().max(DVec3::ONE).as_uvec3();
            let step = (high - low) / side.as_dvec3();
            let (nx, ny) = (side.x as usize, side.y as usize);
            // At the middles of as many cells as there are voxels: those of a dense file, exactly.
            let values = (0..nx * ny * side.z as usize).map(|i| {
                let cell = DVec3::new((i % nx) as f64, (i / nx % ny) as f64, (i / nx / ny) as f64);
                grid.sample(low + (cell + 0.5) * step) as f32
            });
            let file = files.floats(&file, values)?;
            (
                Some(bounds),
                Some((file, [side.z as usize, ny, nx], bounds)),
            )
        }
    };
    let extinction: [f32; 3] = std::array::from_fn(|c| medium.sigma_s[c] + medium.sigma_a[c]);
    let albedo: [f32; 3] = std::array::from_fn(|c| {
        if extinction[c] > 0.0 {
            medium.sigma_s[c] / extinction[c]
        } else {
            0.0
        }
    });
    let shell = bounds.map(|bounds| clear_of_walls(bounds, corners));
    let grid = grid.map(|(file, shape, bounds)| {
        json!({
            "file": file,
            "shape": shape,
            "low": bounds.min.to_array(),
            "high": bounds.max.to_array(),
        })
    });
    let value = json!({
        "sigma_t": extinction,
        "albedo": albedo,
        "phase": phase(&medium.phase),
        "box": shell.map(|b| [b.min.to_array(), b.max.to_array()]),
        "grid": grid,
    });
    Ok(Ok((value, bounds)))
}

/// A phase function as the peer's own description of it.
fn phase(phase: &PhaseFunction) -> Value {
    match *phase {
        PhaseFunction::HenyeyGreenstein { g: 0.0 } => json!({ "type": "isotropic" }),
        PhaseFunction::HenyeyGreenstein { g } => json!({ "type": "hg", "g": g }),
        PhaseFunction::TwoLobes {
            g_forward,
            g_backward,
            forward_share,
        } => json!({
            "type": "blendphase",
            // Of the second.
            "weight": forward_share,
            "phase_0": { "type": "hg", "g": g_backward },
            "phase_1": { "type": "hg", "g": g_forward },
        }),
    }
}

/// Where a grid's clip box lies, unless it is turned or mirrored.
fn placed_box(grid: &SharedGrid, world_from_lattice: &DAffine3) -> Option<Aabb> {
    let m = world_from_lattice.matrix3;
    let scale = DVec3::new(m.x_axis.x, m.y_axis.y, m.z_axis.z);
    let rest = m - DMat3::from_diagonal(scale);
    let turned = (0..3).any(|i| rest.col(i).abs().max_element() > 1e-9 * scale.max_element());
    if turned || scale.cmple(DVec3::ZERO).any() {
        return None;
    }
    let [low, high] = grid.clip;
    Some(Aabb {
        min: world_from_lattice.transform_point3(low),
        max: world_from_lattice.transform_point3(high),
    })
}

/// Moves each face that holds a triangle a little outward.
fn clear_of_walls(bounds: Aabb, corners: &[DVec3]) -> Aabb {
    let size = bounds.max - bounds.min;
    let mut moved = bounds;
    for axis in 0..3 {
        let holds = |face: f64| {
            corners.chunks_exact(3).any(|triangle| {
                let near = |p: &DVec3| (p[axis] - face).abs() < FACE_TOLERANCE * size[axis];
                triangle.iter().all(near)
            })
        };
        if holds(bounds.min[axis]) {
            moved.min[axis] -= FACE_SHIFT * size[axis];
        }
        if holds(bounds.max[axis]) {
            moved.max[axis] += FACE_SHIFT * size[axis];
        }
    }
    moved
}
