//! Keyframes of camera and lights, from the description to tracks.

use glam::DVec3;

use crate::description::values::unit;
use crate::description::{CameraDescription, LightDescription, SceneDescription};
use crate::error::SceneError;
use crate::scene::{Animation, CameraKey, Direction, LightTrack, SpotKey, Track};

/// How camera and lights of a validated description move, and its period; `None` without either.
pub(crate) fn animation(description: &SceneDescription) -> Result<Option<Animation>, SceneError> {
    let animation = Animation {
        camera: camera(&description.camera)?,
        lights: lights(&description.lights)?,
        period: description
            .animation
            .as_ref()
            .and_then(|animation| animation.period_seconds),
    };
    Ok((animation != Animation::default()).then_some(animation))
}

fn camera(camera: &CameraDescription) -> Result<Option<Track<CameraKey>>, SceneError> {
    if camera.keyframes.is_empty() {
        return Ok(None);
    }
    let keys = camera.keyframes.iter().map(|key| {
        let degrees = key.vertical_fov_degrees;
        let state = CameraKey {
            position: DVec3::from_array(key.position),
            target: DVec3::from_array(key.target),
            vertical_fov: degrees.unwrap_or(camera.vertical_fov_degrees).to_radians(),
        };
        (key.time_seconds, state)
    });
    Track::new("camera.keyframes", keys).map(Some)
}

/// Tracks by index into the scene's lights, which hold no environment.
fn lights(lights: &[LightDescription]) -> Result<Vec<(usize, LightTrack)>, SceneError> {
    let mut tracks = Vec::new();
    let mut index = 0;
    for (i, light) in lights.iter().enumerate() {
        let path = format!("lights[{i}].keyframes");
        let track = match light {
            LightDescription::Point(light) if !light.keyframes.is_empty() => {
                let keys = light.keyframes.iter();
                let keys = keys.map(|key| (key.time_seconds, DVec3::from_array(key.position)));
                Some(LightTrack::Point(Track::new(&path, keys)?))
            }
            LightDescription::Spot(light) if !light.keyframes.is_empty() => {
                let keys = light.keyframes.iter().map(|key| {
                    let state = SpotKey {
                        position: DVec3::from_array(key.position),
                        direction: Direction(unit(key.direction)),
                    };
                    (key.time_seconds, state)
                });
                Some(LightTrack::Spot(Track::new(&path, keys)?))
            }
            LightDescription::Directional(light) if !light.keyframes.is_empty() => {
                let keys = light.keyframes.iter();
                let keys = keys.map(|key| (key.time_seconds, Direction(unit(key.direction))));
                Some(LightTrack::Directional(Track::new(&path, keys)?))
            }
            LightDescription::Environment(_) => continue,
            _ => None,
        };
        tracks.extend(track.map(|track| (index, track)));
        index += 1;
    }
    Ok(tracks)
}
