//! Boxes in space, how they grow around points, and which maps of space can be inverted.

use glam::{BVec3, DAffine3, DVec3};

/// Axis-aligned box, `min < max` in every component. Unit: m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Aabb {
    /// Lowest corner.
    pub min: DVec3,
    /// Highest corner.
    pub max: DVec3,
}

/// The corners of a box.
pub(crate) fn box_corners(min: DVec3, max: DVec3) -> [DVec3; 8] {
    std::array::from_fn(|corner| {
        let high = BVec3::new(corner & 1 != 0, corner & 2 != 0, corner & 4 != 0);
        DVec3::select(high, max, min)
    })
}

/// A box that grows.
#[derive(Default)]
pub(crate) struct Hull(Option<(DVec3, DVec3)>);

impl Hull {
    pub(crate) fn add(&mut self, point: DVec3) {
        let (min, max) = self.0.unwrap_or((point, point));
        self.0 = Some((min.min(point), max.max(point)));
    }

    /// Adds a box in another space.
    pub(crate) fn add_placed(&mut self, bounds: &Aabb, map: &DAffine3) {
        for corner in box_corners(bounds.min, bounds.max) {
            self.add(map.transform_point3(corner));
        }
    }

    /// The box as it is, flat ones flat.
    pub(crate) fn bounds(self) -> Option<Aabb> {
        self.0.map(|(min, max)| Aabb { min, max })
    }

    /// The box, thickened where it is flat so that `min < max` holds.
    pub(crate) fn padded(self) -> Option<Aabb> {
        let (mut min, mut max) = self.0?;
        let least = 1e-3 + 1e-6 * (max - min).max_element();
        for axis in 0..3 {
            if max[axis] - min[axis] < least {
                min[axis] -= 0.5 * least;
                max[axis] += 0.5 * least;
            }
        }
        Some(Aabb { min, max })
    }
}

/// Whether a map is finite and its determinant is not lost in rounding.
pub(crate) fn is_invertible(map: &DAffine3) -> bool {
    let linear = &map.matrix3;
    let longest = [linear.x_axis, linear.y_axis, linear.z_axis]
        .map(DVec3::length)
        .into_iter()
        .fold(0.0, f64::max);
    let determinant = linear.determinant();
    map.is_finite() && determinant.is_finite() && determinant.abs() > 1e-12 * longest.powi(3)
}
