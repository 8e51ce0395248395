//! Boxes that grow around points.

use glam::{BVec3, DAffine3, DVec3};

use crate::geometry::{Instance, Surfaces};
use crate::scene::Aabb;

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

    /// Adds the box of an instance's mesh.
    pub(crate) fn add_mesh(&mut self, surfaces: &Surfaces, instance: &Instance) {
        if let Some(bounds) = &surfaces.mesh_bounds()[instance.mesh] {
            self.add_placed(bounds, &instance.world_from_object);
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
