//! What lies under a place of the picture: a surface, or the middle of a medium.

use glam::DVec3;
use obvhs::ray::Ray;
use tyndall_scene::{Geometry, Scene, SharedGeometry};

use super::line::Line;
use super::media;
use super::solids::Solids;
use crate::gpu_scene::world_triangles;

/// Beyond this nothing is picked. Unit: m.
const FARTHEST: f64 = 1e7;

/// What lies under a place of the picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Picked {
    /// A surface.
    Surface {
        /// Unit: m.
        point: DVec3,
        /// Unit normal, toward the eye.
        normal: DVec3,
    },
    /// The middle of smoke, a cloud or bounded fog.
    Medium {
        /// Unit: m.
        point: DVec3,
    },
}

/// What the scene's camera sees at a place of a picture with this ratio of width to height.
pub(super) fn pick(solids: &Solids, scene: &Scene, aspect: f64, place: [f64; 2]) -> Option<Picked> {
    let line = Line::through(&scene.camera, aspect, place);
    let still = solids.closest(line.origin, line.direction, FARTHEST);
    let still = still.map(|hit| {
        let normal = solids.normal_against(hit.triangle, line.direction);
        (f64::from(hit.distance), normal)
    });
    let moving = closest_moving(&scene.geometry, &line);
    let nearest = [still, moving]
        .into_iter()
        .flatten()
        .min_by(|a, b| a.0.total_cmp(&b.0));
    let surface = nearest.map(|(distance, _)| distance);
    if let Some(distance) = media::in_front(scene, &line, surface, FARTHEST) {
        return Some(Picked::Medium {
            point: line.at(distance),
        });
    }
    nearest.map(|(distance, normal)| Picked::Surface {
        point: line.at(distance),
        normal,
    })
}

/// Distance and normal of the nearest triangle that keyframes move, one by one: few scenes move much.
fn closest_moving(geometry: &SharedGeometry, line: &Line) -> Option<(f64, DVec3)> {
    let tracks = geometry.tracks.iter();
    let instances: Vec<_> = tracks
        .flat_map(|track| &track.instances)
        .map(|(index, _)| geometry.instances[*index])
        .collect();
    if instances.is_empty() {
        return None;
    }
    let moving = Geometry {
        surfaces: geometry.surfaces.clone(),
        instances,
        tracks: std::sync::Arc::default(),
    };
    let ray = Ray::new(
        glam::Vec3A::ZERO,
        line.direction.as_vec3a(),
        0.0,
        FARTHEST as f32,
    );
    world_triangles(&moving, line.origin)
        .iter()
        .map(|triangle| (triangle.intersect(&ray), triangle))
        .filter(|(distance, _)| *distance < FARTHEST as f32)
        .min_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(distance, triangle)| {
            let normal = triangle.compute_normal().normalize_or(glam::Vec3A::Y);
            let normal = normal.as_dvec3();
            let faces_away = normal.dot(line.direction) > 0.0;
            (
                f64::from(distance),
                if faces_away { -normal } else { normal },
            )
        })
}
