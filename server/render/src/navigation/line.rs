//! Rays in the world.

use glam::DVec3;
use tyndall_scene::Camera;

use crate::gpu_scene::pixel_ray;

/// Picture height that places are counted in; only the ratio of the sides matters. Unit: pixel.
const ROWS: f64 = 4096.0;

/// A ray in the world.
#[derive(Debug, Clone, Copy)]
pub(super) struct Line {
    /// Unit: m.
    pub(super) origin: DVec3,
    /// Unit length.
    pub(super) direction: DVec3,
}

impl Line {
    pub(super) fn at(&self, distance: f64) -> DVec3 {
        self.origin + self.direction * distance
    }

    /// Through a place of the picture: shares of width and height from the left upper corner.
    pub(super) fn through(camera: &Camera, aspect: f64, place: [f64; 2]) -> Self {
        let columns = (ROWS * aspect).clamp(1.0, ROWS * ROWS).round();
        let pixel = [place[0] * columns, place[1] * ROWS];
        Self {
            origin: camera.position,
            direction: pixel_ray(camera, (columns as u32, ROWS as u32), pixel),
        }
    }
}
