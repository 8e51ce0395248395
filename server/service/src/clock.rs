//! The clock of a session whose scene moves.
//!
//! It starts at the first frame, stands still while nobody looks, and never runs past the end of a
//! scene that does not repeat: a finished animation converges like any still scene. The time comes
//! from outside.

use std::time::Instant;

use tyndall_scene::Scene;

/// The time that a session shows.
#[derive(Debug, Clone)]
pub(crate) struct Clock {
    /// Unit: s.
    seconds: f64,
    /// When `seconds` was right; `None` until a frame asks for the time.
    since: Option<Instant>,
    playing: bool,
    /// Of the scene; 0 if nothing moves. Unit: s.
    duration: f64,
    repeats: bool,
}

impl Clock {
    /// A clock at the scene's time, running if something moves.
    pub(crate) fn new(scene: &Scene) -> Self {
        Self {
            seconds: scene.time_seconds,
            since: None,
            playing: true,
            duration: scene.duration_seconds().unwrap_or(0.0),
            repeats: scene.repeats(),
        }
    }

    /// Takes over a changed scene; the time stays.
    pub(crate) fn adopt(&mut self, scene: &Scene) {
        self.duration = scene.duration_seconds().unwrap_or(0.0);
        self.repeats = scene.repeats();
    }

    /// Whether the next frame shows another time than the last one.
    pub(crate) fn is_running(&self) -> bool {
        self.playing && self.duration > 0.0 && (self.repeats || self.seconds < self.duration)
    }

    /// Whether it was asked to run.
    pub(crate) fn is_playing(&self) -> bool {
        self.playing
    }

    /// The time of a frame begun at `now`. Unit: s.
    pub(crate) fn tick(&mut self, now: Instant) -> f64 {
        if self.is_running() {
            if let Some(since) = self.since {
                self.seconds += now.saturating_duration_since(since).as_secs_f64();
            }
            self.since = Some(now);
            if self.repeats {
                self.seconds = self.seconds.rem_euclid(self.duration);
            } else {
                self.seconds = self.seconds.min(self.duration);
            }
        }
        self.seconds
    }

    /// Stands still until the next frame: nobody looks.
    pub(crate) fn hold(&mut self) {
        self.since = None;
    }

    /// Goes to a time that the scene accepted. Unit: s.
    pub(crate) fn seek(&mut self, seconds: f64) {
        self.seconds = seconds;
        self.since = None;
    }

    /// Runs or stands; a clock at its end starts over.
    pub(crate) fn play(&mut self, playing: bool) {
        if playing && !self.repeats && self.seconds >= self.duration {
            self.seconds = 0.0;
        }
        if self.playing != playing {
            self.since = None;
        }
        self.playing = playing;
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;

    fn clock(duration: f64, repeats: bool) -> Clock {
        Clock {
            seconds: 0.0,
            since: None,
            playing: true,
            duration,
            repeats,
        }
    }

    #[test]
    fn time_starts_at_the_first_frame_and_starts_over() {
        let start = Instant::now();
        let after = |millis| start + Duration::from_millis(millis);
        let mut clock = clock(2.0, true);
        assert_eq!(clock.tick(after(500)), 0.0);
        assert_eq!(clock.tick(after(1500)), 1.0);
        assert_eq!(clock.tick(after(3000)), 0.5);
        assert!(clock.is_running());
    }

    #[test]
    fn a_scene_that_ends_stands_still_there_and_can_be_played_again() {
        let start = Instant::now();
        let mut clock = clock(2.0, false);
        clock.tick(start);
        assert_eq!(clock.tick(start + Duration::from_secs(9)), 2.0);
        assert!(!clock.is_running());
        clock.play(true);
        assert!(clock.is_running());
        assert!(clock.tick(start + Duration::from_secs(9)) < 1e-9);
    }

    #[test]
    fn time_stands_while_paused_held_or_nothing_moves() {
        let start = Instant::now();
        let after = |seconds| start + Duration::from_secs(seconds);
        let mut clock = clock(100.0, true);
        clock.tick(start);
        clock.tick(after(1));
        clock.hold();
        assert_eq!(clock.tick(after(50)), 1.0);
        clock.play(false);
        assert!(!clock.is_running());
        assert_eq!(clock.tick(after(60)), 1.0);
        clock.seek(7.0);
        clock.play(true);
        assert_eq!(clock.tick(after(70)), 7.0);
        assert_eq!(clock.tick(after(71)), 8.0);
        assert!(!self::clock(0.0, false).is_running());
    }
}
