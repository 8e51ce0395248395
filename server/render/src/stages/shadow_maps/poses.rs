//! Where depth maps look from: one pose for a spot, six for a point, one for a directional light.

use glam::{DVec3, DVec4};
use tyndall_scene::{Aabb, Light};

use crate::gpu_scene::columns;

/// Where a depth map looks from, in the world. Equal poses give equal maps.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Pose {
    position: DVec3,
    right: DVec3,
    up: DVec3,
    forward: DVec3,
    pub lens: Lens,
}

/// What part of the world it sees.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Lens {
    /// Half the field of view's tangent; nearest depth.
    Perspective { tan: f64, near: f64 },
    /// Half extents along right, up and forward.
    Orthographic { half: DVec3 },
}

impl Pose {
    /// Whether a box may reach into the frustum: false only if all of it lies outside one of the
    /// planes, by more than the device rounds.
    pub fn sees(&self, bounds: &Aabb) -> bool {
        let corners = corners(*bounds).map(|corner| {
            let d = corner - self.position;
            DVec3::new(d.dot(self.right), d.dot(self.up), d.dot(self.forward))
        });
        let slack = |c: &DVec3| 1e-5 * c.abs().max_element();
        let reaches =
            |inside: &dyn Fn(&DVec3) -> f64| corners.iter().any(|c| inside(c) >= -slack(c));
        let (x, y, z) = match self.lens {
            Lens::Perspective { tan, near } => {
                return reaches(&|c| c.z - near)
                    && reaches(&|c| tan * c.z - c.x)
                    && reaches(&|c| tan * c.z + c.x)
                    && reaches(&|c| tan * c.z - c.y)
                    && reaches(&|c| tan * c.z + c.y);
            }
            Lens::Orthographic { half } => (half.x, half.y, half.z),
        };
        reaches(&|c| x - c.x)
            && reaches(&|c| x + c.x)
            && reaches(&|c| y - c.y)
            && reaches(&|c| y + c.y)
            && reaches(&|c| z - c.z)
            && reaches(&|c| z + c.z)
    }
}

/// The poses of a light's maps; `casters` is around everything that may cast a shadow.
pub(super) fn poses_of(light: &Light, casters: Aabb, resolution: u32) -> Vec<Pose> {
    // Half a texel of border on either side, for the filter's footprint.
    let border = 1.0 + 2.0 / f64::from(resolution);
    match light {
        Light::Point(light) => {
            let faces = [
                DVec3::X,
                DVec3::NEG_X,
                DVec3::Y,
                DVec3::NEG_Y,
                DVec3::Z,
                DVec3::NEG_Z,
            ];
            let lens = Lens::Perspective {
                tan: border,
                near: nearest(light.radius),
            };
            faces
                .map(|forward| pose(light.position, forward, lens))
                .to_vec()
        }
        Light::Spot(light) => {
            let lens = Lens::Perspective {
                // Beyond 85° a perspective map degenerates; such spots are lit to the map's edge.
                tan: f64::from(light.outer_angle).min(85_f64.to_radians()).tan() * border,
                near: nearest(light.radius),
            };
            vec![pose(light.position, light.direction.as_dvec3(), lens)]
        }
        Light::Directional(light) => {
            let placeholder = Lens::Orthographic { half: DVec3::ONE };
            let mut fitted = pose(DVec3::ZERO, light.direction.as_dvec3(), placeholder);
            let (mut low, mut high) = (DVec3::MAX, DVec3::MIN);
            for corner in corners(casters) {
                let p = DVec3::new(
                    corner.dot(fitted.right),
                    corner.dot(fitted.up),
                    corner.dot(fitted.forward),
                );
                low = low.min(p);
                high = high.max(p);
            }
            let middle = 0.5 * (low + high);
            fitted.position =
                fitted.right * middle.x + fitted.up * middle.y + fitted.forward * middle.z;
            let half = (0.5 * (high - low)).max(DVec3::splat(1e-6));
            fitted.lens = Lens::Orthographic {
                half: DVec3::new(half.x * border, half.y * border, half.z * 1.01),
            };
            vec![fitted]
        }
    }
}

/// Casters nearer than this to a light are inside its source.
fn nearest(radius: f32) -> f64 {
    f64::from(radius).clamp(1e-3, 0.05)
}

fn pose(position: DVec3, forward: DVec3, lens: Lens) -> Pose {
    let helper = if forward.y.abs() < 0.9 {
        DVec3::Y
    } else {
        DVec3::X
    };
    let right = forward.cross(helper).normalize_or(DVec3::X);
    Pose {
        position,
        right,
        up: right.cross(forward),
        forward,
        lens,
    }
}

fn corners(bounds: Aabb) -> [DVec3; 8] {
    std::array::from_fn(|i| {
        DVec3::new(
            if i & 1 == 0 {
                bounds.min.x
            } else {
                bounds.max.x
            },
            if i & 2 == 0 {
                bounds.min.y
            } else {
                bounds.max.y
            },
            if i & 4 == 0 {
                bounds.min.z
            } else {
                bounds.max.z
            },
        )
    })
}

/// Clip transform of camera-relative points, composed in f64.
pub(super) fn clip_from_relative(pose: &Pose, origin: DVec3) -> [[f32; 4]; 4] {
    let offset = origin - pose.position;
    let axis = |direction: DVec3, scale: f64, shift: f64| {
        let d = direction * scale;
        DVec4::new(d.x, d.y, d.z, d.dot(offset) + shift)
    };
    let rows = match pose.lens {
        Lens::Perspective { tan, near } => [
            axis(pose.right, 1.0 / tan, 0.0),
            axis(pose.up, 1.0 / tan, 0.0),
            DVec4::new(0.0, 0.0, 0.0, near),
            axis(pose.forward, 1.0, 0.0),
        ],
        Lens::Orthographic { half } => [
            axis(pose.right, 1.0 / half.x, 0.0),
            axis(pose.up, 1.0 / half.y, 0.0),
            axis(pose.forward, -0.5 / half.z, 0.5),
            DVec4::W,
        ],
    };
    columns(rows)
}
