//! Cuts the reference's work into dispatches that keep to a time budget.
//!
//! A sweep gives every pixel the same number of new samples. Where one sample of all pixels takes
//! longer than the budget, a sweep is spread over several frames, some rows each. A pixel whose paths are
//! longer than its dispatch's share leaves the last one where it is and goes on with it in the next
//! sweep; the picture is finished when a sweep leaves none. Results do not depend on the cutting: a
//! pixel's samples are added one after the other wherever the cuts are.

use std::time::Duration;

use tyndall_shaders::types;

/// Most samples of one sweep: a changed scene should not wait for more.
const MAX_BATCH: u32 = 64;
/// Longest dispatch of a still picture: drivers reset devices that are silent for seconds.
const STILL_BUDGET: Duration = Duration::from_millis(250);
/// Pixel samples of the very first dispatch, before anything is measured.
const FIRST_UNITS: f64 = 4096.0;
/// Segments a pixel may follow for each sample it takes, and for the dispatch: most paths are shorter.
const SEGMENTS: u32 = 64;
/// Furthest that pixels with a sample lie apart: further, and a moving picture gains nothing.
const MAX_STRIDE: u32 = 8;
/// A measured cost may be that much too low for the next dispatch.
const GROWTH: f64 = 4.0;

/// Where the present sweep stands.
#[derive(Debug)]
pub(crate) struct Slices {
    budget: Duration,
    /// Time a pixel sample takes. Unit: s.
    cost: Option<f64>,
    /// Pixel samples of the last dispatch that was measured.
    last_units: f64,
    next_row: u32,
    /// Whether every sweep takes every pixel, whatever the budget.
    whole: bool,
    batch: u32,
    /// Counts the sweeps.
    sweep: u32,
}

/// Which part of which sweep a dispatch was.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Sweep {
    pub number: u32,
    pub completes: bool,
}

/// A dispatch's part of the picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Slice {
    pub first_row: u32,
    pub rows: u32,
    pub first_sample: u32,
    pub samples: u32,
    /// Every so many pixels along each axis, from the offset on; 1 takes all.
    pub stride: u32,
    pub offset: [u32; 2],
    /// Whether all pixels share the places of their samples, with the technique.
    pub shares_places: bool,
    /// Whether the buffers were cleared and hold what is known of every pixel.
    pub cleared: bool,
    /// Whether it is the last of its sweep.
    pub completes: bool,
}

impl Slice {
    /// Pixel samples in it; one a pixel where it only ends paths that wait.
    pub fn units(self, width: u32) -> u64 {
        let [columns, rows] = self.invocations(width);
        u64::from(columns) * u64::from(rows) * u64::from(self.samples.max(1))
    }

    /// Samples that every pixel has gained once it is done.
    pub fn completed_samples(self) -> u32 {
        if self.completes { self.samples } else { 0 }
    }

    /// Part of a picture of `height` rows that its sweep has done then.
    pub fn part(self, height: u32) -> f32 {
        if self.stride > 1 {
            return 0.0;
        }
        (self.first_row + self.rows) as f32 / height as f32
    }

    /// Pixels it works on, along both axes.
    pub fn invocations(self, width: u32) -> [u32; 2] {
        [width.div_ceil(self.stride), self.rows.div_ceil(self.stride)]
    }

    pub fn values(self) -> types::Slice {
        types::Slice {
            first_row: self.first_row,
            rows: self.rows,
            first_sample: self.first_sample,
            samples: self.samples,
            segments: SEGMENTS * (self.samples + 1),
            cleared: self.cleared.into(),
            stride: self.stride,
            offset_x: self.offset[0],
            offset_y: self.offset[1],
            shares_places: self.shares_places.into(),
        }
    }
}

impl Slices {
    pub fn new(budget: Duration) -> Self {
        Self {
            budget,
            cost: None,
            last_units: FIRST_UNITS / GROWTH,
            next_row: 0,
            whole: false,
            batch: 1,
            sweep: 0,
        }
    }

    /// Allows longer dispatches where nobody waits for a frame; returns what was allowed before.
    pub fn widen(&mut self) -> Duration {
        let before = self.budget;
        self.budget = before.max(STILL_BUDGET);
        before
    }

    /// Whether every sweep takes every pixel: a still's bits must not depend on the budget.
    pub fn keep_whole(&mut self, whole: bool) {
        self.whole = whole;
    }

    /// Changes the longest dispatch.
    pub fn set_budget(&mut self, budget: Duration) {
        self.budget = budget;
    }

    /// Forgets the sweep, not the cost.
    pub fn restart(&mut self) {
        self.next_row = 0;
    }

    /// Pixel samples that the budget allows the next dispatch.
    fn affordable(&self) -> f64 {
        let units = self.cost.map_or(FIRST_UNITS, |cost| {
            self.budget.as_secs_f64() / cost.max(1e-12)
        });
        units.min(self.last_units * GROWTH)
    }

    /// A sample of every so many pixels, all over the picture in one dispatch, where one of every pixel
    /// would take longer than the budget; `turn` chooses which pixels.
    pub fn thinned(&self, (width, height): (u32, u32), turn: u32) -> Option<Slice> {
        let whole = f64::from(width) * f64::from(height);
        let wanted = (whole / self.affordable()).sqrt().ceil() as u32;
        if wanted <= 1 || self.whole || self.budget >= STILL_BUDGET {
            return None;
        }
        let stride = wanted.min(MAX_STRIDE).min(width).min(height);
        // R2 sequence (Roberts 2018): any run of turns spreads over the cells of the stride.
        let place = |step: f64| ((f64::from(turn) * step).fract() * f64::from(stride)) as u32;
        Some(Slice {
            first_row: 0,
            rows: height,
            first_sample: 0,
            samples: 1,
            stride,
            offset: [place(0.754_877_666_246_693), place(0.569_840_290_998_053_3)],
            shares_places: false,
            cleared: true,
            completes: false,
        })
    }

    /// The next part of a picture that has `done` samples, with at most `wanted` in the end; without
    /// new samples where it has as many, for the paths that wait.
    pub fn next(&self, (width, height): (u32, u32), done: u32, wanted: u32) -> Slice {
        let units = self.affordable();
        let (first_row, samples) = if self.next_row == 0 {
            let whole = f64::from(width) * f64::from(height);
            let left = wanted.saturating_sub(done);
            (0, ((units / whole) as u32).clamp(1, MAX_BATCH).min(left))
        } else {
            (self.next_row.min(height - 1), self.batch)
        };
        let per_row = f64::from(width) * f64::from(samples.max(1));
        let rows = ((units / per_row) as u32).clamp(1, height - first_row);
        // A remnant of a few rows costs a frame of its own: take it along.
        let rest = height - first_row - rows;
        let rows = if rest > 0 && rest * 4 <= rows {
            rows + rest
        } else {
            rows
        };
        Slice {
            first_row,
            rows,
            first_sample: done,
            samples,
            stride: 1,
            offset: [0; 2],
            shares_places: false,
            cleared: false,
            completes: first_row + rows == height,
        }
    }

    /// Notes that `slice` was submitted.
    pub fn advance(&mut self, slice: Slice) -> Sweep {
        if slice.first_row == 0 {
            self.sweep = self.sweep.wrapping_add(1);
        }
        self.batch = slice.samples;
        self.next_row = if slice.completes || slice.stride > 1 {
            0
        } else {
            slice.first_row + slice.rows
        };
        Sweep {
            number: self.sweep,
            completes: slice.completes,
        }
    }

    /// Learns what a dispatch of `units` pixel samples took.
    pub fn measured(&mut self, units: u64, seconds: f64) {
        if units > 0 && seconds > 0.0 {
            self.cost = Some(seconds / units as f64);
            self.last_units = units as f64;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZE: (u32, u32) = (1920, 1080);

    /// Runs sweeps at a true cost until `samples` are done; returns the dispatches' times.
    fn run(slices: &mut Slices, cost: f64, samples: u32) -> Vec<f64> {
        let mut done = 0;
        let mut times = Vec::new();
        let mut next_row = 0;
        while done < samples {
            let slice = slices.next(SIZE, done, samples);
            assert_eq!(slice.first_row, next_row, "rows follow one another");
            assert_eq!(slice.first_sample, done);
            next_row += slice.rows;
            assert_eq!(slice.completes, next_row == SIZE.1);
            slices.advance(slice);
            if slice.completes {
                next_row = 0;
                done += slice.samples;
            }
            times.push(slice.units(SIZE.0) as f64 * cost);
            slices.measured(slice.units(SIZE.0), times[times.len() - 1]);
        }
        assert_eq!(done, samples, "never more samples than wanted");
        times
    }

    #[test]
    fn dispatches_keep_to_the_budget_whether_samples_are_cheap_or_dear() {
        for cost in [1e-9, 1e-7, 1e-5] {
            let budget = Duration::from_millis(8);
            let mut slices = Slices::new(budget);
            let times = run(&mut slices, cost, 20);
            let row = f64::from(SIZE.0) * cost;
            let most = times.iter().skip(1).copied().fold(0.0, f64::max);
            assert!(most <= budget.as_secs_f64() * 1.3 + row, "{cost}: {most}");
        }
    }

    #[test]
    fn cheap_samples_come_several_at_once() {
        let mut slices = Slices::new(Duration::from_millis(8));
        assert!(run(&mut slices, 1e-10, 256).len() < 40);
    }
}
