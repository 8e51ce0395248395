//! Builds an atlas: marks the bricks that something touches, classifies them, then quantises.
//!
//! Samples are gathered twice, so that the exact size is known before the values are allocated.

use std::collections::HashMap;

use glam::{DVec3, IVec3, UVec3};

use super::majorants::MajorantGrid;
use super::{
    APRON_SIDE, ATLAS_BRICK_SAMPLES, ATLAS_BRICK_WORDS, AtlasLimits, BrickAtlas, EMPTY_BRICK,
    decode_sample,
};
use crate::brick::voxel_index;
use crate::{BRICK_SIDE, Brick, Grid, VolumeError};

/// Mark of a brick that a stored voxel may touch. No slot has this number.
const TOUCHED: u32 = u32::MAX - 1;
/// Most cells along an axis: every index and product of an axis stays far inside `i32`.
const LONGEST: f64 = 1e9;

type Samples = [f32; ATLAS_BRICK_SAMPLES];

pub(super) fn atlas(grid: &Grid, limits: &AtlasLimits) -> Result<BrickAtlas, VolumeError> {
    let frame = Frame::new(grid)?;
    let [nx, ny, nz] = frame.bricks.to_array().map(u128::from);
    let entries = nx * ny * nz;
    let majorants = MajorantGrid::empty(frame.bricks.to_array(), limits.max_cells);
    let fixed =
        entries * size_of::<u32>() as u128 + majorants.cell_count() * size_of::<[f32; 2]>() as u128;
    check(fixed, limits)?;
    // The check above keeps the count within memory.
    let mut table = vec![EMPTY_BRICK; entries as usize];
    frame.touch(grid, &mut table);
    let (ranges, sources) = classify(grid, &frame, &mut table, fixed, limits)?;
    let mut values = vec![0; ranges.len() * ATLAS_BRICK_WORDS];
    for ((words, range), start) in values
        .chunks_exact_mut(ATLAS_BRICK_WORDS)
        .zip(&ranges)
        .zip(&sources)
    {
        let [min, max] = *range;
        if min < max {
            pack(&frame.gather(grid, *start), *range, words);
        }
    }
    let mut atlas = BrickAtlas {
        origin: frame.origin,
        clip: frame.clip,
        cells: frame.cells.to_array(),
        bricks: frame.bricks.to_array(),
        table,
        values,
        ranges,
        majorants,
    };
    atlas
        .majorants
        .fill(atlas.bricks, &atlas.table, &atlas.ranges);
    Ok(atlas)
}

/// Numbers the bricks that hold something and finds their ranges. Also says which brick each slot
/// is gathered from.
fn classify(
    grid: &Grid,
    frame: &Frame,
    table: &mut [u32],
    fixed: u128,
    limits: &AtlasLimits,
) -> Result<(Vec<[f32; 2]>, Vec<UVec3>), VolumeError> {
    const SLOT_BYTES: usize = ATLAS_BRICK_WORDS * size_of::<u32>() + size_of::<[f32; 2]>();
    let mut ranges = Vec::new();
    let mut sources = Vec::new();
    let mut constants: HashMap<u32, u32> = HashMap::new();
    let mut brick = UVec3::ZERO;
    for entry in table.iter_mut() {
        if *entry == TOUCHED {
            let samples = frame.gather(grid, brick);
            let min = samples.iter().copied().fold(f32::INFINITY, f32::min);
            let max = samples.iter().copied().fold(0.0, f32::max);
            let shared = if min == max {
                constants.get(&min.to_bits()).copied()
            } else {
                None
            };
            *entry = if max == 0.0 {
                EMPTY_BRICK
            } else if let Some(slot) = shared {
                slot
            } else {
                let slot = ranges.len();
                check(fixed + ((slot + 1) * SLOT_BYTES) as u128, limits)?;
                if slot >= TOUCHED as usize {
                    return Err(too_large(
                        "bricks of an atlas",
                        slot as u64,
                        u64::from(TOUCHED),
                    ));
                }
                if min == max {
                    constants.insert(min.to_bits(), slot as u32);
                }
                ranges.push([min, safe_max(min, max)]);
                sources.push(brick);
                slot as u32
            };
        }
        brick.x += 1;
        if brick.x == frame.bricks.x {
            brick = UVec3::new(0, brick.y + 1, brick.z);
        }
        if brick.y == frame.bricks.y {
            brick = UVec3::new(0, 0, brick.z + 1);
        }
    }
    Ok((ranges, sources))
}

/// The least upper end of a range from `min` that holds `max` and everything decoded.
fn safe_max(min: f32, max: f32) -> f32 {
    let mut top = max;
    // Rounding lifts the last step by an ulp at most: this ends at once or after one step.
    while top < f32::MAX && decode_sample([min, top], u16::MAX) > top {
        top = top.next_up();
    }
    top
}

/// Quantises to the nearest step, two samples a word.
fn pack(samples: &Samples, [min, max]: [f32; 2], words: &mut [u32]) {
    let (low, extent) = (f64::from(min), f64::from(max) - f64::from(min));
    let quantise = |sample: f32| {
        let step = (f64::from(sample) - low) / extent * 65535.0;
        // In 0..=65535, since the sample lies between min and max.
        (step + 0.5) as u32
    };
    for (word, pair) in words.iter_mut().zip(samples.chunks(2)) {
        let high = pair.get(1).map_or(0, |sample| quantise(*sample));
        *word = quantise(pair[0]) | high << 16;
    }
}

/// Where the atlas lies on the lattice.
struct Frame {
    origin: IVec3,
    clip: [DVec3; 2],
    cells: UVec3,
    bricks: UVec3,
}

impl Frame {
    fn new(grid: &Grid) -> Result<Self, VolumeError> {
        let [low, high] = grid.clip;
        let allowed = "finite corners, low ≤ high, within 1e9 of the lattice's origin";
        let fits = |v: DVec3| v.is_finite() && v.abs().max_element() <= LONGEST;
        if !fits(low) || !fits(high) || low.cmpgt(high).any() {
            return Err(VolumeError::invalid(
                "clip box",
                format!("{low} to {high}"),
                allowed,
            ));
        }
        let origin = low.floor();
        let cells = (high.ceil() - origin).max(DVec3::ONE).as_uvec3();
        Ok(Self {
            origin: origin.as_ivec3(),
            clip: [low - origin, high - origin],
            cells,
            bricks: cells.map(|side| side.div_ceil(BRICK_SIDE)),
        })
    }

    /// Marks the atlas bricks whose samples meet a stored brick of the grid.
    fn touch(&self, grid: &Grid, table: &mut [u32]) {
        let side = BRICK_SIDE as i32;
        let counts = grid.brick_counts().as_ivec3();
        for z in 0..counts.z {
            for y in 0..counts.y {
                for x in 0..counts.x {
                    let stored = IVec3::new(x, y, z);
                    if grid.brick(stored).is_none() {
                        continue;
                    }
                    // Its samples first..=first + 7 meet atlas bricks k with 8k ≤ last and
                    // first ≤ 8k + 8.
                    let first = stored * side - self.origin;
                    let low = (first - 1).map(|s| s.div_euclid(side)).max(IVec3::ZERO);
                    let high = (first + side - 1).map(|s| s.div_euclid(side));
                    let high = high.min(self.bricks.as_ivec3() - 1);
                    for bz in low.z..=high.z {
                        for by in low.y..=high.y {
                            for bx in low.x..=high.x {
                                table[self.index(bx, by, bz)] = TOUCHED;
                            }
                        }
                    }
                }
            }
        }
    }

    fn index(&self, x: i32, y: i32, z: i32) -> usize {
        let (nx, ny) = (self.bricks.x as usize, self.bricks.y as usize);
        x as usize + nx * (y as usize + ny * z as usize)
    }

    /// The 9³ samples of an atlas brick.
    fn gather(&self, grid: &Grid, brick: UVec3) -> Samples {
        // Lattice coordinates of the samples along each axis, as (which of two bricks, voxel).
        let mut places = [[(0_usize, 0_u32); APRON_SIDE as usize]; 3];
        let mut first_brick = IVec3::ZERO;
        for axis in 0..3 {
            let start = brick[axis] * BRICK_SIDE;
            let side = BRICK_SIDE as i32;
            let lattice = |i: u32| self.origin[axis] + (start + i).min(self.cells[axis]) as i32;
            first_brick[axis] = lattice(0).div_euclid(side);
            for (i, place) in places[axis].iter_mut().enumerate() {
                let at = lattice(i as u32);
                let which = at.div_euclid(side) - first_brick[axis];
                *place = (which as usize, at.rem_euclid(side) as u32);
            }
        }
        let stored: [Option<&Brick>; 8] = std::array::from_fn(|i| {
            let offset = IVec3::new(i as i32 & 1, i as i32 >> 1 & 1, i as i32 >> 2);
            grid.brick(first_brick + offset)
        });
        let mut samples = [0.0; ATLAS_BRICK_SAMPLES];
        let mut rows = samples.chunks_exact_mut(APRON_SIDE as usize);
        for (which_z, z) in places[2] {
            for (which_y, y) in places[1] {
                let Some(row) = rows.next() else {
                    return samples;
                };
                for (sample, (which_x, x)) in row.iter_mut().zip(places[0]) {
                    if let Some(voxels) = stored[which_x + 2 * which_y + 4 * which_z] {
                        *sample = voxels[voxel_index([x, y, z])];
                    }
                }
            }
        }
        samples
    }
}

fn check(bytes: u128, limits: &AtlasLimits) -> Result<(), VolumeError> {
    if bytes > u128::from(limits.bytes) {
        let found = u64::try_from(bytes).unwrap_or(u64::MAX);
        return Err(too_large("bytes of a brick atlas", found, limits.bytes));
    }
    Ok(())
}

fn too_large(what: &'static str, found: u64, limit: u64) -> VolumeError {
    VolumeError::Limit { what, found, limit }
}
