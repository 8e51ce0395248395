//! Whether surfaces surround a camera: in a room or a street one looks around, from outside one orbits.
//!
//! Rays go out level and a little upward, so that a ground plane surrounds nobody. The camera is enclosed
//! where surfaces stand in most directions of the compass; in a third of them is enough for a camera inside
//! the box around everything (at the end of a street), or under a roof and over a floor (a pavilion).

use glam::DVec3;
use tyndall_scene::Camera;

use super::solids::{Solids, contains};

/// Directions of the compass that are looked into.
const SECTORS: usize = 24;
/// Upward slopes of the rays of a sector. Unit: degree.
const ELEVATIONS: [f64; 3] = [2.0, 10.0, 25.0];
/// Share of the compass with surfaces around a camera that is enclosed; a thing in front covers a half
/// at most.
const AROUND: f64 = 0.6;
/// The same inside the box around everything, or under a roof and over a floor.
const AROUND_INSIDE: f64 = 0.33;
/// Surfaces farther than so many diagonals of the scene enclose nothing.
const REACH: f64 = 4.0;

/// Whether surfaces surround a camera.
pub(super) fn encloses(solids: &Solids, camera: &Camera) -> bool {
    let eye = camera.position;
    let (up, level) = upright(camera);
    let side = up.cross(level);
    let hit = |direction: DVec3| meets_a_wall(solids, eye, direction);
    let is_closed = |sector: usize| {
        let turn = sector as f64 / SECTORS as f64 * std::f64::consts::TAU;
        let ahead = level * turn.cos() + side * turn.sin();
        ELEVATIONS.iter().any(|degrees| {
            let slope = degrees.to_radians();
            hit(ahead * slope.cos() + up * slope.sin())
        })
    };
    let closed = (0..SECTORS).filter(|sector| is_closed(*sector)).count();
    let share = closed as f64 / SECTORS as f64;
    let tilts = [DVec3::ZERO, level, -level, side, -side].map(|tilt| 0.35 * tilt);
    let covered = |way: DVec3| {
        tilts
            .iter()
            .filter(|tilt| hit((way + **tilt).normalize_or(way)))
            .count()
    };
    let indoors = covered(up) >= 4 && covered(-up) >= 4;
    let inside = indoors || contains(&solids.bounds, eye);
    share >= AROUND || (inside && share >= AROUND_INSIDE)
}

fn meets_a_wall(solids: &Solids, eye: DVec3, direction: DVec3) -> bool {
    let hit = solids.closest(eye, direction, REACH * solids.extent());
    hit.is_some_and(|hit| !solids.is_backdrop(hit.triangle))
}

/// Up, and the level direction closest to the view.
pub(super) fn upright(camera: &Camera) -> (DVec3, DVec3) {
    let up = camera.up.as_dvec3().normalize_or(DVec3::Y);
    let view = camera.target - camera.position;
    let level = (view - up * view.dot(up)).normalize_or(up.any_orthonormal_vector());
    (up, level)
}
