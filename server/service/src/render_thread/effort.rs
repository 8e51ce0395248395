//! How many pixels a picture gets while it moves, so that its frames keep to their budget, and how it climbs
//! to its full size at rest.
//!
//! A moving frame has as many pixels as the budget allows by what the last ones took. When nothing has
//! changed for a while frames of four times as many pixels follow until traced samples have told them apart
//! from noise, then those of the full size, which go on from what these knew.

use std::time::{Duration, Instant};

use tyndall_render::FinishedFrame;

/// A picture counts as moving until this long after its last change.
const SETTLE_AFTER: Duration = Duration::from_millis(200);
/// Most of the budget for everything but traced samples.
const SHADING: f64 = 0.6;
/// Least of the budget for traced samples: they also get what the rest does not need.
const TRACING: f64 = 0.2;
/// Part of the budget for both; what is left is for encoding and sending.
const RENDERING: f64 = 0.72;
/// Sides of moving pictures are multiples of this part of the full ones.
const STEPS: u32 = 16;
/// Fewest steps of a side.
const FEWEST_STEPS: u32 = 2;
/// A larger moving picture is begun only if it takes so much of the budget at most: sizes must not flutter.
const ROOM_TO_GROW: f64 = 0.85;
/// Between moving and full size: so many times the pixels.
const BETWEEN: u32 = 4;
/// Traced samples of a pixel before the picture gets its full size, and how long they are waited for.
const ENOUGH_SAMPLES: u32 = 2;
const LONGEST_BETWEEN: Duration = Duration::from_millis(1500);
/// Most that the known time of a pixel rises, and falls, by one frame: the first frame of a kind also waits
/// for its shaders.
const MOST_RISE: f64 = 2.0;
const MOST_FALL: f64 = 4.0;

/// In which size a picture is shown.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Stage {
    /// As many pixels as the budget allows.
    Moving,
    /// More, until enough is known of them.
    Between,
    /// All.
    Full,
}

/// What one picture may cost at present.
#[derive(Debug)]
pub(super) struct Effort {
    budget: Duration,
    stage: Stage,
    changed: Option<Instant>,
    /// Time that a frame takes without traced samples, whatever its size, and what a pixel adds. Unit: s.
    fixed: f64,
    per_pixel: f64,
    /// Sixteenths of the full sides of the last moving picture.
    steps: u32,
}

impl Effort {
    /// Of a picture that was not shown yet. `fixed` is what the dispatches of a frame take by themselves,
    /// `per_pixel` a guess. Unit: s.
    pub(super) fn new(budget: Duration, fixed: f64, per_pixel: f64) -> Self {
        Self {
            budget,
            fixed,
            stage: Stage::Moving,
            changed: None,
            per_pixel,
            steps: 0,
        }
    }

    /// Notes that the picture changes with the frame that is about to begin.
    pub(super) fn change(&mut self, now: Instant) {
        self.changed = Some(now);
        self.stage = Stage::Moving;
    }

    /// When the picture may climb, if it is not at its full size.
    pub(super) fn climbs_at(&self) -> Option<Instant> {
        let changed = self.changed.filter(|_| self.stage == Stage::Moving)?;
        Some(changed + SETTLE_AFTER)
    }

    /// Climbs if the picture has stood still long enough; call where no frame of it is on the device.
    pub(super) fn climb(&mut self, now: Instant) {
        self.stage = match self.stage {
            Stage::Moving if self.climbs_at().is_some_and(|at| now >= at) => Stage::Between,
            other => other,
        };
    }

    /// Whether frames are smaller than the picture is to be in the end.
    pub(super) fn is_reduced(&self, full: (u32, u32)) -> bool {
        self.size(full) != full
    }

    /// The size of the next frame of a picture of size `full`. Unit: pixel.
    pub(super) fn size(&self, full: (u32, u32)) -> (u32, u32) {
        let steps = match self.stage {
            Stage::Full => return full,
            Stage::Moving => self.moving_steps(full),
            Stage::Between => {
                let steps = self.moving_steps(full);
                (steps * BETWEEN.isqrt()).min(STEPS)
            }
        };
        scaled(full, steps)
    }

    /// Time of a frame of this size without traced samples. Unit: s.
    fn shading(&self, (width, height): (u32, u32)) -> f64 {
        self.fixed + f64::from(width) * f64::from(height) * self.per_pixel
    }

    fn moving_steps(&self, full: (u32, u32)) -> u32 {
        let takes = |steps: u32| self.shading(scaled(full, steps));
        let budget = SHADING * self.budget.as_secs_f64();
        let fits = |steps: &u32| {
            let room = if *steps > self.steps && self.steps > 0 {
                ROOM_TO_GROW
            } else {
                1.0
            };
            takes(*steps) <= room * budget
        };
        let most = (FEWEST_STEPS..=STEPS).rev().find(fits);
        most.unwrap_or(FEWEST_STEPS)
    }

    /// Longest time of traced samples in the next frame of a picture of size `full`; `None` where nothing
    /// is waiting for it.
    pub(super) fn tracing(&self, full: (u32, u32)) -> Option<Duration> {
        if !self.is_moving() {
            return None;
        }
        let shading = self.shading(self.size(full));
        let left = RENDERING - shading / self.budget.as_secs_f64().max(1e-6);
        Some(self.budget.mul_f64(left.clamp(TRACING, RENDERING)))
    }

    /// Whether the next frame is of a moving picture.
    pub(super) fn is_moving(&self) -> bool {
        self.stage == Stage::Moving
    }

    /// Learns what a frame took, and that it was shown.
    pub(super) fn measured(&mut self, frame: &FinishedFrame, full: (u32, u32)) {
        let traced = |name: &str| name == "reference";
        let passes = frame.pass_times.iter().filter(|pass| !traced(pass.name));
        let micros = if frame.pass_times.is_empty() {
            f64::from(frame.render_micros)
        } else {
            passes.map(|pass| f64::from(pass.micros)).sum()
        };
        let pixels = f64::from(frame.width) * f64::from(frame.height);
        let shown = (frame.width, frame.height);
        let waited = |at: Instant| at.elapsed() >= SETTLE_AFTER + LONGEST_BETWEEN;
        let enough = frame.samples >= ENOUGH_SAMPLES || frame.converged;
        if self.stage == Stage::Between
            && shown == self.size(full)
            && (enough || self.changed.is_none_or(waited))
        {
            self.stage = Stage::Full;
        }
        // Frames at rest leave out what did not change.
        if pixels < 1.0 || self.stage != Stage::Moving || frame.samples > 1 {
            return;
        }
        let found = (micros * 1e-6 - self.fixed) / pixels;
        let least = self.per_pixel / MOST_FALL;
        self.per_pixel = found.clamp(least, self.per_pixel * MOST_RISE).max(1e-12);
        self.steps = (1..=STEPS)
            .find(|steps| scaled(full, *steps) == shown)
            .unwrap_or(self.steps);
    }
}

/// A picture of so many sixteenths of the sides.
fn scaled((width, height): (u32, u32), steps: u32) -> (u32, u32) {
    let side = |side: u32| (side * steps).div_ceil(STEPS).max(1);
    (side(width), side(height))
}

#[cfg(test)]
mod tests {
    use super::*;

    const FULL: (u32, u32) = (1280, 720);
    const BUDGET: Duration = Duration::from_millis(100);

    /// A frame of one sample that took so long for each pixel. Unit: µs.
    fn frame((width, height): (u32, u32), micros: f64) -> FinishedFrame {
        FinishedFrame {
            tag: 0,
            width,
            height,
            rgba: Vec::new(),
            samples: 0,
            converged: false,
            epoch: 0,
            stats: tyndall_render::FrameStats::default(),
            pass_times: Vec::new(),
            render_micros: (f64::from(width) * f64::from(height) * micros) as u32,
            units: 0,
            shadow_layers: 0,
        }
    }

    fn pixels((width, height): (u32, u32)) -> f64 {
        f64::from(width) * f64::from(height)
    }

    #[test]
    fn moving_pictures_keep_to_the_budget_and_follow_what_pixels_take() {
        let mut effort = Effort::new(BUDGET, 0.0, 1.5e-6);
        for micros in [1.5, 0.2, 6.0, 0.01, 1.0] {
            for _ in 0..8 {
                effort.change(Instant::now());
                let size = effort.size(FULL);
                effort.measured(&frame(size, micros), FULL);
            }
            let size = effort.size(FULL);
            let seconds = pixels(size) * micros * 1e-6;
            let smallest = size == scaled(FULL, FEWEST_STEPS);
            assert!(smallest || seconds <= SHADING * 0.1, "{micros}: {size:?}");
            // The next larger size has 2.25 times the pixels at most, and must leave some room.
            assert!(
                size == FULL || seconds > 0.2 * SHADING * 0.1,
                "{micros}: {size:?}"
            );
        }
    }

    #[test]
    fn one_slow_frame_halves_a_picture_at_most() {
        let mut effort = Effort::new(BUDGET, 0.0, 1e-7);
        effort.change(Instant::now());
        let before = pixels(effort.size(FULL));
        effort.measured(&frame(effort.size(FULL), 1000.0), FULL);
        assert!(pixels(effort.size(FULL)) >= 0.35 * before);
    }

    #[test]
    fn a_picture_at_rest_climbs_in_two_steps() {
        let mut effort = Effort::new(BUDGET, 0.0, 5e-6);
        let start = Instant::now();
        effort.change(start);
        let moving = effort.size(FULL);
        effort.climb(start + SETTLE_AFTER / 2);
        assert_eq!(effort.size(FULL), moving, "not yet");
        effort.climb(start + SETTLE_AFTER);
        let between = effort.size(FULL);
        assert!(pixels(between) > 3.0 * pixels(moving) && between != FULL);
        assert_eq!(effort.tracing(FULL), None, "as long as the device allows");
        let mut known = frame(between, 5.0);
        effort.measured(&known, FULL);
        assert_eq!(effort.size(FULL), between, "nothing is known of it yet");
        known.samples = ENOUGH_SAMPLES;
        effort.measured(&known, FULL);
        assert_eq!(effort.size(FULL), FULL);
        effort.change(start + 2 * SETTLE_AFTER);
        assert_eq!(effort.size(FULL), moving);
    }

    #[test]
    fn traced_samples_get_what_shading_leaves() {
        let cheap = Effort::new(BUDGET, 0.0, 1e-12);
        assert!(
            cheap
                .tracing(FULL)
                .is_some_and(|time| time > BUDGET.mul_f64(0.7))
        );
        let dear = Effort::new(BUDGET, 0.0, 1e-3);
        assert_eq!(dear.tracing(FULL), Some(BUDGET.mul_f64(TRACING)));
    }
}
