//! How camera and lights move.

use glam::DVec3;

use super::lights::Light;
use super::tracks::{CameraKey, Direction, SpotKey, Track};

/// How a light moves.
#[derive(Debug, Clone, PartialEq)]
pub enum LightTrack {
    /// A point light's position. Unit: m.
    Point(Track<DVec3>),
    /// A spot light's pose.
    Spot(Track<SpotKey>),
    /// A directional light's direction.
    Directional(Track<Direction>),
}

impl LightTrack {
    /// The time of its last key. Unit: s.
    pub(super) fn end(&self) -> f64 {
        match self {
            Self::Point(track) => track.end(),
            Self::Spot(track) => track.end(),
            Self::Directional(track) => track.end(),
        }
    }

    /// Puts a light of the track's kind where it is at a time.
    pub(super) fn place(&self, light: &mut Light, seconds: f64) {
        match (self, light) {
            (Self::Point(track), Light::Point(light)) => light.position = track.at(seconds),
            (Self::Spot(track), Light::Spot(light)) => {
                let key = track.at(seconds);
                light.position = key.position;
                light.direction = key.direction.0.as_vec3();
            }
            (Self::Directional(track), Light::Directional(light)) => {
                light.direction = track.at(seconds).0.as_vec3();
            }
            _ => {}
        }
    }
}

/// How camera and lights move, and when everything starts over.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Animation {
    /// The camera's track.
    pub camera: Option<Track<CameraKey>>,
    /// Index into `Scene::lights`, and that light's track.
    pub lights: Vec<(usize, LightTrack)>,
    /// After which everything starts over, instances included; `None` stands still after the last
    /// key. Unit: s; > 0.
    pub period: Option<f64>,
}
