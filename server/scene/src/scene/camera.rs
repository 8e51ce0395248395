//! The eye.

use glam::{DVec3, Vec3};

/// Perspective pinhole camera.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Camera {
    /// Unit: m.
    pub position: DVec3,
    /// The point looked at; differs from `position`. Unit: m.
    pub target: DVec3,
    /// Not parallel to the view direction; need not be unit.
    pub up: Vec3,
    /// Full vertical field of view. Unit: radian. Range: (0, π).
    pub vertical_fov: f32,
    /// Exposure value: displayed = curve(radiance · 2^`exposure_ev`). Range: [−24, 24].
    pub exposure_ev: f32,
}
