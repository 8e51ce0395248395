//! Entries of `geometry` with keyframes: how their instances move.

use std::ops::Range;

use glam::{DAffine3, DVec3};

use super::transform::placement;
use crate::description::geometry::TransformKeyframe;
use crate::error::SceneError;
use crate::scene::{Aabb, Hull, Instance, Placement, PlacementTrack, Surfaces, Track, box_corners};

/// Least volume of a placed unit cube relative to that of its longest side; twice the root of 27
/// above what `is_invertible` asks for, since two maps follow one another.
const FLATTEST: f64 = 1e-11;

/// An entry that moves and the instances it was imported as.
pub(super) struct Moving {
    path: String,
    placement: Track<Placement>,
    instances: Range<usize>,
}

impl Moving {
    /// `None` for an entry that left no instance.
    pub(super) fn new(
        entry_path: &str,
        keyframes: &[TransformKeyframe],
        instances: Range<usize>,
    ) -> Result<Option<Self>, SceneError> {
        if instances.is_empty() {
            return Ok(None);
        }
        let path = format!("{entry_path}.keyframes");
        let keys = keyframes.iter();
        let keys = keys.map(|key| (key.time_seconds, placement(&key.transform)));
        Ok(Some(Self {
            placement: Track::new(&path, keys)?,
            path,
            instances,
        }))
    }

    /// The track of the entry, whose instances stand as at time 0.
    pub(super) fn track(
        self,
        surfaces: &Surfaces,
        instances: &[Instance],
    ) -> Result<PlacementTrack, SceneError> {
        let initial = self.placement.at(0.0).affine();
        let entry_from_world = initial.inverse();
        let mut hull = Hull::default();
        let mut flattest: f64 = 1.0;
        let mut placed = Vec::with_capacity(self.instances.len());
        for index in self.instances {
            let instance = &instances[index];
            // Exact where there is nothing but the entry's own placement.
            let entry_from_object = if instance.world_from_object == initial {
                DAffine3::IDENTITY
            } else {
                entry_from_world * instance.world_from_object
            };
            flattest = flattest.min(flatness(&entry_from_object));
            if let Some(bounds) = &surfaces.mesh_bounds()[instance.mesh] {
                hull.add_placed(bounds, &entry_from_object);
            }
            placed.push((index, entry_from_object));
        }
        for (i, key) in self.placement.keys().iter().enumerate() {
            // Between two keys the relative volume is not below the lesser one of theirs.
            let flat = flatness(&key.affine()) * flattest;
            if !(flat.is_finite() && flat > FLATTEST) {
                return Err(SceneError::invalid(
                    format!("{}[{i}].transform.scale", self.path),
                    "a scale that flattens what it places",
                    "factors closer to one another",
                ));
            }
        }
        let swept = hull.bounds().and_then(|b| swept(&b, &self.placement));
        Ok(PlacementTrack {
            placement: self.placement,
            instances: placed,
            swept,
        })
    }
}

/// Volume of a placed unit cube relative to that of its longest side.
fn flatness(map: &DAffine3) -> f64 {
    let linear = &map.matrix3;
    let sides = [linear.x_axis, linear.y_axis, linear.z_axis].map(DVec3::length);
    linear.determinant().abs() / sides.into_iter().fold(0.0, f64::max).powi(3)
}

/// Box around `bounds` at all times. Exact where nothing turns; else the box around the balls that
/// the turning corners can't leave.
fn swept(bounds: &Aabb, track: &Track<Placement>) -> Option<Aabb> {
    let corners = box_corners(bounds.min, bounds.max);
    let first = track.keys().first()?;
    let turns = track
        .keys()
        .iter()
        .any(|key| key.rotation != first.rotation);
    let mut hull = Hull::default();
    if turns {
        // Distances from the entry's origin are convex in the scale, so the keys have the largest.
        let reach = |key: &Placement| corners.map(|c| (key.scale * c).length());
        let radius = track.keys().iter().flat_map(reach).fold(0.0, f64::max);
        for key in track.keys() {
            hull.add(key.translation - radius);
            hull.add(key.translation + radius);
        }
    } else {
        for key in track.keys() {
            hull.add_placed(bounds, &key.affine());
        }
    }
    hull.bounds()
}
