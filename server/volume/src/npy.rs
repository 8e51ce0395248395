//! Arrays of numpy (`.npy`), versions 1 to 3, with three axes: as a grid, or as plain numbers.
//!
//! This is the only reader of the format here. The crates npyz and ndarray-npy parse the header as any
//! Python expression with `py_literal`, whose grammar tries the inside of a bracket that is not closed
//! again and again: its steps multiply with every nested bracket, so that a short hostile header would
//! keep it busy without end. And npyz allocates what the header's length says, up to 4 GiB, before it
//! reads.

mod array;
mod header;

use std::io::Read;

use glam::DVec3;

use crate::dense::Dense;
use crate::{Grid, ReadOptions, VolumeError, VolumeLimits, file};

pub use array::Array;
use header::Header;

/// Reads an array that is held whole as a grid.
///
/// The array is indexed \[z\]\[y\]\[x\] and fills the unit cube, one cell a number: N numbers along
/// an axis are at (i + ½)/N. The values are the numbers as they stand, integers too; true is 1.
///
/// # Errors
/// [`VolumeError::Invalid`] where the bytes do not follow the format or the array has not three
/// axes, [`VolumeError::Unsupported`] for other kinds of numbers, [`VolumeError::Limit`] before more
/// is allocated than `limits` allow.
pub fn read_bytes(
    bytes: &[u8],
    options: &ReadOptions,
    limits: &VolumeLimits,
) -> Result<Grid, VolumeError> {
    let length = bytes.len() as u64;
    VolumeError::within("bytes of the file", length, limits.file_bytes)?;
    file::refuse_name(options)?;
    read_from(&mut { bytes }, length, "", limits)
}

/// Reads an array of `length` bytes, its header included, as a grid.
pub(crate) fn read_from(
    source: &mut impl Read,
    length: u64,
    name: &str,
    limits: &VolumeLimits,
) -> Result<Grid, VolumeError> {
    let header = Header::read(source, "(z, y, x)")?;
    let [z, y, x] = header.shape;
    let dense = Dense {
        size: [x, y, z],
        number: header.number,
        big_endian: header.big_endian,
        scale: 1.0,
        x_fastest: !header.fortran_order,
        bounds: [DVec3::ZERO, DVec3::ONE],
    };
    dense.check_length(length.saturating_sub(header.length))?;
    dense.read(source, name, limits)
}
