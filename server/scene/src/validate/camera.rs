//! Rules of the camera.

use glam::DVec3;

use super::rules;
use crate::description::{CameraDescription, CameraKeyframe};
use crate::error::SceneError;
use crate::json_path::JsonPath;

/// Largest magnitude of the exposure. Unit: EV.
const EXPOSURE: f64 = 24.0;
/// Smallest sine between `up` and the view direction.
const LEAST_SINE: f64 = 1e-4;

pub(super) fn check(camera: &CameraDescription, path: &JsonPath) -> Result<(), SceneError> {
    let pose = Pose {
        position: camera.position,
        target: camera.target,
        up: camera.up,
    };
    rules::direction(&path.field("up"), &camera.up)?;
    pose.check(path)?;
    field_of_view(path, camera.vertical_fov_degrees)?;
    rules::range(
        &path.field("exposure_ev"),
        camera.exposure_ev,
        -EXPOSURE,
        EXPOSURE,
    )?;

    let path = path.field("keyframes");
    rules::times(&path, camera.keyframes.iter().map(|key| key.time_seconds))?;
    for (i, keyframe) in camera.keyframes.iter().enumerate() {
        let path = path.index(i);
        let pose = Pose {
            position: keyframe.position,
            target: keyframe.target,
            up: camera.up,
        };
        pose.check(&path)?;
        if let Some(degrees) = keyframe.vertical_fov_degrees {
            field_of_view(&path, degrees)?;
        }
        if let Some(before) = i.checked_sub(1).map(|i| &camera.keyframes[i]) {
            let view = |key: &CameraKeyframe| {
                DVec3::from_array(key.target) - DVec3::from_array(key.position)
            };
            let up = DVec3::from_array(camera.up);
            if least_sine(view(before), view(keyframe), up) < LEAST_SINE {
                return Err(SceneError::invalid(
                    path,
                    "a view direction that passes along up on the way from the keyframe before",
                    "keyframes between which the camera never looks along up or at itself",
                ));
            }
        }
    }
    Ok(())
}

fn field_of_view(path: &JsonPath, degrees: f64) -> Result<(), SceneError> {
    rules::range(&path.field("vertical_fov_degrees"), degrees, 0.1, 170.0)
}

/// Least sine between `up` and the view direction on the straight way from `a` to `b`; 0 if that
/// passes through the eye.
fn least_sine(a: DVec3, b: DVec3, up: DVec3) -> f64 {
    let way = b - a;
    let (c, slope) = (a.cross(up), way.cross(up));
    // sin² = (x0 + x1 t + x2 t²) / (y0 + y1 t + y2 t²) / |up|², extreme where its slope vanishes.
    let (x0, x1, x2) = (c.dot(c), 2.0 * c.dot(slope), slope.dot(slope));
    let (y0, y1, y2) = (a.dot(a), 2.0 * a.dot(way), way.dot(way));
    let (q0, q1, q2) = (
        x1 * y0 - x0 * y1,
        2.0 * (x2 * y0 - x0 * y2),
        x2 * y1 - x1 * y2,
    );
    let root = (q1 * q1 - 4.0 * q0 * q2).max(0.0).sqrt();
    let nearest = -y1 / (2.0 * y2);
    let candidates = [
        0.0,
        1.0,
        (-q1 + root) / (2.0 * q2),
        (-q1 - root) / (2.0 * q2),
        -q0 / q1,
        nearest,
    ];
    let sine = |t: f64| {
        let view = a + way * t;
        if view.length() < rules::SHORTEST {
            return 0.0;
        }
        view.cross(up).length() / (view.length() * up.length())
    };
    let inside = candidates.into_iter().filter(|t| (0.0..=1.0).contains(t));
    inside.map(sine).fold(1.0, f64::min)
}

/// Where the camera is, where it looks, what is up.
struct Pose {
    position: [f64; 3],
    target: [f64; 3],
    up: [f64; 3],
}

impl Pose {
    /// The view direction exists and is not parallel to `up`.
    fn check(&self, path: &JsonPath) -> Result<(), SceneError> {
        rules::position(&path.field("position"), &self.position)?;
        rules::position(&path.field("target"), &self.target)?;
        let view = DVec3::from_array(self.target) - DVec3::from_array(self.position);
        if view.length() < rules::SHORTEST {
            return Err(SceneError::invalid(
                path.field("target"),
                rules::list(&self.target),
                format!(
                    "a point at least {} m from position, {}",
                    rules::shown(rules::SHORTEST),
                    rules::list(&self.position)
                ),
            ));
        }
        let up = DVec3::from_array(self.up);
        let sine = view.cross(up).length() / (view.length() * up.length());
        if sine < LEAST_SINE {
            return Err(SceneError::invalid(
                path.field("up"),
                format!("{}, parallel to the view direction", rules::list(&self.up)),
                "a vector that is not parallel to target − position",
            ));
        }
        Ok(())
    }
}
