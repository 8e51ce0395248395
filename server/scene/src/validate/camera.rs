//! Rules of the camera.

use glam::DVec3;

use super::rules;
use crate::description::CameraDescription;
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
    }
    Ok(())
}

fn field_of_view(path: &JsonPath, degrees: f64) -> Result<(), SceneError> {
    rules::range(&path.field("vertical_fov_degrees"), degrees, 0.1, 170.0)
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
