//! Tracks: states at growing times, and the state in between.
//!
//! Between two keys positions, scales and fields of view change linearly, directions and rotations
//! along the shortest arc at a constant rate (Shoemake 1985). Before the first key and after the
//! last a track stands still; a scene with a period starts over after it. All in f64.

use glam::{DAffine3, DQuat, DVec3};

use crate::error::SceneError;

/// A state that a track interpolates.
pub trait Interpolate: Copy {
    /// The state at `fraction` in (0, 1) of the way to `next`.
    #[must_use]
    fn between(self, next: Self, fraction: f64) -> Self;
    /// Whether every number is finite.
    fn is_finite(self) -> bool;
}

/// States at growing times.
#[derive(Debug, Clone, PartialEq)]
pub struct Track<K> {
    /// Unit: s. Growing.
    times: Vec<f64>,
    /// One a time.
    keys: Vec<K>,
}

impl<K: Interpolate> Track<K> {
    /// A track of keys with their times; `path` is the JSON path of the list. Unit: s.
    ///
    /// # Errors
    /// [`SceneError::Invalid`] with `path` without any key, and with the path of the key if a time
    /// is not finite or not later than the one before, or a key is not finite.
    pub fn new(path: &str, keys: impl IntoIterator<Item = (f64, K)>) -> Result<Self, SceneError> {
        let (times, keys): (Vec<f64>, Vec<K>) = keys.into_iter().unzip();
        if times.is_empty() {
            return Err(SceneError::invalid(path, "no keyframe", "at least one"));
        }
        for (i, (time, key)) in times.iter().zip(&keys).enumerate() {
            let before = i.checked_sub(1).map(|before| times[before]);
            if !time.is_finite() || before.is_some_and(|before| *time <= before) {
                return Err(SceneError::invalid(
                    format!("{path}[{i}].time_seconds"),
                    time.to_string(),
                    "a finite time after the keyframe before",
                ));
            }
            if !key.is_finite() {
                return Err(SceneError::invalid(
                    format!("{path}[{i}]"),
                    "a number that is not finite",
                    "finite numbers",
                ));
            }
        }
        Ok(Self { times, keys })
    }

    /// The state at a time: a key's own at its time, the nearest key's outside. Unit: s.
    pub fn at(&self, seconds: f64) -> K {
        let next = self.times.partition_point(|time| *time <= seconds);
        let before = next.saturating_sub(1);
        let (key, time) = (self.keys[before], self.times[before]);
        if next == before || next == self.keys.len() || seconds <= time {
            return key;
        }
        let fraction = (seconds - time) / (self.times[next] - time);
        key.between(self.keys[next], fraction)
    }

    /// The times of its keys. Unit: s.
    pub fn times(&self) -> &[f64] {
        &self.times
    }

    /// Its keys.
    pub fn keys(&self) -> &[K] {
        &self.keys
    }

    /// The time of the last key. Unit: s.
    pub(super) fn end(&self) -> f64 {
        self.times.last().copied().unwrap_or(0.0)
    }
}

impl Interpolate for DVec3 {
    fn between(self, next: Self, fraction: f64) -> Self {
        self.lerp(next, fraction)
    }

    fn is_finite(self) -> bool {
        self.is_finite()
    }
}

/// A unit direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Direction(pub DVec3);

impl Interpolate for Direction {
    fn between(self, next: Self, fraction: f64) -> Self {
        let angle = self.0.cross(next.0).length().atan2(self.0.dot(next.0));
        let sine = angle.sin();
        if sine < 1e-9 {
            return Self(self.0.lerp(next.0, fraction).normalize_or(self.0));
        }
        let [a, b] = [1.0 - fraction, fraction].map(|part| (part * angle).sin() / sine);
        Self((self.0 * a + next.0 * b).normalize_or(self.0))
    }

    fn is_finite(self) -> bool {
        self.0.is_finite()
    }
}

/// The camera at a time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CameraKey {
    /// Unit: m.
    pub position: DVec3,
    /// The point looked at. Unit: m.
    pub target: DVec3,
    /// Full vertical field of view. Unit: radian.
    pub vertical_fov: f64,
}

impl Interpolate for CameraKey {
    fn between(self, next: Self, fraction: f64) -> Self {
        Self {
            position: self.position.lerp(next.position, fraction),
            target: self.target.lerp(next.target, fraction),
            vertical_fov: self.vertical_fov + (next.vertical_fov - self.vertical_fov) * fraction,
        }
    }

    fn is_finite(self) -> bool {
        self.position.is_finite() && self.target.is_finite() && self.vertical_fov.is_finite()
    }
}

/// A spot light at a time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SpotKey {
    /// Unit: m.
    pub position: DVec3,
    /// Axis of the cone, along propagation.
    pub direction: Direction,
}

impl Interpolate for SpotKey {
    fn between(self, next: Self, fraction: f64) -> Self {
        Self {
            position: self.position.between(next.position, fraction),
            direction: self.direction.between(next.direction, fraction),
        }
    }

    fn is_finite(self) -> bool {
        self.position.is_finite() && self.direction.is_finite()
    }
}

/// A placement: scale, then rotation, then translation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Placement {
    /// Unit: m.
    pub translation: DVec3,
    /// Unit quaternion.
    pub rotation: DQuat,
    /// No component changes its sign along a track.
    pub scale: DVec3,
}

impl Placement {
    /// As an affine map.
    pub fn affine(self) -> DAffine3 {
        DAffine3::from_scale_rotation_translation(self.scale, self.rotation, self.translation)
    }
}

impl Interpolate for Placement {
    fn between(self, next: Self, fraction: f64) -> Self {
        Self {
            translation: self.translation.lerp(next.translation, fraction),
            rotation: self.rotation.slerp(next.rotation, fraction),
            scale: self.scale.lerp(next.scale, fraction),
        }
    }

    fn is_finite(self) -> bool {
        self.translation.is_finite() && self.rotation.is_finite() && self.scale.is_finite()
    }
}
