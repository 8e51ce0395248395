//! A sparse scalar field on a lattice.

use std::collections::HashMap;
use std::fmt;

use glam::{DAffine3, DVec3, IVec3, UVec3};

use crate::brick::voxel_index;
use crate::{BRICK_SIDE, BRICK_VOXELS, Brick, VolumeError, VolumeLimits};

/// Table entry of a brick that is all zero.
const EMPTY: u32 = u32::MAX;

/// Longest side of a lattice: lattice points are exact in single precision below it. Unit: voxel.
const MAX_SIDE: u32 = 1 << 24;

/// A sparse scalar field, finite and ≥ 0: samples at the points of a lattice, trilinear between
/// them, 0 outside `clip`.
///
/// The sample of voxel (i, j, k), each in `0..size`, lies at lattice point (i, j, k).
#[derive(Clone, PartialEq)]
pub struct Grid {
    /// Name in the file, or empty.
    pub name: String,
    /// From lattice points to where the file places them. Unit: m. Invertible.
    pub world_from_lattice: DAffine3,
    /// Low and high corner of the part of the lattice's space where the field is; 0 outside.
    /// Inside it, samples beyond the lattice count as 0.
    pub clip: [DVec3; 2],
    /// What was mended on the way in.
    pub report: VoxelReport,
    size: UVec3,
    bricks: UVec3,
    table: Vec<u32>,
    values: Vec<Brick>,
    max: f32,
}

/// In short: a grid's voxels would fill pages.
impl fmt::Debug for Grid {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter
            .debug_struct("Grid")
            .field("name", &self.name)
            .field("size", &self.size)
            .field("stored_bricks", &self.values.len())
            .field("max", &self.max)
            .field("clip", &self.clip)
            .field("report", &self.report)
            .finish_non_exhaustive()
    }
}

/// What was mended on the way in.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct VoxelReport {
    /// Voxels that were not finite; now 0.
    pub non_finite: u64,
    /// Voxels below 0; now 0.
    pub negative: u64,
}

impl Grid {
    /// Voxels along x, y, z.
    pub fn size(&self) -> UVec3 {
        self.size
    }

    /// Bricks along x, y, z, empty ones included.
    pub fn brick_counts(&self) -> UVec3 {
        self.bricks
    }

    /// Bricks that are stored. Bricks of one and the same value are stored once.
    pub fn stored_bricks(&self) -> usize {
        self.values.len()
    }

    /// Largest voxel.
    pub fn max(&self) -> f32 {
        self.max
    }

    /// Memory of table and bricks. Unit: byte.
    pub fn bytes(&self) -> u64 {
        (self.table.len() * size_of::<u32>() + self.values.len() * size_of::<Brick>()) as u64
    }

    /// Brick (x, y, z), `None` where it is empty or outside.
    pub fn brick(&self, brick: IVec3) -> Option<&Brick> {
        let index = self.table_index(brick)?;
        match self.table[index] {
            EMPTY => None,
            slot => Some(&self.values[slot as usize]),
        }
    }

    /// Index below [`Self::stored_bricks`] of brick (x, y, z), `None` where it is empty or outside.
    /// Bricks of one and the same value share an index.
    pub fn brick_slot(&self, brick: IVec3) -> Option<u32> {
        let slot = self.table[self.table_index(brick)?];
        (slot != EMPTY).then_some(slot)
    }

    /// The stored bricks, in the order of [`Self::brick_slot`].
    pub fn stored(&self) -> &[Brick] {
        &self.values
    }

    /// Voxel (i, j, k); 0 outside the lattice.
    pub fn voxel(&self, voxel: IVec3) -> f32 {
        if voxel.cmplt(IVec3::ZERO).any() || voxel.cmpge(self.size.as_ivec3()).any() {
            return 0.0;
        }
        let side = BRICK_SIDE as i32;
        self.brick(voxel / side).map_or(0.0, |brick| {
            brick[voxel_index((voxel % side).as_uvec3().to_array())]
        })
    }

    /// The trilinear field at a point of the lattice's space.
    pub fn sample(&self, point: DVec3) -> f64 {
        let [low, high] = self.clip;
        if point.cmplt(low).any() || point.cmpgt(high).any() {
            return 0.0;
        }
        let base = point.floor();
        let fraction = point - base;
        let base = base.as_ivec3();
        let mut sum = 0.0;
        for corner in 0..8 {
            let offset = IVec3::new(corner & 1, corner >> 1 & 1, corner >> 2);
            let weight: f64 = (0..3)
                .map(|i| {
                    if offset[i] == 1 {
                        fraction[i]
                    } else {
                        1.0 - fraction[i]
                    }
                })
                .product();
            sum += weight * f64::from(self.voxel(base + offset));
        }
        sum
    }

    fn table_index(&self, brick: IVec3) -> Option<usize> {
        let inside = brick.cmpge(IVec3::ZERO).all() && brick.cmplt(self.bricks.as_ivec3()).all();
        inside.then(|| {
            let b = brick.as_uvec3().as_u64vec3();
            let n = self.bricks.as_u64vec3();
            (b.x + n.x * (b.y + n.y * b.z)) as usize
        })
    }
}

/// Fills a grid brick by brick. Non-finite and negative voxels become 0 and are counted.
#[derive(Debug)]
pub struct GridBuilder {
    grid: Grid,
    limits: VolumeLimits,
    /// Slots of the bricks of one value, by the value's bits. Entries may share them.
    uniform: HashMap<u32, u32>,
}

impl GridBuilder {
    /// An empty lattice of `size` voxels, placed by the identity, clipped to its samples.
    ///
    /// # Errors
    /// [`VolumeError::Invalid`] if a side is 0, [`VolumeError::Limit`] if a side is longer than
    /// 2²⁴ voxels or the table alone is too large.
    pub fn new(size: [u32; 3], limits: &VolumeLimits) -> Result<Self, VolumeError> {
        let size = UVec3::from_array(size);
        if size.cmpeq(UVec3::ZERO).any() {
            let found = format!("{} × {} × {} voxels", size.x, size.y, size.z);
            return Err(VolumeError::invalid(
                "size",
                found,
                "at least 1 along x, y and z",
            ));
        }
        let longest = u64::from(size.max_element());
        VolumeError::within("voxels along a side", longest, u64::from(MAX_SIDE))?;
        let bricks = size.map(|side| side.div_ceil(BRICK_SIDE));
        let entries = bricks
            .to_array()
            .map(u128::from)
            .into_iter()
            .product::<u128>();
        let mut builder = Self {
            grid: Grid {
                name: String::new(),
                world_from_lattice: DAffine3::IDENTITY,
                clip: [DVec3::ZERO, size.as_dvec3() - 1.0],
                report: VoxelReport::default(),
                size,
                bricks,
                table: Vec::new(),
                values: Vec::new(),
                max: 0.0,
            },
            limits: *limits,
            uniform: HashMap::new(),
        };
        let bytes = u64::try_from(entries * size_of::<u32>() as u128).unwrap_or(u64::MAX);
        builder.check(bytes)?;
        builder.grid.table = vec![EMPTY; entries as usize];
        Ok(builder)
    }

    /// Reserves `bricks` bricks at once.
    ///
    /// # Errors
    /// [`VolumeError::Limit`] if they are too many.
    pub fn reserve(&mut self, bricks: u64) -> Result<(), VolumeError> {
        let bytes = bricks.saturating_mul(size_of::<Brick>() as u64);
        self.check(self.grid.bytes().saturating_add(bytes))?;
        self.grid.values.reserve_exact(bricks as usize);
        Ok(())
    }

    /// Sets brick (x, y, z). Voxels beyond the lattice are dropped; all zero stores nothing, and
    /// all equal is stored once.
    ///
    /// # Errors
    /// [`VolumeError::Limit`] if the bricks grow too many, [`VolumeError::Invalid`] if it lies outside.
    pub fn set_brick(&mut self, brick: UVec3, values: &Brick) -> Result<(), VolumeError> {
        let index = self.index(brick)?;
        let mut clean = [0.0; BRICK_VOXELS];
        let rest = (self.grid.size - brick * BRICK_SIDE).min(UVec3::splat(BRICK_SIDE));
        for z in 0..rest.z {
            for y in 0..rest.y {
                for x in 0..rest.x {
                    let at = voxel_index([x, y, z]);
                    clean[at] = self.clean(values[at]);
                }
            }
        }
        if clean.iter().all(|value| *value == clean[0]) {
            self.grid.table[index] = self.uniform_entry(clean[0])?;
            return Ok(());
        }
        let slot = self.grid.table[index];
        if slot == EMPTY || self.is_shared(slot) {
            self.grid.table[index] = self.push(&clean)?;
        } else {
            self.grid.values[slot as usize] = clean;
        }
        Ok(())
    }

    /// Sets every brick from `low` to below `high` to one value, which costs one stored brick in
    /// all. Each has to lie in the lattice whole.
    ///
    /// # Errors
    /// [`VolumeError::Limit`] if the brick is one too many, [`VolumeError::Invalid`] if one reaches
    /// beyond the lattice.
    pub fn set_uniform_bricks(
        &mut self,
        low: UVec3,
        high: UVec3,
        value: f32,
    ) -> Result<(), VolumeError> {
        if low.cmpge(high).any() {
            return Ok(());
        }
        if high.cmpgt(self.grid.size / BRICK_SIDE).any() {
            let found = format!("bricks {low} to {high}");
            let allowed = format!("whole bricks of {} voxels", self.grid.size);
            return Err(VolumeError::invalid("brick", found, allowed));
        }
        let voxels = (high - low).as_u64vec3().element_product() * BRICK_VOXELS as u64;
        let before = self.grid.report;
        let value = self.clean(value);
        if self.grid.report.non_finite > before.non_finite {
            self.grid.report.non_finite = before.non_finite + voxels;
        }
        if self.grid.report.negative > before.negative {
            self.grid.report.negative = before.negative + voxels;
        }
        let entry = self.uniform_entry(value)?;
        for z in low.z..high.z {
            for y in low.y..high.y {
                let first = self.index(UVec3::new(low.x, y, z))?;
                let end = first + (high.x - low.x) as usize;
                self.grid.table[first..end].fill(entry);
            }
        }
        Ok(())
    }

    /// The finished grid.
    pub fn finish(
        mut self,
        name: impl Into<String>,
        world_from_lattice: DAffine3,
        clip: [DVec3; 2],
    ) -> Grid {
        self.grid.name = name.into();
        self.grid.world_from_lattice = world_from_lattice;
        self.grid.clip = clip;
        self.grid
    }

    fn index(&self, brick: UVec3) -> Result<usize, VolumeError> {
        self.grid.table_index(brick.as_ivec3()).ok_or_else(|| {
            let found = format!("brick {brick}");
            let allowed = format!("below {}", self.grid.bricks);
            VolumeError::invalid("brick", found, allowed)
        })
    }

    /// The entry of the brick that is `value` throughout.
    fn uniform_entry(&mut self, value: f32) -> Result<u32, VolumeError> {
        if value == 0.0 {
            return Ok(EMPTY);
        }
        if let Some(slot) = self.uniform.get(&value.to_bits()) {
            return Ok(*slot);
        }
        let slot = self.push(&[value; BRICK_VOXELS])?;
        self.uniform.insert(value.to_bits(), slot);
        Ok(slot)
    }

    fn is_shared(&self, slot: u32) -> bool {
        let first = self.grid.values[slot as usize][0];
        self.uniform.get(&first.to_bits()) == Some(&slot)
    }

    fn push(&mut self, brick: &Brick) -> Result<u32, VolumeError> {
        self.check(self.grid.bytes() + size_of::<Brick>() as u64)?;
        let held = self.grid.values.len();
        if held == self.grid.values.capacity() {
            // Growth by halves, and never past the limit.
            let left = self.limits.grid_bytes - self.grid.bytes();
            let more = (held / 2 + 64).min(left as usize / size_of::<Brick>());
            self.grid.values.reserve_exact(more.max(1));
        }
        self.grid.values.push(*brick);
        Ok(held as u32)
    }

    fn clean(&mut self, value: f32) -> f32 {
        if !value.is_finite() {
            self.grid.report.non_finite += 1;
            0.0
        } else if value < 0.0 {
            self.grid.report.negative += 1;
            0.0
        } else {
            self.grid.max = self.grid.max.max(value);
            value
        }
    }

    fn check(&self, bytes: u64) -> Result<(), VolumeError> {
        VolumeError::within("bytes of voxels", bytes, self.limits.grid_bytes)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn builder() -> GridBuilder {
        GridBuilder::new([20, 16, 16], &VolumeLimits::default()).unwrap()
    }

    fn finished(builder: GridBuilder) -> Grid {
        builder.finish("", DAffine3::IDENTITY, [DVec3::ZERO; 2])
    }

    #[test]
    fn bricks_of_one_value_are_stored_once() {
        let mut builder = builder();
        builder
            .set_uniform_bricks(UVec3::ZERO, UVec3::new(2, 2, 1), 3.0)
            .unwrap();
        builder
            .set_brick(UVec3::new(1, 1, 1), &[3.0; BRICK_VOXELS])
            .unwrap();
        // A brick across the lattice's edge is not of one value: beyond the edge it is 0.
        builder
            .set_brick(UVec3::new(2, 0, 0), &[3.0; BRICK_VOXELS])
            .unwrap();
        let grid = finished(builder);
        assert_eq!(grid.stored_bricks(), 2);
        assert_eq!(grid.brick_slot(IVec3::ZERO), grid.brick_slot(IVec3::ONE));
        assert_eq!(grid.brick_slot(IVec3::new(0, 0, 1)), None);
        assert_eq!(grid.voxel(IVec3::new(19, 0, 0)), 3.0);
        assert_eq!(grid.stored()[1][4], 0.0);
    }

    #[test]
    fn setting_a_brick_anew_leaves_those_alone_that_shared_it() {
        let mut builder = builder();
        builder
            .set_uniform_bricks(UVec3::ZERO, UVec3::new(2, 1, 1), 3.0)
            .unwrap();
        let mut values = [3.0; BRICK_VOXELS];
        values[1] = 4.0;
        builder.set_brick(UVec3::ZERO, &values).unwrap();
        builder.set_brick(UVec3::ZERO, &values).unwrap();
        builder
            .set_brick(UVec3::new(1, 0, 0), &[0.0; BRICK_VOXELS])
            .unwrap();
        let grid = finished(builder);
        assert_eq!(grid.voxel(IVec3::X), 4.0);
        assert_eq!(grid.brick(IVec3::X), None);
        assert_eq!(grid.stored_bricks(), 2);
    }

    #[test]
    fn voxels_of_tiles_are_counted_where_they_are_mended() {
        let mut builder = builder();
        let two = UVec3::new(2, 1, 1);
        builder.set_uniform_bricks(UVec3::ZERO, two, -1.0).unwrap();
        builder
            .set_uniform_bricks(UVec3::ZERO, two, f32::NAN)
            .unwrap();
        let grid = finished(builder);
        assert_eq!(grid.report.negative, 1024);
        assert_eq!(grid.report.non_finite, 1024);
        assert_eq!(grid.stored_bricks(), 0);
    }

    #[test]
    fn tiles_beyond_the_whole_bricks_are_refused() {
        let mut builder = builder();
        let error = builder.set_uniform_bricks(UVec3::ZERO, UVec3::new(3, 1, 1), 1.0);
        assert!(matches!(error, Err(VolumeError::Invalid { .. })));
    }

    #[test]
    fn sides_beyond_single_precision_are_refused() {
        let error = GridBuilder::new([1 << 24 | 1, 1, 1], &VolumeLimits::default());
        assert!(matches!(error, Err(VolumeError::Limit { .. })));
    }
}
