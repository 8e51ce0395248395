//! OpenVDB files (`.vdb`), versions 222 to 225: float grids, stored whole or as half floats.
//!
//! The file is a header, its metadata, and for each grid a descriptor that says where the grid
//! begins and ends, its metadata, its transform, the topology of its tree and then the values of
//! its leaves. What is not a scalar float grid is refused by its type's name.

mod transform;
mod tree;
mod values;

use glam::DAffine3;

use crate::cursor::Cursor;
use crate::select::{Candidate, choose, shown};
use crate::{Grid, ReadOptions, VolumeError, VolumeLimits};

/// " BDV" as an integer of 8 bytes.
const MAGIC: u64 = 0x5644_4220;
/// From here on, every node says how its inactive values are stored.
const OLDEST: u32 = 222;
/// The latest version, which only adds grids of half floats.
const NEWEST: u32 = 225;
/// The kind of tree that is read: float, with nodes of 32³ and 16³ children and leaves of 8³.
const FLOAT_TREE: &str = "Tree_float_5_4_3";
const HALF_SUFFIX: &str = "_HalfFloat";
/// Between a grid's name and its number, where several have one name.
const NUMBER_SEPARATOR: char = '\u{1e}';

/// How the values of a grid are stored.
#[derive(Debug, Clone, Copy)]
struct Storage {
    packing: Packing,
    /// Only the active values of a node are stored.
    active_only: bool,
    /// As half floats.
    half: bool,
    background: f32,
}

/// How a block of values is compressed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Packing {
    None,
    Zip,
    Blosc,
}

/// Where a grid is in the file.
#[derive(Debug)]
struct Descriptor {
    unique_name: String,
    kind: String,
    /// The grid whose tree this one shares, or empty.
    instance_of: String,
    start: u64,
}

impl Descriptor {
    fn candidate(&self) -> Candidate {
        let (name, address) = match self.unique_name.split_once(NUMBER_SEPARATOR) {
            None => (self.unique_name.clone(), self.unique_name.clone()),
            Some((name, number)) => (name.to_owned(), format!("{name}[{number}]")),
        };
        let kind = self.kind.strip_suffix(HALF_SUFFIX).unwrap_or(&self.kind);
        let obstacle = if kind == FLOAT_TREE {
            None
        } else {
            Some(format!("a grid of type {}", shown(&self.kind)))
        };
        Candidate {
            name,
            address,
            obstacle,
        }
    }
}

/// Reads a grid of an OpenVDB file that is held whole.
///
/// The grid is `options.grid`, else the one named "density", else the first of floats; of several
/// with one name, `density[1]` is the second. Voxel (i, j, k) of the file has its sample at index
/// space (i, j, k). The field has the stored values inside the bounding box of the active voxels
/// and is 0 outside; the lattice transform includes the shift to the lattice's first voxel.
///
/// # Errors
/// [`VolumeError::Invalid`] where the bytes do not follow the format or no grid has the name,
/// [`VolumeError::Unsupported`] for other kinds of grids, perspective transforms, and a background
/// other than 0, which would fill all space; [`VolumeError::Limit`] before more is allocated than
/// `limits` allow.
pub fn read_bytes(
    bytes: &[u8],
    options: &ReadOptions,
    limits: &VolumeLimits,
) -> Result<Grid, VolumeError> {
    VolumeError::within("bytes of the file", bytes.len() as u64, limits.file_bytes)?;
    let grids = descriptors(bytes)?;
    let candidates: Vec<Candidate> = grids.iter().map(Descriptor::candidate).collect();
    let index = choose(&candidates, options.grid.as_deref())?;
    let chosen = &grids[index];
    let mut cursor = Cursor::at(bytes, chosen.start, "grid offset")?;
    let mut flags = cursor.u32("compression")?;
    skip_metadata(&mut cursor)?;
    let world_from_index = transform::read(&mut cursor)?;
    let mut kind = &chosen.kind;
    if !chosen.instance_of.is_empty() {
        let owner = owner(&grids, chosen)?;
        cursor = Cursor::at(bytes, owner.start, "grid offset")?;
        flags = cursor.u32("compression")?;
        skip_metadata(&mut cursor)?;
        transform::read(&mut cursor)?;
        kind = &owner.kind;
    }
    let half = kind.ends_with(HALF_SUFFIX);
    let candidate = &candidates[index];
    read_tree(
        &mut cursor,
        flags,
        half,
        world_from_index,
        &candidate.name,
        limits,
    )
}

/// The grid whose tree `instance` shares; it may not be an instance itself.
fn owner<'a>(
    grids: &'a [Descriptor],
    instance: &Descriptor,
) -> Result<&'a Descriptor, VolumeError> {
    grids
        .iter()
        .find(|grid| grid.unique_name == instance.instance_of && grid.instance_of.is_empty())
        .filter(|grid| grid.candidate().obstacle.is_none())
        .ok_or_else(|| {
            VolumeError::invalid(
                "grid instance",
                format!("a share in the tree of {}", shown(&instance.instance_of)),
                "the name of a float grid of the file that has a tree",
            )
        })
}

fn read_tree(
    cursor: &mut Cursor<'_>,
    flags: u32,
    half: bool,
    world_from_index: DAffine3,
    name: &str,
    limits: &VolumeLimits,
) -> Result<Grid, VolumeError> {
    if flags & !7 != 0 {
        let what = format!("compression {flags:#x}");
        return Err(VolumeError::unsupported("compression", what));
    }
    let buffers = cursor.i32("buffers of a tree")?;
    if buffers != 1 {
        let what = format!("a tree of {buffers} buffers");
        return Err(VolumeError::unsupported("buffers of a tree", what));
    }
    let background = cursor.f32("background")?;
    if background != 0.0 {
        let what = format!("{background} (a level set?), which would fill all space, for fog");
        return Err(VolumeError::unsupported(
            format!("background of grid {}", shown(name)),
            what,
        ));
    }
    let storage = Storage {
        packing: match (flags & 4 != 0, flags & 1 != 0) {
            (true, _) => Packing::Blosc,
            (false, true) => Packing::Zip,
            (false, false) => Packing::None,
        },
        active_only: flags & 2 != 0,
        half,
        background,
    };
    let tree = tree::read_topology(cursor, storage, limits)?;
    let mut values = values::ValueReader::new(storage);
    tree.into_grid(name, world_from_index, limits, |_, leaf| {
        let mask: [u8; 64] = cursor.array("leaf")?;
        values.read(cursor, &mask, leaf, "leaf values")
    })
}

/// The descriptors of all grids; of a file without offsets, of the first.
fn descriptors(bytes: &[u8]) -> Result<Vec<Descriptor>, VolumeError> {
    let mut cursor = Cursor::new(bytes);
    let magic = cursor.u64("magic number")?;
    if magic != MAGIC {
        let found = format!("{magic:#x}");
        return Err(VolumeError::invalid(
            "magic number",
            found,
            "an OpenVDB file's",
        ));
    }
    let version = cursor.u32("file version")?;
    if !(OLDEST..=NEWEST).contains(&version) {
        let what = format!("version {version} ({OLDEST} to {NEWEST} are read)");
        return Err(VolumeError::unsupported("file version", what));
    }
    cursor.take(8, "library version")?;
    let has_offsets = cursor.u8("grid offsets")? != 0;
    cursor.take(36, "identifier")?;
    skip_metadata(&mut cursor)?;
    let count = cursor.i32("number of grids")?;
    let mut grids = Vec::new();
    for _ in 0..count {
        let unique_name = cursor.text("grid name")?;
        let kind = cursor.text("grid type")?;
        let instance_of = cursor.text("grid instance")?;
        let start = cursor.u64("grid offset")?;
        cursor.u64("block offset")?;
        let end = cursor.u64("end offset")?;
        let here = cursor.position() as u64;
        if !has_offsets {
            // The next descriptor comes after a tree whose length is known only once it is read.
            grids.push(Descriptor {
                unique_name,
                kind,
                instance_of,
                start: here,
            });
            return Ok(grids);
        }
        if start < here || end <= start {
            return Err(VolumeError::invalid(
                "grid offset",
                format!("from {start} to {end}"),
                format!("ascending, from {here} on"),
            ));
        }
        cursor = Cursor::at(bytes, end, "end offset")?;
        grids.push(Descriptor {
            unique_name,
            kind,
            instance_of,
            start,
        });
    }
    Ok(grids)
}

fn skip_metadata(cursor: &mut Cursor<'_>) -> Result<(), VolumeError> {
    for _ in 0..cursor.u32("metadata")? {
        cursor.text("metadata name")?;
        cursor.text("metadata type")?;
        let size = cursor.u32("metadata value")?;
        cursor.take(size as usize, "metadata value")?;
    }
    Ok(())
}
