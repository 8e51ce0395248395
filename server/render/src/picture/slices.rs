//! Cuts the reference's work into dispatches that keep to a time budget.
//!
//! A sweep gives every pixel the same number of new samples. Where one sample of all pixels takes
//! longer than the budget, a sweep is spread over several frames. Each takes some rows, or, where a
//! picture is corrected in the meantime, a few places of every cell of up to 8×8 pixels, in an order that spreads
//! them: then all of the picture gains at once, and evenly. Where not even one place of all cells fits into
//! the budget, some rows of cells are taken. A pixel whose paths are
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
/// Largest cells, and so the furthest that pixels with a sample lie apart: further, and a picture gains nothing.
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
    /// What the present sweep takes next.
    next: Position,
    /// Side of its cells, and by which their places are moved. Unit: pixel.
    stride: u32,
    offset: [u32; 2],
    /// Whether sweeps go row by row, whatever is asked.
    whole: bool,
    batch: u32,
    /// Counts the sweeps.
    sweep: u32,
}

/// How a sweep is cut where it takes several dispatches.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Cut {
    /// Row by row: nobody looks before it is done.
    Rows,
    /// Spread over the picture; the first dispatch of a new one is, whatever it takes.
    Spread {
        /// Whether nothing of the picture was traced yet.
        is_new: bool,
        /// Counts the pictures: each begins at another place of the cells.
        turn: u32,
    },
}

/// A place of the cells, and a row of cells, in the order in which a sweep takes them.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
struct Position {
    place: u32,
    row: u32,
}

/// Which part of which sweep a dispatch was.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Sweep {
    pub number: u32,
    pub completes: bool,
}

/// A dispatch's part of the picture: some places of the cells in some rows of cells.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Slice {
    /// Of cells.
    pub first_row: u32,
    pub rows: u32,
    /// Rows of cells that the picture has.
    pub all_rows: u32,
    /// Places of a cell, in the order of `spread_place` in the shader; several only of all rows.
    pub first_place: u32,
    pub places: u32,
    pub first_sample: u32,
    pub samples: u32,
    /// Side of a cell; 1 takes all pixels of the rows. Unit: pixel.
    pub stride: u32,
    /// By which the places are moved, around in their cells. Unit: pixel.
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

    /// Part of the picture that its sweep has done then.
    pub fn part(self) -> f32 {
        let places = (self.first_place + self.places - 1) as f32;
        let of_last = (self.first_row + self.rows) as f32 / self.all_rows as f32;
        (places + of_last) / (self.stride * self.stride) as f32
    }

    /// Pixels it works on: a row of them for each row of cells and each place.
    pub fn invocations(self, width: u32) -> [u32; 2] {
        [width.div_ceil(self.stride), self.rows * self.places]
    }

    pub fn values(self) -> types::Slice {
        types::Slice {
            first_row: self.first_row,
            rows: self.rows,
            first_place: self.first_place,
            places: self.places,
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
            next: Position::default(),
            stride: 1,
            offset: [0; 2],
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

    /// Whether sweeps go row by row: nobody looks at a still before it is done.
    pub fn keep_whole(&mut self, whole: bool) {
        self.whole = whole;
    }

    /// Changes the longest dispatch.
    pub fn set_budget(&mut self, budget: Duration) {
        self.budget = budget;
    }

    /// Forgets the sweep, not the cost.
    pub fn restart(&mut self) {
        self.next = Position::default();
    }

    /// Pixel samples that the budget allows the next dispatch.
    fn affordable(&self) -> f64 {
        let units = self.cost.map_or(FIRST_UNITS, |cost| {
            self.budget.as_secs_f64() / cost.max(1e-12)
        });
        units.min(self.last_units * GROWTH)
    }

    /// Side of the cells of a sweep, a power of two: the least with which one place of all cells fits into
    /// the budget.
    fn stride_of(&self, (width, height): (u32, u32)) -> u32 {
        let whole = f64::from(width) * f64::from(height);
        let most = MAX_STRIDE.min(width).min(height);
        let fits = |stride: u32| whole / f64::from(stride * stride) <= self.affordable();
        let mut stride = 1;
        while !fits(stride) && stride * 2 <= most {
            stride *= 2;
        }
        stride
    }

    /// The next part of a picture that has `done` samples, with at most `wanted` in the end; without
    /// new samples where it has as many, for the paths that wait.
    pub fn next(&self, size: (u32, u32), done: u32, wanted: u32, cut: Cut) -> Slice {
        let (width, height) = size;
        let cut = if self.whole { Cut::Rows } else { cut };
        let units = self.affordable();
        let (stride, offset, samples) = if self.next == Position::default() {
            let whole = f64::from(width) * f64::from(height);
            let left = wanted.saturating_sub(done);
            let samples = ((units / whole) as u32).clamp(1, MAX_BATCH).min(left);
            let (stride, offset) = match cut {
                Cut::Rows => (1, [0; 2]),
                Cut::Spread { turn, .. } => {
                    let stride = self.stride_of(size);
                    (stride, offset_of(turn, stride))
                }
            };
            (stride, offset, samples)
        } else {
            (self.stride, self.offset, self.batch)
        };
        let [columns, all_rows] = [width, height].map(|side| side.div_ceil(stride));
        let first_row = self.next.row.min(all_rows - 1);
        let per_row = f64::from(columns) * f64::from(samples.max(1));
        // As many pixels as a row of the picture has, at least; of a new picture some of every part.
        let affordable = (units / per_row).max(f64::from(stride));
        let rows = match cut {
            Cut::Spread { is_new: true, .. } => all_rows - first_row,
            Cut::Spread { is_new: false, .. } | Cut::Rows => {
                part_of(all_rows - first_row, affordable)
            }
        };
        let all_places = stride * stride;
        let first_place = self.next.place.min(all_places - 1);
        let places = if rows == all_rows {
            part_of(
                all_places - first_place,
                units / (per_row * f64::from(all_rows)),
            )
        } else {
            1
        };
        Slice {
            first_row,
            rows,
            all_rows,
            first_place,
            places,
            first_sample: done,
            samples,
            stride,
            offset,
            shares_places: false,
            cleared: false,
            completes: first_row + rows == all_rows && first_place + places == all_places,
        }
    }

    /// Notes that `slice` was submitted.
    pub fn advance(&mut self, slice: Slice) -> Sweep {
        if slice.first_row == 0 && slice.first_place == 0 {
            self.sweep = self.sweep.wrapping_add(1);
        }
        self.batch = slice.samples;
        (self.stride, self.offset) = (slice.stride, slice.offset);
        self.next = if slice.completes {
            Position::default()
        } else {
            let row = slice.first_row + slice.rows;
            let ends_place = row == slice.all_rows;
            Position {
                place: slice.first_place + slice.places - u32::from(!ends_place),
                row: if ends_place { 0 } else { row },
            }
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

/// The place of the cells that a picture begins with.
fn offset_of(turn: u32, stride: u32) -> [u32; 2] {
    // R2 sequence (Roberts 2018): any run of turns spreads over the cells.
    let place = |step: f64| ((f64::from(turn) * step).fract() * f64::from(stride)) as u32;
    [place(0.754_877_666_246_693), place(0.569_840_290_998_053_3)]
}

/// As many of `left` as are affordable, and at least one. A remnant costs a frame of its own: it is taken along
/// where it is small.
fn part_of(left: u32, affordable: f64) -> u32 {
    let part = (affordable as u32).clamp(1, left);
    let rest = left - part;
    if rest * 4 <= part { left } else { part }
}

#[cfg(test)]
mod tests {
    use std::collections::HashSet;

    use super::*;

    const SIZE: (u32, u32) = (1920, 1080);
    const REST: Cut = Cut::Spread {
        is_new: false,
        turn: 5,
    };

    /// Runs sweeps at a true cost until `samples` are done; returns the dispatches' times.
    fn run(slices: &mut Slices, cost: f64, samples: u32, cut: Cut) -> Vec<f64> {
        let mut done = 0;
        let mut times = Vec::new();
        // Places of a cell that a sweep has done, and rows of cells of the next one.
        let (mut places, mut rows) = (0, 0);
        while done < samples {
            let slice = slices.next(SIZE, done, samples, cut);
            assert_eq!(slice.first_place, places, "places follow one another");
            assert_eq!(slice.first_row, rows, "rows follow one another");
            assert_eq!(slice.first_sample, done);
            assert_eq!(slice.all_rows, SIZE.1.div_ceil(slice.stride));
            rows += slice.rows;
            if rows == slice.all_rows {
                (places, rows) = (places + slice.places, 0);
            } else {
                assert_eq!(slice.places, 1, "several places of all rows only");
            }
            assert_eq!(slice.completes, places == slice.stride * slice.stride);
            assert!(cut != Cut::Rows || slice.stride == 1);
            slices.advance(slice);
            if slice.completes {
                places = 0;
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
        let costs = [1e-9, 1e-7, 1e-5];
        let cuts = [Cut::Rows, REST];
        for (cost, cut) in costs.iter().flat_map(|cost| cuts.map(|cut| (*cost, cut))) {
            let budget = Duration::from_millis(8);
            let mut slices = Slices::new(budget);
            let times = run(&mut slices, cost, 20, cut);
            let row = f64::from(SIZE.0) * cost;
            let most = times.iter().skip(1).copied().fold(0.0, f64::max);
            assert!(most <= budget.as_secs_f64() * 1.3 + row, "{cost}: {most}");
        }
    }

    #[test]
    fn cheap_samples_come_several_at_once() {
        let mut slices = Slices::new(Duration::from_millis(8));
        assert!(run(&mut slices, 1e-10, 256, REST).len() < 40);
    }

    #[test]
    fn a_spread_sweep_has_a_place_in_every_cell_after_a_few_dispatches() {
        let mut slices = Slices::new(Duration::from_millis(180));
        // The fogged hall on two cores.
        slices.measured(6_000, 6_000.0 * 27e-6);
        let mut dispatches = 0;
        let place = loop {
            let slice = slices.next((1280, 720), 0, 1, REST);
            slices.advance(slice);
            dispatches += 1;
            if slice.first_row + slice.rows == slice.all_rows {
                break slice;
            }
        };
        assert_eq!((place.stride, place.places), (8, 1));
        assert!(dispatches <= 3, "{dispatches}");
        assert!((place.part() - 1.0 / 64.0).abs() < 1e-6, "{}", place.part());
    }
    #[test]
    fn the_first_dispatch_of_a_new_picture_is_all_over_it_and_the_others_go_on_from_it() {
        let mut slices = Slices::new(Duration::ZERO);
        slices.measured(4096, 1.0);
        let cut = |is_new, turn| Cut::Spread { is_new, turn };
        let first = slices.next(SIZE, 0, 1, cut(true, 7));
        assert_eq!((first.rows, first.stride), (first.all_rows, 8));
        slices.advance(first);
        let second = slices.next(SIZE, 0, 1, cut(false, 8));
        assert_eq!((second.first_place, second.first_row), (first.places, 0));
        assert_eq!(second.offset, first.offset, "places are taken once");
        slices.restart();
        let places: HashSet<[u32; 2]> = (0..64)
            .map(|turn| slices.next(SIZE, 0, 1, cut(true, turn)).offset)
            .collect();
        assert!(places.len() > 40, "{}", places.len());
    }
}
