//! The values of a node: inactive ones left out, half floats, and compressed.

use half::f16;

use super::{Packing, Storage};
use crate::compression;
use crate::cursor::Cursor;
use crate::sparse::bit;
use crate::{VolumeError, sparse};

/// Reads the values of nodes, with buffers that last.
#[derive(Debug)]
pub(super) struct ValueReader {
    storage: Storage,
    bytes: Vec<u8>,
    packed: Vec<f32>,
}

/// What a node says about its inactive values.
struct Inactive<'a> {
    /// Value of an inactive voxel that `mask` does not choose.
    off: f32,
    /// Value of one that it does.
    on: f32,
    mask: Option<&'a [u8]>,
    /// All values are stored, the inactive ones too.
    all_stored: bool,
}

impl ValueReader {
    pub(super) fn new(storage: Storage) -> Self {
        Self {
            storage,
            bytes: Vec::new(),
            packed: Vec::new(),
        }
    }

    /// Reads as many values as `values` holds; `mask` says which are active, a bit each.
    pub(super) fn read(
        &mut self,
        cursor: &mut Cursor<'_>,
        mask: &[u8],
        values: &mut [f32],
        field: &str,
    ) -> Result<(), VolumeError> {
        let inactive = self.inactive(cursor, mask.len(), field)?;
        if !self.storage.active_only || inactive.all_stored {
            return self.numbers(cursor, values.len(), field).map(|()| {
                values.copy_from_slice(&self.packed);
            });
        }
        let active = mask.iter().map(|bits| bits.count_ones() as usize).sum();
        self.numbers(cursor, active, field)?;
        if active == values.len() {
            values.copy_from_slice(&self.packed);
            return Ok(());
        }
        match inactive.mask {
            None => values.fill(inactive.off),
            Some(chosen) => {
                for (at, value) in values.iter_mut().enumerate() {
                    *value = if bit(chosen, at) {
                        inactive.on
                    } else {
                        inactive.off
                    };
                }
            }
        }
        for (at, value) in sparse::set_bits(mask).zip(&self.packed) {
            values[at] = *value;
        }
        Ok(())
    }

    fn inactive<'a>(
        &self,
        cursor: &mut Cursor<'a>,
        mask_bytes: usize,
        field: &str,
    ) -> Result<Inactive<'a>, VolumeError> {
        let background = self.storage.background;
        let kind = cursor.u8(field)?;
        let mut inactive = Inactive {
            off: if kind == 0 { background } else { -background },
            on: background,
            mask: None,
            all_stored: kind == 6,
        };
        if kind > 6 {
            let found = format!("kind {kind} of inactive values");
            return Err(VolumeError::invalid(field, found, "0 to 6"));
        }
        if matches!(kind, 2 | 4 | 5) {
            inactive.off = cursor.f32(field)?;
        }
        if kind == 5 {
            inactive.on = cursor.f32(field)?;
        }
        if matches!(kind, 3..=5) {
            inactive.mask = Some(cursor.take(mask_bytes, field)?);
        }
        Ok(inactive)
    }

    /// Reads `count` numbers into `self.packed`.
    fn numbers(
        &mut self,
        cursor: &mut Cursor<'_>,
        count: usize,
        field: &str,
    ) -> Result<(), VolumeError> {
        let Self {
            storage,
            bytes,
            packed,
        } = self;
        packed.clear();
        if storage.half {
            // Unlike floats, no halves at all are not even a block of length 0.
            if count > 0 {
                let halves =
                    block(storage.packing, bytes, cursor, 2 * count, field)?.chunks_exact(2);
                packed.extend(halves.map(|half| f16::from_le_bytes([half[0], half[1]]).to_f32()));
            }
        } else {
            let floats = block(storage.packing, bytes, cursor, 4 * count, field)?.chunks_exact(4);
            packed.extend(floats.map(|bytes| {
                let [a, b, c, d] = [bytes[0], bytes[1], bytes[2], bytes[3]];
                f32::from_le_bytes([a, b, c, d])
            }));
        }
        Ok(())
    }
}

/// `count` bytes, uncompressed: of the file, or of `buffer`.
fn block<'a, 'file: 'a>(
    packing: Packing,
    buffer: &'a mut Vec<u8>,
    cursor: &mut Cursor<'file>,
    count: usize,
    field: &str,
) -> Result<&'a [u8], VolumeError> {
    if packing == Packing::None {
        return cursor.take(count, field);
    }
    let stored = cursor.i64(field)?;
    if stored <= 0 {
        if stored.unsigned_abs() != count as u64 {
            let found = format!("{} bytes", stored.unsigned_abs());
            return Err(VolumeError::invalid(field, found, format!("{count}")));
        }
        return cursor.take(count, field);
    }
    let stored = usize::try_from(stored).unwrap_or(usize::MAX);
    let packed = cursor.take(stored, field)?;
    buffer.resize(count, 0);
    if count > 0 {
        if packing == Packing::Blosc {
            compression::blosc(packed, buffer, field)?;
        } else {
            compression::zip(packed, buffer, field)?;
        }
    }
    Ok(buffer)
}
