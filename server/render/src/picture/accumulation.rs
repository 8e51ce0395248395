//! The running mean of a picture: what restarts it, and when it is finished.

use std::time::Instant;

use tyndall_scene::{ChangeSet, StopRule};

use super::slices::Sweep;

/// Samples below which an estimated error stops nothing.
const MIN_SAMPLES: u32 = 16;
/// The technique's samples in a corrected picture: beyond, its noise is small beside the traced one's and
/// the time goes into traced samples.
const MAX_BASE_SAMPLES: u32 = 64;
/// As many as traced ones, up to so many; beyond, one for every `TRACED_PER_BASE`. At equal time that
/// took a tenth off the error of smoke and light shafts.
const EQUAL_SAMPLES: u32 = 16;
const TRACED_PER_BASE: u32 = 4;

/// The technique's samples beside `traced` ones.
fn base_for(traced: u32) -> u32 {
    let beyond = traced.saturating_sub(EQUAL_SAMPLES) / TRACED_PER_BASE;
    (traced.min(EQUAL_SAMPLES) + beyond).min(MAX_BASE_SAMPLES)
}

/// Part of the first sample after which the correction runs.
const FIRST_PART: f32 = 1.0 / 64.0;

/// A picture whose time is up may take that many times as long for the paths that still wait.
const MOST_OVERTIME: f32 = 2.0;

/// State of the running mean.
#[derive(Debug)]
pub(crate) struct Accumulation {
    samples: u32,
    /// Samples of the technique that the traced ones correct; `samples` without correction.
    base_samples: u32,
    /// Samples of a pixel when the correction ran last, if it did.
    estimated_at: Option<f32>,
    /// Whether samples were added since.
    behind: bool,
    epoch: u32,
    started: Instant,
    /// The mean is up to date but was never shown with the present exposure.
    redisplay: bool,
    /// The relative error that was estimated last, and the samples it stands for.
    error: Option<(u32, f32)>,
    /// What the reference's last sweep left undone.
    waiting: Waiting,
}

/// Paths that wait for their pixels' next dispatch.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Waiting {
    /// None.
    Nothing,
    /// Unknown until the sweep's frames come home; `pixels` is what has been counted of it.
    Unknown {
        sweep: u32,
        pixels: u64,
        /// Whether all its parts were submitted.
        whole: bool,
    },
    /// So many pixels lack samples.
    Pixels(u64),
}

/// What the next frame of a view has to do.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Work {
    /// Nothing: finished and shown.
    Nothing,
    /// Nothing before the frames in flight tell whether it is finished.
    Wait,
    /// Show the finished mean again, with another exposure.
    Redisplay,
    /// Add a sample.
    Sample,
}

impl Accumulation {
    pub fn new() -> Self {
        Self {
            samples: 0,
            base_samples: 0,
            estimated_at: None,
            behind: false,
            epoch: 0,
            started: Instant::now(),
            redisplay: false,
            error: None,
            waiting: Waiting::Nothing,
        }
    }

    /// Applies the reset rules.
    pub fn apply(&mut self, change: ChangeSet) {
        if change.restarts() {
            self.restart();
        }
        if change.contains(ChangeSet::DISPLAY) {
            self.redisplay = true;
        }
    }

    /// Forgets every sample.
    pub fn restart(&mut self) {
        self.samples = 0;
        self.base_samples = 0;
        self.estimated_at = None;
        self.behind = false;
        self.epoch = self.epoch.wrapping_add(1);
        self.started = Instant::now();
        self.redisplay = false;
        self.error = None;
        self.waiting = Waiting::Nothing;
    }

    /// Samples in the mean.
    pub fn samples(&self) -> u32 {
        self.samples
    }

    /// Counts restarts.
    pub fn epoch(&self) -> u32 {
        self.epoch
    }

    /// Whether the stop rule is met and no path waits: those that wait are the longest, so that a mean
    /// without them would be too dark.
    pub fn is_finished(&self, stop: StopRule) -> bool {
        let overdue = matches!(stop, StopRule::Seconds(seconds)
            if self.started.elapsed().as_secs_f32() >= MOST_OVERTIME * seconds);
        self.is_enough(stop) && (self.waiting == Waiting::Nothing || overdue)
    }

    /// Whether the stop rule wants no more samples.
    fn is_enough(&self, stop: StopRule) -> bool {
        match stop {
            // As many of the technique itself, whatever time traced ones took: same seed, same bits.
            StopRule::Samples(target) => {
                self.samples >= target && self.base_samples >= base_for(target)
            }
            StopRule::Seconds(seconds) => {
                self.samples > 0 && self.started.elapsed().as_secs_f32() >= seconds
            }
            // Too few samples know too little about their own error.
            StopRule::RelativeError(target) => self
                .error
                .is_some_and(|(samples, error)| samples >= MIN_SAMPLES && error <= target),
        }
    }

    /// What is left to do.
    pub fn work(&self, stop: StopRule) -> Work {
        let unknown = matches!(self.waiting, Waiting::Unknown { whole: true, .. });
        if !self.is_finished(stop) {
            if unknown && self.is_enough(stop) {
                Work::Wait
            } else {
                Work::Sample
            }
        } else if self.redisplay || self.is_behind() {
            Work::Redisplay
        } else {
            Work::Nothing
        }
    }

    /// Whether nothing was submitted since the last restart.
    pub fn is_new(&self) -> bool {
        self.estimated_at.is_none()
    }

    /// Samples of the technique itself.
    pub fn base_samples(&self) -> u32 {
        self.base_samples
    }

    /// Whether the technique's own mean still gains.
    pub fn wants_base(&self, stop: StopRule) -> bool {
        let traced = match stop {
            StopRule::Samples(target) => target.min(self.samples.saturating_add(1)),
            StopRule::Seconds(_) | StopRule::RelativeError(_) => self.samples.saturating_add(1),
        };
        self.base_samples < base_for(traced)
    }

    /// Whether the picture lacks samples that were added since the correction.
    pub fn is_behind(&self) -> bool {
        self.behind
    }

    /// Whether the correction is worth its time once there are `done` samples of a pixel, in the mean: it has
    /// not run yet, they grew by an eighth, or they are all. Of the first sample a small part is worth it, and
    /// then each half as much again.
    pub fn wants_estimate(&self, done: f32, stop: StopRule) -> bool {
        let last = matches!(stop, StopRule::Samples(target) if done >= target as f32)
            && !self.wants_base(stop);
        let eighth = |before: f32| 0.125 * before.max(1.0);
        let grown =
            |before: f32| done >= before + eighth(before).min((0.5 * before).max(FIRST_PART));
        last || self.estimated_at.is_none_or(grown)
    }

    /// Samples the stop rule allows in all.
    pub fn most_samples(&self, stop: StopRule) -> u32 {
        if self.is_enough(stop) {
            return self.samples;
        }
        match stop {
            StopRule::Samples(target) => target,
            StopRule::Seconds(_) | StopRule::RelativeError(_) => u32::MAX,
        }
    }

    /// Notes that a part of a sweep of the reference was submitted.
    pub fn await_sweep(&mut self, part: Sweep) {
        let counted = match self.waiting {
            Waiting::Unknown { sweep, pixels, .. } if sweep == part.number => pixels,
            _ => 0,
        };
        self.waiting = Waiting::Unknown {
            sweep: part.number,
            pixels: counted,
            whole: part.completes,
        };
    }

    /// Takes the number of pixels that a part of a sweep of restart `epoch` left unfinished.
    pub fn note_sweep(&mut self, epoch: u32, part: Sweep, unfinished: u32) {
        match &mut self.waiting {
            Waiting::Unknown { sweep, pixels, .. }
                if epoch == self.epoch && part.number == *sweep =>
            {
                *pixels += u64::from(unfinished);
                if part.completes {
                    self.waiting = match *pixels {
                        0 => Waiting::Nothing,
                        pixels => Waiting::Pixels(pixels),
                    };
                }
            }
            _ => {}
        }
    }

    /// Pixels that are known to lack samples, because a path of theirs is still under way.
    pub fn unfinished(&self) -> u64 {
        match self.waiting {
            Waiting::Nothing => 0,
            Waiting::Unknown { pixels, .. } | Waiting::Pixels(pixels) => pixels,
        }
    }

    /// Takes the error estimated for `samples` samples of restart `epoch`.
    pub fn note_error(&mut self, epoch: u32, samples: u32, error: f32) {
        if epoch == self.epoch && error >= 0.0 {
            self.error = Some((samples, error));
        }
    }

    /// Notes that `work` was submitted, which added `samples` samples to every pixel; whether one of the
    /// technique was among the work, where that has a mean of its own; and the samples of a pixel that the
    /// estimate was of, if one was.
    pub fn advance(
        &mut self,
        work: Work,
        samples: u32,
        base: Option<bool>,
        estimated: Option<f32>,
    ) {
        if work == Work::Sample {
            self.samples = self.samples.saturating_add(samples);
            self.base_samples = match base {
                Some(added) => self.base_samples + u32::from(added),
                None => self.samples,
            };
            self.behind |= samples > 0 || base == Some(true);
        }
        if estimated.is_some() {
            self.estimated_at = estimated;
            self.behind = false;
        }
        self.redisplay = false;
    }
}
