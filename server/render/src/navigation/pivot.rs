//! What an orbit of the scene's own camera turns about.

use glam::DVec3;
use tyndall_scene::Scene;

use super::line::Line;
use super::media;
use super::solids::{Solids, contains, middle};

/// The camera's target where that is a thing, or lies between things and is not hidden; otherwise what
/// stands in the middle of the picture; otherwise the point of the view closest to the scene's middle.
pub(super) fn pivot(solids: &Solids, scene: &Scene) -> DVec3 {
    let camera = &scene.camera;
    let view = camera.target - camera.position;
    let reach = view.length();
    let line = Line {
        origin: camera.position,
        direction: view / reach,
    };
    let far = 8.0 * solids.extent() + reach;
    let hit = solids.closest(line.origin, line.direction, far);
    let distance = hit.map_or(f64::INFINITY, |hit| f64::from(hit.distance));
    let in_front = reach <= distance;
    let inside = hit.is_some_and(|hit| contains(&solids.thing_of(hit.triangle), camera.target));
    if (in_front && contains(&solids.bounds, camera.target)) || inside {
        return camera.target;
    }
    if let Some(distance) = media::in_front(scene, &line, hit.map(|_| distance), far) {
        return line.at(distance);
    }
    if hit.is_some_and(|hit| !solids.is_backdrop(hit.triangle)) {
        return line.at(distance);
    }
    let abreast = (middle(&solids.bounds) - line.origin).dot(line.direction);
    if abreast > 0.0 {
        line.at(abreast.min(distance))
    } else {
        camera.target
    }
}
