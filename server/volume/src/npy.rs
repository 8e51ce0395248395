//! Arrays of numpy (`.npy`), versions 1 to 3: three axes, numbers of all plain kinds.

use std::io::Read;

use glam::DVec3;

use crate::dense::{Dense, Number};
use crate::select::shown;
use crate::{Grid, ReadOptions, VolumeError, VolumeLimits, file};

const MAGIC: [u8; 6] = *b"\x93NUMPY";
/// Longest header. Unit: byte.
const MAX_HEADER: u32 = 1 << 16;

/// Reads an array that is held whole.
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
    read_from(&mut { bytes }, Some(length), "", limits)
}

/// Reads an array of `length` bytes, if that is known.
pub(crate) fn read_from(
    source: &mut impl Read,
    length: Option<u64>,
    name: &str,
    limits: &VolumeLimits,
) -> Result<Grid, VolumeError> {
    let mut start = [0; 8];
    fill(source, &mut start)?;
    if start[..6] != MAGIC {
        let found = shown(&String::from_utf8_lossy(&start[..6]));
        return Err(VolumeError::invalid(
            "magic number",
            found,
            "a numpy array's",
        ));
    }
    let (header_bytes, start_bytes) = match start[6] {
        1 => {
            let mut bytes = [0; 2];
            fill(source, &mut bytes)?;
            (u32::from(u16::from_le_bytes(bytes)), 10)
        }
        2 | 3 => {
            let mut bytes = [0; 4];
            fill(source, &mut bytes)?;
            (u32::from_le_bytes(bytes), 12)
        }
        other => {
            let what = format!("version {other} (1 to 3 are read)");
            return Err(VolumeError::unsupported("version", what));
        }
    };
    if header_bytes > MAX_HEADER {
        let found = format!("{header_bytes} bytes");
        return Err(VolumeError::invalid(
            "header",
            found,
            format!("at most {MAX_HEADER}"),
        ));
    }
    let mut header = vec![0; header_bytes as usize];
    fill(source, &mut header)?;
    let dense = parse(&String::from_utf8_lossy(&header))?;
    if let Some(length) = length {
        dense.check_length(length.saturating_sub(u64::from(header_bytes) + start_bytes))?;
    }
    dense.read(source, name, limits)
}

fn fill(source: &mut impl Read, bytes: &mut [u8]) -> Result<(), VolumeError> {
    let length = bytes.len();
    source
        .read_exact(bytes)
        .map_err(|error| match error.kind() {
            std::io::ErrorKind::UnexpectedEof => {
                let allowed = format!("{length} bytes more");
                VolumeError::invalid("header", "the end of the data", allowed)
            }
            _ => error.into(),
        })
}

/// The header: a dictionary as Python writes it.
fn parse(header: &str) -> Result<Dense, VolumeError> {
    let kind = after(header, "descr")?;
    let kind = kind
        .strip_prefix(['\'', '"'])
        .and_then(|kind| kind.split(['\'', '"']).next())
        .ok_or_else(|| VolumeError::unsupported("descr", "an array of records"))?;
    let (number, big_endian) = number(kind)?;
    let fortran = after(header, "fortran_order")?.starts_with("True");
    let shape = after(header, "shape")?;
    let sides: Option<Vec<u32>> = shape
        .strip_prefix('(')
        .and_then(|shape| shape.split_once(')'))
        .map(|(shape, _)| shape.split(',').map(str::trim))
        .and_then(|sides| {
            let sides = sides.filter(|side| !side.is_empty());
            sides.map(|side| side.parse().ok()).collect()
        });
    let Some([z, y, x]) = sides.as_deref() else {
        let cut = shape.split('}').next().unwrap_or(shape);
        return Err(VolumeError::invalid(
            "shape",
            shown(cut),
            "three axes: (z, y, x)",
        ));
    };
    Ok(Dense {
        size: [*x, *y, *z],
        number,
        big_endian,
        scale: 1.0,
        x_fastest: !fortran,
        bounds: [DVec3::ZERO, DVec3::ONE],
    })
}

/// What stands after a key of the dictionary.
fn after<'a>(header: &'a str, key: &str) -> Result<&'a str, VolumeError> {
    ["'", "\""]
        .iter()
        .find_map(|quote| header.split_once(&format!("{quote}{key}{quote}:")))
        .map(|(_, value)| value.trim_start())
        .ok_or_else(|| VolumeError::invalid("header", shown(header), format!("a key {key:?}")))
}

fn number(kind: &str) -> Result<(Number, bool), VolumeError> {
    let (big_endian, plain) = match kind.split_at_checked(1) {
        Some((">", plain)) => (true, plain),
        Some(("<" | "|", plain)) => (false, plain),
        _ => (false, kind),
    };
    let number = match plain {
        "f2" => Number::F16,
        "f4" => Number::F32,
        "f8" => Number::F64,
        "u1" | "b1" => Number::U8,
        "u2" => Number::U16,
        "u4" => Number::U32,
        "u8" => Number::U64,
        "i1" => Number::I8,
        "i2" => Number::I16,
        "i4" => Number::I32,
        "i8" => Number::I64,
        _ => {
            let what = format!("an array of {}", shown(kind));
            return Err(VolumeError::unsupported("descr", what));
        }
    };
    Ok((number, big_endian))
}
