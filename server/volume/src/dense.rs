//! Grids whose voxels are all stored, one after the other: read a few slices at a time.

use std::io::{ErrorKind, Read};

use glam::{DVec3, UVec3};

use crate::brick::voxel_index;
use crate::number::Number;
use crate::{BRICK_SIDE, BRICK_VOXELS, Grid, GridBuilder, VolumeError, VolumeLimits, placement};

/// What a dense grid is.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Dense {
    /// Voxels along x, y, z.
    pub(crate) size: [u32; 3],
    pub(crate) number: Number,
    pub(crate) big_endian: bool,
    /// The voxel is the number times this.
    pub(crate) scale: f32,
    /// x changes fastest, then y; otherwise z fastest, then y.
    pub(crate) x_fastest: bool,
    /// The box that the voxels' cells fill. Unit: m.
    pub(crate) bounds: [DVec3; 2],
}

impl Dense {
    /// Length of the voxels, if it can be counted. Unit: byte.
    pub(crate) fn bytes(&self) -> u128 {
        let voxels: u128 = self.size.map(u128::from).into_iter().product();
        voxels.saturating_mul(self.number.bytes() as u128)
    }

    /// Refuses a size that does not fill the `left` bytes that are there.
    pub(crate) fn check_length(&self, left: u64) -> Result<(), VolumeError> {
        let bytes = self.bytes();
        if bytes != u128::from(left) {
            let [x, y, z] = self.size;
            let found = format!("{left} bytes");
            let allowed = format!("{bytes} bytes for {x} × {y} × {z} voxels");
            return Err(VolumeError::invalid("voxels", found, allowed));
        }
        Ok(())
    }

    /// Reads the voxels. The lattice has one copy of the edge voxels on each side, so that the
    /// field holds the edge's value up to the faces of the box.
    ///
    /// Holds 8 slices besides the grid, which count against the limit too.
    pub(crate) fn read(
        &self,
        source: &mut impl Read,
        name: &str,
        limits: &VolumeLimits,
    ) -> Result<Grid, VolumeError> {
        let (transform, clip) =
            placement::cells_in_box(self.size.map(|side| side.max(1)), self.bounds)?;
        let size = UVec3::from_array(self.size);
        if size.cmpeq(UVec3::ZERO).any() {
            let found = format!("{} × {} × {} voxels", size.x, size.y, size.z);
            return Err(VolumeError::invalid(
                "size",
                found,
                "at least 1 along x, y and z",
            ));
        }
        let mut builder =
            GridBuilder::new(size.saturating_add(UVec3::splat(2)).to_array(), limits)?;
        // Axes by how fast they change.
        let axes = if self.x_fastest { [0, 1, 2] } else { [2, 1, 0] };
        let [fast, middle, slow] = axes.map(|axis| self.size[axis]);
        let slice_voxels = u64::from(fast) * u64::from(middle);
        let held = slice_voxels.saturating_mul((8 * size_of::<f32>() + self.number.bytes()) as u64);
        VolumeError::within("bytes of slices", held, limits.grid_bytes)?;
        let mut slab = Slab {
            dense: self,
            fast: fast as usize,
            slices: vec![0.0; 8 * slice_voxels as usize],
            bytes: vec![0; slice_voxels as usize * self.number.bytes()],
            is_zero: [true; 8],
        };
        let slabs = (slow + 2).div_ceil(BRICK_SIDE);
        let mut next = 0;
        for index in 0..slabs {
            for slot in 0..BRICK_SIDE {
                // Lattice slice l is the file's slice l − 1, the outermost twice.
                let lattice = index * BRICK_SIDE + slot;
                if lattice > slow + 1 {
                    break;
                }
                if next < slow && next < lattice.max(1) {
                    slab.read(source, slot as usize)?;
                    next += 1;
                } else {
                    slab.repeat(slot as usize);
                }
            }
            if slab.is_zero.iter().all(|is_zero| *is_zero) {
                // Bricks that are not set are empty.
                continue;
            }
            let counts = [fast, middle].map(|side| (side + 2).div_ceil(BRICK_SIDE));
            for m in 0..counts[1] {
                for f in 0..counts[0] {
                    let mut brick = [0; 3];
                    for (axis, at) in axes.into_iter().zip([f, m, index]) {
                        brick[axis] = at;
                    }
                    let values = slab.brick(axes, [f, m], [fast, middle]);
                    builder.set_brick(UVec3::from_array(brick), &values)?;
                }
            }
        }
        Ok(builder.finish(name, transform, clip))
    }
}

/// Eight slices of the lattice.
struct Slab<'a> {
    dense: &'a Dense,
    /// Voxels of a row.
    fast: usize,
    slices: Vec<f32>,
    bytes: Vec<u8>,
    /// Which of the slices are 0 throughout.
    is_zero: [bool; 8],
}

impl Slab<'_> {
    fn slice_voxels(&self) -> usize {
        self.slices.len() / 8
    }

    /// Reads the next slice of the file into a slot.
    fn read(&mut self, source: &mut impl Read, slot: usize) -> Result<(), VolumeError> {
        let length = self.bytes.len();
        source
            .read_exact(&mut self.bytes)
            .map_err(|error| match error.kind() {
                ErrorKind::UnexpectedEof => VolumeError::invalid(
                    "voxels",
                    "the end of the data",
                    format!("slices of {length} bytes"),
                ),
                _ => error.into(),
            })?;
        let voxels = self.slice_voxels();
        // No byte set is 0 in every kind of number.
        let is_zero = self.bytes.iter().all(|byte| *byte == 0);
        let was_zero = std::mem::replace(&mut self.is_zero[slot], is_zero);
        if is_zero && was_zero {
            return Ok(());
        }
        let Dense {
            number,
            big_endian,
            scale,
            ..
        } = *self.dense;
        let values = &mut self.slices[slot * voxels..(slot + 1) * voxels];
        for (value, number) in values
            .iter_mut()
            .zip(number.decode(big_endian, &self.bytes))
        {
            *value = number * scale;
        }
        Ok(())
    }

    /// Copies the slice before into a slot; the slice before slot 0 is the last one.
    fn repeat(&mut self, slot: usize) {
        let voxels = self.slice_voxels();
        let from = (slot + 7) % 8 * voxels;
        self.is_zero[slot] = self.is_zero[(slot + 7) % 8];
        self.slices.copy_within(from..from + voxels, slot * voxels);
    }

    /// The brick at (fast, middle) of the slab.
    fn brick(&self, axes: [usize; 3], at: [u32; 2], size: [u32; 2]) -> [f32; BRICK_VOXELS] {
        let mut values = [0.0; BRICK_VOXELS];
        let clamped = |at: u32, local: u32, size: u32| {
            (at * BRICK_SIDE + local).saturating_sub(1).min(size - 1) as usize
        };
        for slot in 0..BRICK_SIDE {
            for m in 0..BRICK_SIDE {
                let row =
                    slot as usize * self.slice_voxels() + clamped(at[1], m, size[1]) * self.fast;
                for f in 0..BRICK_SIDE {
                    let mut voxel = [0; 3];
                    for (axis, local) in axes.into_iter().zip([f, m, slot]) {
                        voxel[axis] = local;
                    }
                    values[voxel_index(voxel)] = self.slices[row + clamped(at[0], f, size[0])];
                }
            }
        }
        values
    }
}
