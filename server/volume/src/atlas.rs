//! A grid in the form that a device samples: bricks of 9³ quantised samples behind a table, and a
//! coarse grid of bounds for tracking.
//!
//! A cell is the cube between 8 neighbouring samples. Bricks hold 8³ cells and therefore 9³
//! samples: the upper face repeats what the neighbours hold, so that the 8 samples of any cell are
//! in one brick. The table covers the cells that meet the clip box and no others; sample (0, 0, 0)
//! of the atlas is lattice point `origin`, the floor of the clip box's low corner. So cells with a
//! negative index, which the lattice has between its background and voxel 0, don't exist here.
//! Samples outside the lattice are 0; samples beyond the last cell repeat the last one that a cell
//! needs, so that they widen no brick's range.
//!
//! A device samples at lattice point x by: p = x − `origin`, which lies in `clip`;
//! cell = min(⌊p⌋, `cells` − 1); brick = cell / 8, slot = table entry (x fastest), 0 if [`EMPTY_BRICK`];
//! the 8 samples from entry `s.x + 9·(s.y + 9·s.z)` with s = cell mod 8 + corner; weights from
//! p − cell.

mod build;
mod majorants;
#[cfg(test)]
mod tests;

use glam::{DVec3, IVec3, UVec3};

use crate::{BRICK_SIDE, Grid, VolumeError};

pub use majorants::MajorantGrid;

/// Samples along an edge of an atlas brick: 8 voxels and the first of the neighbour.
pub const APRON_SIDE: u32 = BRICK_SIDE + 1;
/// Samples of an atlas brick.
pub const ATLAS_BRICK_SAMPLES: usize = 729;
/// Words of an atlas brick in `values`: two samples a word, the last upper half unused.
pub const ATLAS_BRICK_WORDS: usize = 365;
/// Table entry of a brick whose 729 samples are all 0.
pub const EMPTY_BRICK: u32 = u32::MAX;

/// Upper bounds on an atlas, checked before it is allocated.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct AtlasLimits {
    /// Table, values, ranges and majorants together. Unit: byte.
    pub bytes: u64,
    /// Cells of the majorant grid; at least 1.
    pub max_cells: u64,
}

impl Default for AtlasLimits {
    fn default() -> Self {
        Self {
            bytes: 4 << 30,
            max_cells: 64 * 64 * 64,
        }
    }
}

/// A grid as a device samples it; see the module's head for how.
#[derive(Debug, Clone, PartialEq)]
pub struct BrickAtlas {
    /// Lattice point of sample (0, 0, 0).
    pub origin: IVec3,
    /// Low and high corner of the clip box, relative to `origin`: 0 outside. Low lies in [0, 1).
    pub clip: [DVec3; 2],
    /// Cells along x, y, z that the clip box meets, at least 1 each.
    pub cells: [u32; 3],
    /// Entries of the table along x, y, z.
    pub bricks: [u32; 3],
    /// Slot of each brick or [`EMPTY_BRICK`], x fastest. Constant bricks of equal value share a slot.
    pub table: Vec<u32>,
    /// [`ATLAS_BRICK_WORDS`] words a slot: samples as u16 between the slot's range, x fastest, low
    /// half first. Sample q stands for [`decode_sample`]`(range, q)`.
    pub values: Vec<u32>,
    /// Least and largest sample of each slot; no decoded sample lies outside.
    pub ranges: Vec<[f32; 2]>,
    /// Bounds of the field in coarse cells.
    pub majorants: MajorantGrid,
}

/// The value of sample `q` of a brick with the given range.
pub fn decode_sample([min, max]: [f32; 2], q: u16) -> f32 {
    min + (max - min) * (f32::from(q) * (1.0 / 65535.0))
}

impl BrickAtlas {
    /// The atlas of a grid.
    ///
    /// # Errors
    /// [`VolumeError::Limit`] if it would be too large, [`VolumeError::Invalid`] if the grid's
    /// clip box is not finite or its corners are swapped.
    pub fn new(grid: &Grid, limits: &AtlasLimits) -> Result<Self, VolumeError> {
        build::atlas(grid, limits)
    }

    /// Bricks that `values` and `ranges` hold.
    pub fn slots(&self) -> usize {
        self.ranges.len()
    }

    /// Memory of all parts. Unit: byte.
    pub fn bytes(&self) -> u64 {
        let words = self.table.len() + self.values.len();
        let ranges = self.ranges.len() + self.majorants.ranges.len();
        (words * size_of::<u32>() + ranges * size_of::<[f32; 2]>()) as u64
    }

    /// The field at a point of the grid's lattice, as a device finds it.
    pub fn sample(&self, point: DVec3) -> f32 {
        let p = point - self.origin.as_dvec3();
        let [low, high] = self.clip;
        if p.cmplt(low).any() || p.cmpgt(high).any() {
            return 0.0;
        }
        let cell = p.floor().as_uvec3();
        let cell = cell.min(UVec3::from_array(self.cells) - 1);
        let fraction = (p - cell.as_dvec3()).as_vec3();
        let brick = cell / BRICK_SIDE;
        let [nx, ny, _] = self.bricks;
        let index =
            brick.x as usize + nx as usize * (brick.y as usize + ny as usize * brick.z as usize);
        let slot = self.table[index];
        if slot == EMPTY_BRICK {
            return 0.0;
        }
        let first = cell % BRICK_SIDE;
        let at = |corner: UVec3| self.stored(slot, first + corner);
        let mix = |a: f32, b: f32, t: f32| a + (b - a) * t;
        let mut edges = [0.0; 4];
        for (i, edge) in edges.iter_mut().enumerate() {
            let corner = UVec3::new(0, i as u32 & 1, i as u32 >> 1);
            *edge = mix(at(corner), at(corner + UVec3::X), fraction.x);
        }
        let [a, b, c, d] = edges;
        mix(mix(a, b, fraction.y), mix(c, d, fraction.y), fraction.z)
    }

    /// Sample (x, y, z), each below 9, of a slot.
    fn stored(&self, slot: u32, sample: UVec3) -> f32 {
        let slot = slot as usize;
        let entry = (sample.x + APRON_SIDE * (sample.y + APRON_SIDE * sample.z)) as usize;
        let word = self.values[slot * ATLAS_BRICK_WORDS + entry / 2];
        let q = word >> (16 * (entry % 2));
        decode_sample(self.ranges[slot], (q & 0xffff) as u16)
    }
}
