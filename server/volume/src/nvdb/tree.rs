//! A grid's buffer: headers, then nodes that point at one another by offsets.
//!
//! Offsets are bytes from the node that has them. Every one is checked, and the nodes that are
//! visited may in sum not be larger than the buffer: so no node can be visited again and again.

use std::collections::HashSet;

use glam::{DAffine3, DMat3, DVec3};

use super::{Kind, check_version, magic_digit, type_name};
use crate::cursor::Cursor;
use crate::placement;
use crate::select::shown;
use crate::sparse::{LeafValues, SparseTree, bit, child_origin, leaf_mask, set_bits};
use crate::{Grid, VolumeError, VolumeLimits};

/// Length of the headers of grid and tree. Unit: byte.
pub(super) const HEADER_BYTES: usize = TREE + 64;
/// Where a grid's header has its type.
pub(super) const KIND_OFFSET: usize = 636;
const VERSION: usize = 16;
/// Where the map in double precision has its matrix, row by row, and its translation.
const MATRIX: usize = 296 + 88;
const TRANSLATION: usize = 296 + 232;
const TREE: usize = 672;
/// In the tree's header, the offset of the root.
const ROOT: usize = TREE + 24;

const ROOT_BYTES: u64 = 64;
const ROOT_TILE_BYTES: u64 = 32;
const ROOT_SIDE: u16 = 4096;
const LEAF_MASK: u64 = 16;
const LEAF_VALUES: u64 = 96;
/// In a quantised leaf, its minimum and quantum.
const LEAF_MINIMUM: u64 = 80;
/// In a leaf, flags: the upper three bits say how many bits its values have, as a power of two.
const LEAF_FLAGS: u64 = 15;

/// A level of nodes that have children.
struct Level {
    /// Children along an edge, as a power of two.
    log2: u32,
    /// Side of a child. Unit: voxel.
    child_side: u16,
    /// Length of a node. Unit: byte.
    bytes: u64,
    /// Where its table of tiles and children begins, 8 bytes each.
    table: u64,
    field: &'static str,
}

/// Where a node has its masks: the active tiles, then the children.
const MASKS: u64 = 32;

const UPPER: Level = Level {
    log2: 5,
    child_side: 128,
    bytes: 270_400,
    table: 8256,
    field: "node of 4096³ voxels",
};
const LOWER: Level = Level {
    log2: 4,
    child_side: 8,
    bytes: 33_856,
    table: 1088,
    field: "node of 128³ voxels",
};

/// Reads the grid of a buffer.
pub(super) fn read(buffer: &[u8], name: &str, limits: &VolumeLimits) -> Result<Grid, VolumeError> {
    let mut header = Cursor::new(buffer);
    magic_digit(&mut header)?;
    check_version(at(buffer, VERSION)?.u32("version")?)?;
    let number = at(buffer, KIND_OFFSET)?.u32("grid type")?;
    let Some(kind) = Kind::new(number) else {
        let what = format!("a grid of type {}", type_name(number));
        return Err(VolumeError::unsupported("grid type", what));
    };
    let transform = transform(buffer)?;
    let offset = at(buffer, ROOT)?.i64("root offset")?;
    let root = place(buffer, TREE as u64, offset, ROOT_BYTES, "root offset")?;
    let mut visit = Visit {
        buffer,
        kind,
        left: buffer.len() as u64,
        tree: SparseTree::new(limits),
    };
    visit.root(root, name)?;
    visit
        .tree
        .into_grid(name, transform, limits, |leaf, values| {
            read_leaf(buffer, kind, leaf.source, values)
        })
}

fn at(buffer: &[u8], offset: usize) -> Result<Cursor<'_>, VolumeError> {
    Cursor::at(buffer, offset as u64, "grid header")
}

fn transform(buffer: &[u8]) -> Result<DAffine3, VolumeError> {
    let field = "transform";
    let rows: [f64; 9] = at(buffer, MATRIX)?.f64s(field)?;
    let translation: [f64; 3] = at(buffer, TRANSLATION)?.f64s(field)?;
    let map = DAffine3 {
        matrix3: DMat3::from_cols_array(&rows).transpose(),
        translation: DVec3::from_array(translation),
    };
    placement::checked(map, field)
}

/// The place `offset` bytes from `node`, if `bytes` bytes are there.
fn place(
    buffer: &[u8],
    node: u64,
    offset: i64,
    bytes: u64,
    field: &str,
) -> Result<u64, VolumeError> {
    node.checked_add_signed(offset)
        .filter(|place| {
            place
                .checked_add(bytes)
                .is_some_and(|end| end <= buffer.len() as u64)
        })
        .ok_or_else(|| {
            let found = format!("{offset} bytes from {node}");
            let allowed = format!("{bytes} bytes within {}", buffer.len());
            VolumeError::invalid(field, found, allowed)
        })
}

struct Visit<'a> {
    buffer: &'a [u8],
    kind: Kind,
    /// Bytes that the nodes to come may have in sum.
    left: u64,
    tree: SparseTree,
}

impl<'a> Visit<'a> {
    fn cursor(&self, at: u64, field: &str) -> Result<Cursor<'a>, VolumeError> {
        Cursor::at(self.buffer, at, field)
    }

    /// The place of a child, which has not been visited before.
    fn child(
        &mut self,
        node: u64,
        offset: i64,
        bytes: u64,
        field: &str,
    ) -> Result<u64, VolumeError> {
        let place = place(self.buffer, node, offset, bytes, field)?;
        self.left = self
            .left
            .checked_sub(bytes)
            .ok_or_else(|| VolumeError::invalid(field, "nodes that are visited twice", "a tree"))?;
        Ok(place)
    }

    fn root(&mut self, root: u64, name: &str) -> Result<(), VolumeError> {
        let mut header = self.cursor(root + 24, "root")?;
        let tiles = header.u32("root")?;
        let background = header.f32("background")?;
        if background != 0.0 {
            let what = format!("{background} (a level set?), which would fill all space, for fog");
            return Err(VolumeError::unsupported(
                format!("background of grid {}", shown(name)),
                what,
            ));
        }
        let mut seen = HashSet::new();
        for tile in 0..u64::from(tiles) {
            let mut tile = self.cursor(root + ROOT_BYTES + ROOT_TILE_BYTES * tile, "root tile")?;
            let key = tile.u64("root tile")?;
            let child = tile.i64("root tile")?;
            let active = tile.u32("root tile")? != 0;
            let value = tile.f32("root tile")?;
            // 21 bits an axis, of which the upper 20 of the 32 of a coordinate are used.
            let axis = |shift: u32| ((key >> shift & 0xf_ffff) as u32).wrapping_shl(12) as i32;
            let origin = [axis(42), axis(21), axis(0)];
            if !seen.insert(origin) {
                let found = format!("{origin:?} twice");
                return Err(VolumeError::invalid("root tile", found, "each key once"));
            }
            if child == 0 {
                self.tree.tile(origin, ROOT_SIDE, value, active)?;
            } else {
                let node = self.child(root, child, UPPER.bytes, "root tile")?;
                self.node(node, origin, &UPPER)?;
            }
        }
        Ok(())
    }

    fn node(&mut self, node: u64, origin: [i32; 3], level: &Level) -> Result<(), VolumeError> {
        let mask_bytes = 1 << (3 * level.log2 - 3);
        let mut masks = self.cursor(node + MASKS, level.field)?;
        let active = masks.take(mask_bytes, level.field)?;
        let children = masks.take(mask_bytes, level.field)?;
        let table = self
            .cursor(node + level.table, level.field)?
            .take(mask_bytes * 64, level.field)?;
        for (at, entry) in table.chunks_exact(8).enumerate() {
            if !bit(children, at) {
                let value = f32::from_le_bytes([entry[0], entry[1], entry[2], entry[3]]);
                let active = bit(active, at);
                if active || value != 0.0 {
                    let origin = child_origin(origin, at, level.log2, level.child_side.into());
                    self.tree.tile(origin, level.child_side, value, active)?;
                }
            }
        }
        for at in set_bits(children) {
            let mut entry = Cursor::at(table, 8 * at as u64, level.field)?;
            let offset = entry.i64(level.field)?;
            let origin = child_origin(origin, at, level.log2, level.child_side.into());
            if level.log2 == UPPER.log2 {
                let child = self.child(node, offset, LOWER.bytes, level.field)?;
                self.node(child, origin, &LOWER)?;
            } else {
                self.leaf(node, offset, origin)?;
            }
        }
        Ok(())
    }

    fn leaf(&mut self, node: u64, offset: i64, origin: [i32; 3]) -> Result<(), VolumeError> {
        let header = place(self.buffer, node, offset, LEAF_VALUES, "leaf")?;
        let value_bytes = match self.kind {
            Kind::Float => 2048,
            Kind::Quantised(bits) => 64 * u64::from(bits),
            Kind::Variable => 64 * u64::from(variable_bits(self.buffer, header)?),
        };
        let leaf = self.child(node, offset, LEAF_VALUES + value_bytes, "leaf")?;
        let mask = self.cursor(leaf + LEAF_MASK, "leaf")?.take(64, "leaf")?;
        self.tree.leaf(origin, &leaf_mask(mask), leaf)
    }
}

fn variable_bits(buffer: &[u8], leaf: u64) -> Result<u32, VolumeError> {
    let log2 = Cursor::at(buffer, leaf + LEAF_FLAGS, "leaf")?.u8("leaf")? >> 5;
    if log2 > 4 {
        let found = format!("values of 2^{log2} bits");
        return Err(VolumeError::invalid("leaf", found, "at most 16 bits"));
    }
    Ok(1 << log2)
}

fn read_leaf(
    buffer: &[u8],
    kind: Kind,
    leaf: u64,
    values: &mut LeafValues,
) -> Result<(), VolumeError> {
    let mut stored = Cursor::at(buffer, leaf + LEAF_VALUES, "leaf")?;
    let bits = match kind {
        Kind::Float => {
            for value in values {
                *value = stored.f32("leaf")?;
            }
            return Ok(());
        }
        Kind::Quantised(bits) => bits,
        Kind::Variable => variable_bits(buffer, leaf)?,
    };
    let mut range = Cursor::at(buffer, leaf + LEAF_MINIMUM, "leaf")?;
    let minimum = range.f32("leaf")?;
    let quantum = range.f32("leaf")?;
    let codes = stored.take(64 * bits as usize, "leaf")?;
    for (at, value) in values.iter_mut().enumerate() {
        let first = at * bits as usize;
        let code = if bits == 16 {
            u32::from(u16::from_le_bytes([codes[first / 8], codes[first / 8 + 1]]))
        } else {
            u32::from(codes[first / 8]) >> (first % 8) & ((1 << bits) - 1)
        };
        *value = code as f32 * quantum + minimum;
    }
    Ok(())
}
