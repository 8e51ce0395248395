//! Where media are along a ray, and how dense.

use glam::DVec3;
use tyndall_scene::{Aabb, Medium, MediumShape, Scene};

use super::line::Line;

/// Places at which the density is looked at along a ray.
const PLACES: usize = 96;

/// The box of a medium; `None` for one that fills space. Unit: m.
pub(super) fn bounds(shape: &MediumShape) -> Option<Aabb> {
    match shape {
        MediumShape::Homogeneous { bounds } | MediumShape::HeightFog { bounds, .. } => *bounds,
        MediumShape::Sphere { center, radius } => Some(Aabb {
            min: *center - *radius,
            max: *center + *radius,
        }),
        MediumShape::Grid {
            grid,
            world_from_lattice,
        } => {
            let [low, high] = grid.clip;
            let corner = |index: usize| {
                let pick = |axis: usize| if index >> axis & 1 == 1 { high } else { low }[axis];
                world_from_lattice.transform_point3(DVec3::new(pick(0), pick(1), pick(2)))
            };
            let corners: [DVec3; 8] = std::array::from_fn(corner);
            let first = corners[0];
            Some(corners.iter().fold(
                Aabb {
                    min: first,
                    max: first,
                },
                |around, corner| Aabb {
                    min: around.min.min(*corner),
                    max: around.max.max(*corner),
                },
            ))
        }
    }
}

/// The part of a line inside a box, within `limit`. Unit: m.
pub(super) fn stretch(line: &Line, bounds: &Aabb, limit: f64) -> Option<[f64; 2]> {
    let (mut near, mut far) = (0.0_f64, limit);
    for axis in 0..3 {
        let (origin, slope) = (line.origin[axis], line.direction[axis]);
        let (low, high) = (bounds.min[axis], bounds.max[axis]);
        if slope.abs() < 1e-12 {
            if origin < low || origin > high {
                return None;
            }
            continue;
        }
        let (a, b) = ((low - origin) / slope, (high - origin) / slope);
        near = near.max(a.min(b));
        far = far.min(a.max(b));
    }
    (near < far).then_some([near, far])
}

/// What media hide along a line.
#[derive(Debug, Clone, Copy)]
struct Hiding {
    /// Where half of it is hidden: the middle of thin smoke, just below the skin of a dense cloud. Unit: m.
    middle: f64,
    /// Share of what lies behind that is hidden. Range: 0 to 1.
    share: f64,
}

/// What the bounded media of a line hide within `limit`: smoke and clouds, and boxes of fog if `with_fog`.
/// Unit: m.
fn hiding(scene: &Scene, line: &Line, limit: f64, with_fog: bool) -> Option<Hiding> {
    let bounded = scene.media.iter().filter_map(|medium| {
        let is_fog = !matches!(
            medium.shape,
            MediumShape::Sphere { .. } | MediumShape::Grid { .. }
        );
        if is_fog && !with_fog {
            return None;
        }
        let [near, far] = stretch(line, &bounds(&medium.shape)?, limit)?;
        Some((medium, near, far))
    });
    let bounded: Vec<(&Medium, f64, f64)> = bounded.collect();
    let near = bounded.iter().map(|(_, near, _)| *near).reduce(f64::min)?;
    let far = bounded.iter().map(|(_, _, far)| *far).reduce(f64::max)?;
    let step = (far - near) / PLACES as f64;
    let place = |index: usize| near + step * (index as f64 + 0.5);
    let mut depth = 0.0;
    let depths: Vec<f64> = (0..PLACES)
        .map(|index| {
            let at = place(index);
            let inside = bounded
                .iter()
                .filter(|(_, near, far)| (*near..*far).contains(&at));
            let point = line.at(at);
            depth += step
                * inside
                    .map(|(medium, ..)| extinction(medium, point))
                    .sum::<f64>();
            depth
        })
        .collect();
    // 1 − e^(−τ), accurate for thin media.
    let hidden = |depth: f64| -(-depth).exp_m1();
    let share = hidden(depth);
    if share <= 0.0 {
        return None;
    }
    let index = depths
        .iter()
        .position(|depth| hidden(*depth) >= 0.5 * share)?;
    Some(Hiding {
        middle: place(index),
        share,
    })
}

/// The middle of the medium that one sees along a line rather than the surface behind it: smoke that hides
/// half of the surface, or without a surface whatever is there. Unit: m.
pub(super) fn in_front(
    scene: &Scene,
    line: &Line,
    surface: Option<f64>,
    limit: f64,
) -> Option<f64> {
    let hiding = hiding(scene, line, surface.unwrap_or(limit), surface.is_none())?;
    let seen = surface.is_none() || hiding.share > 0.5;
    seen.then_some(hiding.middle)
}

/// Extinction of the densest channel. Unit: m⁻¹.
fn extinction(medium: &Medium, point: DVec3) -> f64 {
    let channels = medium.sigma_s.iter().zip(&medium.sigma_a);
    let sigma_t = channels.map(|(s, a)| s + a).fold(0.0, f32::max);
    f64::from(sigma_t) * density(&medium.shape, point)
}

/// Relative density inside a medium's box.
fn density(shape: &MediumShape, point: DVec3) -> f64 {
    match shape {
        MediumShape::Homogeneous { .. } => 1.0,
        MediumShape::HeightFog {
            up,
            falloff,
            origin,
            ..
        } => {
            let height = (point - *origin).dot(up.as_dvec3());
            (-f64::from(*falloff) * height).min(60.0).exp()
        }
        MediumShape::Sphere { center, radius } => {
            (1.0 - point.distance_squared(*center) / (radius * radius)).max(0.0)
        }
        MediumShape::Grid {
            grid,
            world_from_lattice,
        } => grid.sample(world_from_lattice.inverse().transform_point3(point)),
    }
}
