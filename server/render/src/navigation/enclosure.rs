//! Whether surfaces surround a camera: in a room or a street one looks around, from outside one orbits.
//!
//! Rays go out level and a little upward, so that a ground plane surrounds nobody. The camera is enclosed
//! where surfaces stand in most directions of the compass; in a third of them is enough for a camera inside
//! the box around everything (at the end of a street), or under a roof and over a floor (a pavilion); less on
//! the doorstep of a room that is around what the camera looks at (a stage).

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
/// The same in front of the open side of a room, where the room is around what one looks at.
const AROUND_DOORSTEP: f64 = 0.22;
/// Surfaces farther than so many diagonals of the scene enclose nothing.
const REACH: f64 = 4.0;

/// Whether surfaces surround a camera, or what it looks at from the doorstep.
pub(super) fn encloses(solids: &Solids, camera: &Camera) -> bool {
    let axes = upright(camera);
    let eye = camera.position;
    let share = surrounded(solids, eye, axes);
    let inside = || contains(&solids.bounds, eye) || is_indoors(solids, eye, axes);
    let looks_in = || surrounded(solids, focus(solids, camera), axes) >= AROUND;
    share >= AROUND
        || (share >= AROUND_INSIDE && inside())
        || (share >= AROUND_DOORSTEP && looks_in())
}

/// Share of the compass in which surfaces stand around a place.
fn surrounded(solids: &Solids, place: DVec3, (up, level): (DVec3, DVec3)) -> f64 {
    let side = up.cross(level);
    let is_closed = |sector: usize| {
        let turn = sector as f64 / SECTORS as f64 * std::f64::consts::TAU;
        let ahead = level * turn.cos() + side * turn.sin();
        ELEVATIONS.iter().any(|degrees| {
            let slope = degrees.to_radians();
            meets_a_wall(solids, place, ahead * slope.cos() + up * slope.sin())
        })
    };
    let closed = (0..SECTORS).filter(|sector| is_closed(*sector)).count();
    closed as f64 / SECTORS as f64
}

/// Whether a place is under a roof and over a floor.
fn is_indoors(solids: &Solids, place: DVec3, (up, level): (DVec3, DVec3)) -> bool {
    let side = up.cross(level);
    let tilts = [DVec3::ZERO, level, -level, side, -side].map(|tilt| 0.35 * tilt);
    let is_covered = |way: DVec3| {
        let rays = tilts.iter().map(|tilt| (way + *tilt).normalize_or(way));
        rays.filter(|ray| meets_a_wall(solids, place, *ray)).count() >= 4
    };
    is_covered(up) && is_covered(-up)
}

/// What a camera looks at: its target, or a place just before a surface that hides it.
fn focus(solids: &Solids, camera: &Camera) -> DVec3 {
    let view = camera.target - camera.position;
    let reach = view.length();
    let direction = view / reach;
    match solids.closest(camera.position, direction, reach) {
        Some(hit) => {
            let before = (f64::from(hit.distance) - solids.margin()).max(0.0);
            camera.position + direction * before
        }
        None => camera.target,
    }
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
