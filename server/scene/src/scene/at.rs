//! A scene at a time.

use std::sync::Arc;

use super::Scene;
use super::tracks::Track;
use crate::error::SceneError;
use crate::range::check_time;

impl Scene {
    /// The scene at a time. Surfaces, grids and maps are shared, and so are the placements if no
    /// instance stands elsewhere. Cost: one product an instance that moves. Unit: s.
    ///
    /// # Errors
    /// [`SceneError::Invalid`] unless `seconds` is from 0 to 1e6.
    pub fn at(&self, seconds: f64) -> Result<Self, SceneError> {
        check_time("time_seconds", seconds)?;
        let mut scene = self.clone();
        scene.time_seconds = seconds;
        let animation = self.animation.as_deref();
        let local = match animation.and_then(|animation| animation.period) {
            Some(period) => seconds.rem_euclid(period),
            None => seconds,
        };
        if let Some(animation) = animation {
            if let Some(track) = &animation.camera {
                let key = track.at(local);
                scene.camera.position = key.position;
                scene.camera.target = key.target;
                scene.camera.vertical_fov = key.vertical_fov as f32;
            }
            for (index, track) in &animation.lights {
                if let Some(light) = scene.lights.get_mut(*index) {
                    track.place(light, local);
                }
            }
        }
        if let Some(geometry) = self.geometry.at(local) {
            scene.geometry.0 = Arc::new(geometry);
        }
        Ok(scene)
    }

    /// The time after which the scene starts over or stands still; `None` if nothing moves.
    /// Unit: s.
    pub fn duration_seconds(&self) -> Option<f64> {
        let animation = self.animation.as_deref();
        let camera = animation.and_then(|animation| animation.camera.as_ref());
        let lights = animation.into_iter().flat_map(|a| &a.lights);
        let tracks = self.geometry.tracks.iter();
        let ends = camera
            .map(Track::end)
            .into_iter()
            .chain(lights.map(|(_, track)| track.end()))
            .chain(tracks.map(|track| track.placement.end()));
        let end = ends.reduce(f64::max)?;
        Some(animation.and_then(|a| a.period).unwrap_or(end))
    }

    /// Whether the scene starts over after [`Self::duration_seconds`].
    pub fn repeats(&self) -> bool {
        let animation = self.animation.as_deref();
        animation.is_some_and(|animation| animation.period.is_some())
    }
}
