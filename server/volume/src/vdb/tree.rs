//! The topology of a tree: root, nodes of 4096³ voxels, of 128³, leaves of 8³.

use std::collections::HashSet;

use super::Storage;
use super::values::ValueReader;
use crate::cursor::Cursor;
use crate::sparse::{SparseTree, bit, child_origin, leaf_mask, set_bits};
use crate::{VolumeError, VolumeLimits};

/// A level of nodes that have children.
struct Level {
    /// Children along an edge, as a power of two.
    log2: u32,
    /// Side of a child. Unit: voxel.
    child_side: u16,
    field: &'static str,
}

const ROOT_SIDE: u16 = 4096;
const UPPER: Level = Level {
    log2: 5,
    child_side: 128,
    field: "node of 4096³ voxels",
};
const LOWER: Level = Level {
    log2: 4,
    child_side: 8,
    field: "node of 128³ voxels",
};

/// Reads the topology. The leaves' values follow in the order of the tree's leaves.
pub(super) fn read_topology(
    cursor: &mut Cursor<'_>,
    storage: Storage,
    limits: &VolumeLimits,
) -> Result<SparseTree, VolumeError> {
    let mut topology = Topology {
        tree: SparseTree::new(limits),
        reader: ValueReader::new(storage),
        upper: vec![0.0; 1 << (3 * UPPER.log2)],
        lower: vec![0.0; 1 << (3 * LOWER.log2)],
    };
    let tiles = cursor.u32("root")?;
    let children = cursor.u32("root")?;
    let mut seen = HashSet::new();
    for _ in 0..tiles {
        let origin = root_key(cursor, &mut seen)?;
        let value = cursor.f32("root tile")?;
        let active = cursor.u8("root tile")? != 0;
        topology.tree.tile(origin, ROOT_SIDE, value, active)?;
    }
    let mut last = None;
    for _ in 0..children {
        let origin = root_key(cursor, &mut seen)?;
        // OpenVDB reads the leaves' values in the order of these keys.
        if last.replace(origin) > Some(origin) {
            let found = format!("{origin:?} after a higher one");
            return Err(VolumeError::invalid("root child", found, "ascending keys"));
        }
        topology.node(cursor, origin, &UPPER)?;
    }
    Ok(topology.tree)
}

fn root_key(
    cursor: &mut Cursor<'_>,
    seen: &mut HashSet<[i32; 3]>,
) -> Result<[i32; 3], VolumeError> {
    let mut key = [0; 3];
    for axis in &mut key {
        *axis = cursor.i32("root key")?;
    }
    let aligned = key.iter().all(|axis| axis % i32::from(ROOT_SIDE) == 0);
    if !aligned || !seen.insert(key) {
        return Err(VolumeError::invalid(
            "root key",
            format!("{key:?}"),
            "multiples of 4096, each once",
        ));
    }
    Ok(key)
}

struct Topology {
    tree: SparseTree,
    reader: ValueReader,
    upper: Vec<f32>,
    lower: Vec<f32>,
}

impl Topology {
    fn node(
        &mut self,
        cursor: &mut Cursor<'_>,
        origin: [i32; 3],
        level: &Level,
    ) -> Result<(), VolumeError> {
        let is_upper = level.log2 == UPPER.log2;
        let mask_bytes = 1 << (3 * level.log2 - 3);
        let children = cursor.take(mask_bytes, level.field)?;
        let active = cursor.take(mask_bytes, level.field)?;
        let values = if is_upper {
            &mut self.upper
        } else {
            &mut self.lower
        };
        self.reader.read(cursor, active, values, level.field)?;
        for (at, value) in values.iter().enumerate() {
            let is_active = bit(active, at);
            if !bit(children, at) && (is_active || *value != 0.0) {
                let tile = child_origin(origin, at, level.log2, level.child_side.into());
                self.tree.tile(tile, level.child_side, *value, is_active)?;
            }
        }
        for at in set_bits(children) {
            let child = child_origin(origin, at, level.log2, level.child_side.into());
            if is_upper {
                self.node(cursor, child, &LOWER)?;
            } else {
                let mask = leaf_mask(cursor.take(64, "leaf")?);
                self.tree.leaf(child, &mask, 0)?;
            }
        }
        Ok(())
    }
}
