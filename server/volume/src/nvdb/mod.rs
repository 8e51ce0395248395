//! NanoVDB files (`.nvdb`), version 32: float grids, plain or quantised.
//!
//! A file is a row of segments: a header, a record and a name for each grid, then each grid as one
//! buffer, stored as it is, with zlib or with blosc. From 32.6 on it may also be the bare buffers.
//! What is not a scalar float grid is refused by its type's name.

mod tree;

use std::borrow::Cow;

use crate::compression::{self, BLOSC_RATIO, ZIP_RATIO};
use crate::cursor::Cursor;
use crate::select::{Candidate, choose};
use crate::{Grid, ReadOptions, VolumeError, VolumeLimits};

/// "NanoVDB" and a digit for what it begins: 0 a file or a grid, 1 a grid, 2 a file.
const MAGIC: u64 = 0x0042_4456_6f6e_614e;
const MAJOR: u32 = 32;
/// Bytes of a grid's name in its own header.
const NAME_BYTES: usize = 256;
/// Uncompressed bytes of one of blosc's chunks.
const CHUNK_BYTES: usize = 1 << 30;

const TYPES: [&str; 27] = [
    "unknown",
    "float",
    "double",
    "int16",
    "int32",
    "int64",
    "vec3f",
    "vec3d",
    "mask",
    "half",
    "uint32",
    "bool",
    "rgba8",
    "fp4",
    "fp8",
    "fp16",
    "fpN",
    "vec4f",
    "vec4d",
    "index",
    "onindex",
    "indexmask",
    "onindexmask",
    "pointindex",
    "vec3u8",
    "vec3u16",
    "uint8",
];

/// How the leaves hold their values.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    Float,
    /// A minimum, a quantum and as many of it as this many bits say.
    Quantised(u32),
    /// The same with as many bits as each leaf needs.
    Variable,
}

impl Kind {
    fn new(number: u32) -> Option<Self> {
        match number {
            1 => Some(Self::Float),
            13 => Some(Self::Quantised(4)),
            14 => Some(Self::Quantised(8)),
            15 => Some(Self::Quantised(16)),
            16 => Some(Self::Variable),
            _ => None,
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Codec {
    None,
    Zip,
    Blosc,
}

/// A grid of the file.
#[derive(Debug)]
struct Entry {
    name: String,
    /// Number of its type.
    kind: u32,
    codec: Codec,
    /// Where its data begins.
    start: usize,
    /// Length of its data in the file. Unit: byte.
    stored: usize,
    /// Length of its buffer. Unit: byte.
    size: u64,
}

/// Reads a grid of a NanoVDB file that is held whole.
///
/// The grid is `options.grid`, else the one named "density", else the first of floats; of several
/// with one name, `density[1]` is the second. The field is as that of an OpenVDB file.
///
/// # Errors
/// [`VolumeError::Invalid`] where the bytes do not follow the format, an offset leaves the buffer or
/// no grid has the name, [`VolumeError::Unsupported`] for other kinds of grids and a background
/// other than 0, [`VolumeError::Limit`] before more is allocated than `limits` allow: the buffer of
/// a compressed grid and the grid each count against the bytes of a grid.
pub fn read_bytes(
    bytes: &[u8],
    options: &ReadOptions,
    limits: &VolumeLimits,
) -> Result<Grid, VolumeError> {
    VolumeError::within("bytes of the file", bytes.len() as u64, limits.file_bytes)?;
    let entries = entries(bytes)?;
    let candidates = candidates(&entries);
    let index = choose(&candidates, options.grid.as_deref())?;
    let entry = &entries[index];
    let buffer = unpack(bytes, entry, limits)?;
    tree::read(&buffer, &entry.name, limits)
}

fn candidates(entries: &[Entry]) -> Vec<Candidate> {
    let mut counts = std::collections::HashMap::<&str, (usize, usize)>::new();
    for entry in entries {
        counts.entry(&entry.name).or_default().1 += 1;
    }
    entries
        .iter()
        .map(|entry| {
            let mut address = entry.name.clone();
            if let Some((number, count)) = counts.get_mut(entry.name.as_str()) {
                if *count > 1 {
                    address = format!("{address}[{number}]");
                }
                *number += 1;
            }
            let obstacle = match Kind::new(entry.kind) {
                Some(_) => None,
                None => Some(format!("a grid of type {}", type_name(entry.kind))),
            };
            Candidate {
                name: entry.name.clone(),
                address,
                obstacle,
            }
        })
        .collect()
}

fn type_name(kind: u32) -> String {
    match TYPES.get(kind as usize) {
        Some(name) => (*name).to_owned(),
        None => format!("number {kind}"),
    }
}

/// Checks a magic number; its digit.
fn magic_digit(cursor: &mut Cursor<'_>) -> Result<u8, VolumeError> {
    let magic = cursor.u64("magic number")?;
    let digit = (magic >> 56) as u8;
    if magic & 0x00ff_ffff_ffff_ffff != MAGIC || !(b'0'..=b'2').contains(&digit) {
        let found = format!("{magic:#x}");
        return Err(VolumeError::invalid(
            "magic number",
            found,
            "a NanoVDB file's",
        ));
    }
    Ok(digit - b'0')
}

fn check_version(version: u32) -> Result<(), VolumeError> {
    let [major, minor] = [version >> 21, version >> 10 & 0x7ff];
    if major == MAJOR {
        return Ok(());
    }
    let what = format!("version {major}.{minor} ({MAJOR}.x is read)");
    Err(VolumeError::unsupported("version", what))
}

fn entries(bytes: &[u8]) -> Result<Vec<Entry>, VolumeError> {
    let mut cursor = Cursor::new(bytes);
    if magic_digit(&mut cursor.clone())? == 1 {
        return bare_entries(bytes);
    }
    let mut entries = Vec::new();
    while cursor.left() > 0 {
        segment(&mut cursor, &mut entries)?;
    }
    Ok(entries)
}

/// Reads the records of a segment and steps over its grids.
fn segment(cursor: &mut Cursor<'_>, entries: &mut Vec<Entry>) -> Result<(), VolumeError> {
    magic_digit(cursor)?;
    check_version(cursor.u32("version")?)?;
    let count = cursor.u16("number of grids")?;
    let codec = match cursor.u16("codec")? {
        0 => Codec::None,
        1 => Codec::Zip,
        2 => Codec::Blosc,
        other => {
            return Err(VolumeError::unsupported("codec", format!("codec {other}")));
        }
    };
    if count == 0 {
        return Err(VolumeError::invalid("number of grids", "0", "at least 1"));
    }
    let first = entries.len();
    for _ in 0..count {
        let size = cursor.u64("grid size")?;
        let stored = cursor.u64("grid size in the file")?;
        cursor.take(16, "grid record")?;
        let kind = cursor.u32("grid type")?;
        // Class, two bounding boxes, voxel size.
        cursor.take(4 + 48 + 24 + 24, "grid record")?;
        let name_bytes = cursor.u32("grid name")?;
        // Counts of nodes and tiles, codec, version.
        cursor.take(28 + 4 + 4, "grid record")?;
        if name_bytes as usize > 1 << 16 {
            let found = format!("{name_bytes} bytes");
            return Err(VolumeError::invalid("grid name", found, "at most 65536"));
        }
        let name = cursor.take(name_bytes as usize, "grid name")?;
        entries.push(Entry {
            name: terminated(name),
            kind,
            codec,
            start: 0,
            stored: usize::try_from(stored).unwrap_or(usize::MAX),
            size,
        });
    }
    for entry in &mut entries[first..] {
        entry.start = cursor.position();
        cursor.take(entry.stored, "grid data")?;
    }
    Ok(())
}

/// Grids without segments: one buffer after the other.
fn bare_entries(bytes: &[u8]) -> Result<Vec<Entry>, VolumeError> {
    let mut entries = Vec::new();
    let mut at = 0;
    while at < bytes.len() {
        let mut cursor = Cursor::at(bytes, at as u64, "grid")?;
        magic_digit(&mut cursor)?;
        cursor.take(8, "checksum")?;
        check_version(cursor.u32("version")?)?;
        cursor.take(12, "grid header")?;
        let size = cursor.u64("grid size")?;
        let name = cursor.take(NAME_BYTES, "grid name")?;
        let mut kind = Cursor::at(bytes, (at + tree::KIND_OFFSET) as u64, "grid type")?;
        let stored = usize::try_from(size).unwrap_or(usize::MAX);
        if stored < tree::HEADER_BYTES {
            let allowed = format!("at least {}", tree::HEADER_BYTES);
            return Err(VolumeError::invalid(
                "grid size",
                format!("{size}"),
                allowed,
            ));
        }
        Cursor::at(bytes, at as u64, "grid")?.take(stored, "grid data")?;
        entries.push(Entry {
            name: terminated(name),
            kind: kind.u32("grid type")?,
            codec: Codec::None,
            start: at,
            stored,
            size,
        });
        at += stored;
    }
    Ok(entries)
}

/// The text before the first 0.
fn terminated(bytes: &[u8]) -> String {
    let end = bytes.iter().position(|byte| *byte == 0);
    String::from_utf8_lossy(&bytes[..end.unwrap_or(bytes.len())]).into_owned()
}

/// The grid's buffer, borrowed from the file where it is stored as it is.
fn unpack<'a>(
    bytes: &'a [u8],
    entry: &Entry,
    limits: &VolumeLimits,
) -> Result<Cow<'a, [u8]>, VolumeError> {
    let field = "grid data";
    let mut cursor = Cursor::at(bytes, entry.start as u64, field)?;
    let stored = cursor.take(entry.stored, field)?;
    let ratio = match entry.codec {
        Codec::None => 1,
        Codec::Zip => ZIP_RATIO,
        Codec::Blosc => BLOSC_RATIO,
    };
    if entry.size > (entry.stored as u64).saturating_mul(ratio) {
        let found = format!("{} from {}", entry.size, entry.stored);
        let allowed = format!("at most {ratio} times as many as are stored");
        return Err(VolumeError::invalid("grid size", found, allowed));
    }
    if entry.codec == Codec::None {
        return Ok(Cow::Borrowed(&stored[..entry.size as usize]));
    }
    VolumeError::within("bytes of a grid's buffer", entry.size, limits.grid_bytes)?;
    let mut buffer = vec![0; entry.size as usize];
    let mut packed = Cursor::new(stored);
    let chunk_bytes = match entry.codec {
        Codec::Blosc => CHUNK_BYTES,
        Codec::Zip | Codec::None => buffer.len().max(1),
    };
    for chunk in buffer.chunks_mut(chunk_bytes) {
        let length = usize::try_from(packed.u64(field)?).unwrap_or(usize::MAX);
        let input = packed.take(length, field)?;
        if entry.codec == Codec::Blosc {
            compression::blosc(input, chunk, field)?;
        } else {
            compression::zip(input, chunk, field)?;
        }
    }
    Ok(Cow::Owned(buffer))
}
