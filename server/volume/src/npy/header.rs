//! What stands in front of an array's numbers: magic, version, and a dictionary as Python writes it.

use std::io::{ErrorKind, Read};

use crate::VolumeError;
use crate::number::Number;
use crate::select::shown;

const MAGIC: [u8; 6] = *b"\x93NUMPY";
/// Longest dictionary. Unit: byte.
const MAX_DICTIONARY: u32 = 1 << 16;

/// What an array's header says.
#[derive(Debug)]
pub(super) struct Header {
    /// Numbers along each axis.
    pub(super) shape: [u32; 3],
    /// How each number is stored.
    pub(super) number: Number,
    pub(super) big_endian: bool,
    /// The first index changes fastest, not the last.
    pub(super) fortran_order: bool,
    /// Where the numbers start. Unit: byte.
    pub(super) length: u64,
}

impl Header {
    /// Reads all that stands in front of the numbers. `axes` names the three axes in errors.
    pub(super) fn read(source: &mut impl Read, axes: &str) -> Result<Self, VolumeError> {
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
        let (dictionary_bytes, start_bytes) = match start[6] {
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
        if dictionary_bytes > MAX_DICTIONARY {
            let found = format!("{dictionary_bytes} bytes");
            let allowed = format!("at most {MAX_DICTIONARY}");
            return Err(VolumeError::invalid("header", found, allowed));
        }
        let mut dictionary = vec![0; dictionary_bytes as usize];
        fill(source, &mut dictionary)?;
        let dictionary = String::from_utf8_lossy(&dictionary);
        let (number, big_endian) = number(&dictionary)?;
        Ok(Self {
            fortran_order: after(&dictionary, "fortran_order")?.starts_with("True"),
            shape: shape(&dictionary, axes)?,
            number,
            big_endian,
            length: start_bytes + u64::from(dictionary_bytes),
        })
    }
}

fn fill(source: &mut impl Read, bytes: &mut [u8]) -> Result<(), VolumeError> {
    let length = bytes.len();
    source
        .read_exact(bytes)
        .map_err(|error| match error.kind() {
            ErrorKind::UnexpectedEof => {
                let allowed = format!("{length} bytes more");
                VolumeError::invalid("header", "the end of the data", allowed)
            }
            _ => error.into(),
        })
}

/// What stands after a key of the dictionary.
fn after<'a>(dictionary: &'a str, key: &str) -> Result<&'a str, VolumeError> {
    ["'", "\""]
        .iter()
        .find_map(|quote| dictionary.split_once(&format!("{quote}{key}{quote}:")))
        .map(|(_, value)| value.trim_start())
        .ok_or_else(|| VolumeError::invalid("header", shown(dictionary), format!("a key {key:?}")))
}

fn shape(dictionary: &str, axes: &str) -> Result<[u32; 3], VolumeError> {
    let shape = after(dictionary, "shape")?;
    let sides: Option<Vec<u32>> = shape
        .strip_prefix('(')
        .and_then(|shape| shape.split_once(')'))
        .map(|(shape, _)| shape.split(',').map(str::trim))
        .and_then(|sides| {
            let sides = sides.filter(|side| !side.is_empty());
            sides.map(|side| side.parse().ok()).collect()
        });
    sides
        .and_then(|sides| sides.try_into().ok())
        .ok_or_else(|| {
            let found = shape.split('}').next().unwrap_or(shape);
            VolumeError::invalid("shape", shown(found), format!("three axes: {axes}"))
        })
}

/// How each number is stored, and whether its first byte is its highest.
fn number(dictionary: &str) -> Result<(Number, bool), VolumeError> {
    let kind = after(dictionary, "descr")?
        .strip_prefix(['\'', '"'])
        .and_then(|kind| kind.split(['\'', '"']).next())
        .ok_or_else(|| VolumeError::unsupported("descr", "an array of records"))?;
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
