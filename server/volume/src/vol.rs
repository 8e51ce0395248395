//! Mitsuba's grid volumes (`.vol`), version 3, one channel of floats or bytes.
//!
//! The header of 48 bytes is "VOL", the version, the kind of number, the voxels along x, y, z, the
//! channels, and the bounding box as six floats; x changes fastest.

use std::io::Read;

use glam::Vec3;

use crate::cursor::Cursor;
use crate::dense::Dense;
use crate::number::Number;
use crate::{Grid, VolumeError, VolumeLimits};

const HEADER_BYTES: u64 = 48;

/// Reads a volume that is held whole.
///
/// N voxels along an axis fill the box of the file, whose unit is taken as metre: voxel i is at
/// lo + (i + ½)(hi − lo)/N, and between the outermost ones and the faces the edge value holds.
/// Bytes are fractions of 255.
///
/// # Errors
/// [`VolumeError::Invalid`] where the bytes do not follow the format, [`VolumeError::Unsupported`]
/// for other versions, kinds of numbers and several channels, [`VolumeError::Limit`] before more is
/// allocated than `limits` allow.
pub fn read_bytes(bytes: &[u8], limits: &VolumeLimits) -> Result<Grid, VolumeError> {
    let length = bytes.len() as u64;
    VolumeError::within("bytes of the file", length, limits.file_bytes)?;
    read_from(&mut { bytes }, length, limits)
}

/// Reads a volume of `length` bytes.
pub(crate) fn read_from(
    source: &mut impl Read,
    length: u64,
    limits: &VolumeLimits,
) -> Result<Grid, VolumeError> {
    let mut header = Vec::new();
    source.take(HEADER_BYTES).read_to_end(&mut header)?;
    let mut header = Cursor::new(&header);
    let [v, o, l, version] = header.array("magic number")?;
    if [v, o, l] != *b"VOL" {
        let found = format!("{:?}", [v, o, l]);
        return Err(VolumeError::invalid("magic number", found, "\"VOL\""));
    }
    if version != 3 {
        let what = format!("version {version} (3 is read)");
        return Err(VolumeError::unsupported("version", what));
    }
    let (number, scale) = match header.i32("kind of number")? {
        1 => (Number::F32, 1.0),
        3 => (Number::U8, 1.0 / 255.0),
        other => {
            let what = match other {
                2 => "half floats".to_owned(),
                4 => "quantised directions".to_owned(),
                _ => format!("kind {other}"),
            };
            return Err(VolumeError::unsupported("kind of number", what));
        }
    };
    let mut size = [0; 3];
    for side in &mut size {
        *side = header.u32("size")?;
    }
    let channels = header.i32("channels")?;
    if channels != 1 {
        let what = format!("{channels} channels (1 is read)");
        return Err(VolumeError::unsupported("channels", what));
    }
    let mut corner = || -> Result<_, VolumeError> {
        let mut corner = [0.0; 3];
        for axis in &mut corner {
            *axis = header.f32("bounding box")?;
        }
        Ok(Vec3::from_array(corner).as_dvec3())
    };
    let dense = Dense {
        size,
        number,
        big_endian: false,
        scale,
        x_fastest: true,
        bounds: [corner()?, corner()?],
    };
    dense.check_length(length.saturating_sub(HEADER_BYTES))?;
    dense.read(source, "", limits)
}
