//! How many pixels a picture gets while it moves, so that its frames keep to their budget, and how it climbs
//! to its full size at rest.
//!
//! A moving frame has as many pixels as the budget allows by what the last ones took. When nothing has
//! changed for a while one frame of four times as many pixels follows, then those of the full size.

use std::time::{Duration, Instant};

use tyndall_render::FinishedFrame;

/// A picture counts as moving until this long after its last change.
const SETTLE_AFTER: Duration = Duration::from_millis(200);
/// Part of the budget for everything but traced samples; what is left is for encoding and sending.
const SHADING: f64 = 0.65;
/// Part of the budget for traced samples.
const TRACING: f64 = 0.2;
/// Sides of moving pictures are multiples of this part of the full ones.
const STEPS: u32 = 16;
/// Fewest steps of a side.
const FEWEST_STEPS: u32 = 2;
/// A larger moving picture is begun only if it takes so much of the budget at most: sizes must not flutter.
const ROOM_TO_GROW: f64 = 0.85;
/// Between moving and full size: so many times the pixels.
const BETWEEN: u32 = 4;
/// Most that the known time of a pixel rises, and falls, by one frame: the first frame of a kind also waits
/// for its shaders.
const MOST_RISE: f64 = 2.0;
const MOST_FALL: f64 = 4.0;

/// In which size a picture is shown.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Stage {
    /// As many pixels as the budget allows.
    Moving,
    /// More, for one frame.
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
    /// Time a pixel takes without traced samples. Unit: s.
    per_pixel: f64,
    /// Sixteenths of the full sides of the last moving picture.
    steps: u32,
}

impl Effort {
    /// Of a picture that was not shown yet; `per_pixel` is a guess in seconds.
    pub(super) fn new(budget: Duration, per_pixel: f64) -> Self {
        Self {
            budget,
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

    fn moving_steps(&self, full: (u32, u32)) -> u32 {
        let takes = |steps: u32| {
            let (width, height) = scaled(full, steps);
            f64::from(width) * f64::from(height) * self.per_pixel
        };
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

    /// Longest time of traced samples in the next frame; `None` where nothing is waiting for it.
    pub(super) fn tracing(&self) -> Option<Duration> {
        (self.stage == Stage::Moving).then(|| self.budget.mul_f64(TRACING))
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
        if self.stage == Stage::Between && shown == self.size(full) {
            self.stage = Stage::Full;
        }
        // Frames at rest leave out what did not change.
        if pixels < 1.0 || self.stage != Stage::Moving || frame.samples > 1 {
            return;
        }
        let found = micros * 1e-6 / pixels;
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
