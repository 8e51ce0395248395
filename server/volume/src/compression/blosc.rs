//! Chunks of blosc 1: LZ4, `BloscLZ`, zlib or Zstandard over bytes sorted by significance.
//!
//! A chunk is a header of 16 bytes, the offsets of its blocks, and the blocks. A block is one
//! stream, or as many as a value has bytes where those bytes were put apart ("shuffled") and each
//! plane compressed alone. Source: c-blosc's description of the chunk format.

use std::io::Read;

use super::{blosclz, broken, zip};
use crate::VolumeError;
use crate::cursor::Cursor;

const HEADER: usize = 16;
const SHUFFLED: u8 = 1;
const COPIED: u8 = 2;
const BIT_SHUFFLED: u8 = 4;
const NOT_SPLIT: u8 = 16;
/// Blocks are split only up to this many bytes a value.
const MAX_SPLITS: usize = 16;
/// Blocks are split only from this many values.
const MIN_SPLIT_VALUES: usize = 128;

/// Largest window of a Zstandard frame: what its specification asks of every decoder. Unit: byte.
const MAX_ZSTD_WINDOW: u64 = 8 << 20;

/// Unpacks a chunk that has to fill `output` exactly.
pub(crate) fn blosc(input: &[u8], output: &mut [u8], field: &str) -> Result<(), VolumeError> {
    let mut header = Cursor::new(input);
    let [_version, _codec_version, flags, value_bytes] = header.array(field)?;
    let claimed = header.u32(field)? as usize;
    let block_bytes = header.u32(field)? as usize;
    let chunk_bytes = header.u32(field)? as usize;
    if claimed != output.len() {
        return Err(VolumeError::invalid(
            field,
            format!("a chunk of {claimed} bytes"),
            format!("{} bytes", output.len()),
        ));
    }
    if chunk_bytes < HEADER || chunk_bytes > input.len() {
        return Err(broken(field, "a wrong size of the chunk"));
    }
    let chunk = &input[..chunk_bytes];
    if flags & COPIED != 0 {
        let copied = Cursor::at(chunk, HEADER as u64, field)?.take(output.len(), field)?;
        output.copy_from_slice(copied);
        return Ok(());
    }
    if output.is_empty() {
        return Ok(());
    }
    if flags & BIT_SHUFFLED != 0 {
        return Err(VolumeError::unsupported(field, "blosc's bit shuffle"));
    }
    if block_bytes == 0 {
        return Err(broken(field, "blocks of 0 bytes"));
    }
    let shuffle = flags & SHUFFLED != 0 && value_bytes > 1;
    let layout = Layout {
        codec: flags >> 5,
        split: flags & NOT_SPLIT == 0,
        value_bytes: usize::from(value_bytes).max(1),
        block_bytes,
    };
    let mut offsets = Cursor::at(chunk, HEADER as u64, field)?;
    let mut sorted = vec![
        0;
        if shuffle {
            block_bytes.min(output.len())
        } else {
            0
        }
    ];
    for block in output.chunks_mut(block_bytes) {
        let at = u64::from(offsets.u32(field)?);
        let mut stream = Cursor::at(chunk, at, field)?;
        if shuffle {
            let sorted = &mut sorted[..block.len()];
            layout.block(&mut stream, sorted, field)?;
            unshuffle(sorted, block, layout.value_bytes);
        } else {
            layout.block(&mut stream, block, field)?;
        }
    }
    Ok(())
}

struct Layout {
    codec: u8,
    split: bool,
    value_bytes: usize,
    block_bytes: usize,
}

impl Layout {
    fn block(
        &self,
        stream: &mut Cursor<'_>,
        output: &mut [u8],
        field: &str,
    ) -> Result<(), VolumeError> {
        let whole = output.len() == self.block_bytes;
        let worth_it = self.value_bytes <= MAX_SPLITS
            && self.block_bytes / self.value_bytes >= MIN_SPLIT_VALUES;
        let parts = if self.split && whole && worth_it {
            self.value_bytes
        } else {
            1
        };
        if !output.len().is_multiple_of(parts) {
            return Err(broken(field, "blocks of a fraction of a value"));
        }
        let part_bytes = output.len() / parts;
        for part in output.chunks_mut(part_bytes) {
            let packed_bytes = stream.u32(field)? as usize;
            let packed = stream.take(packed_bytes, field)?;
            if packed_bytes == part_bytes {
                part.copy_from_slice(packed);
            } else {
                unpack(self.codec, packed, part, field)?;
            }
        }
        Ok(())
    }
}

fn unpack(codec: u8, packed: &[u8], output: &mut [u8], field: &str) -> Result<(), VolumeError> {
    let filled = match codec {
        0 => blosclz::decompress(packed, output),
        1 => lz4_flex::block::decompress_into(packed, output).ok(),
        2 => return Err(VolumeError::unsupported(field, "blosc's codec snappy")),
        3 => return zip(packed, output, field),
        4 => zstd(packed, output),
        other => {
            let what = format!("blosc's codec {other}");
            return Err(VolumeError::unsupported(field, what));
        }
    };
    if filled == Some(output.len()) {
        Ok(())
    } else {
        Err(broken(field, "a stream of a wrong length"))
    }
}

fn zstd(packed: &[u8], output: &mut [u8]) -> Option<usize> {
    if zstd_window(packed)? > MAX_ZSTD_WINDOW {
        return None;
    }
    let mut decoder = ruzstd::decoding::StreamingDecoder::new(packed).ok()?;
    decoder.read_exact(output).ok()?;
    Some(output.len())
}

/// How much of its output a Zstandard frame refers back to, which the decoder reserves. Unit: byte.
fn zstd_window(frame: &[u8]) -> Option<u64> {
    let descriptor = *frame.get(4)?;
    if descriptor & 0x20 == 0 {
        let window = *frame.get(5)?;
        let base = 1_u64 << (10 + (window >> 3));
        return Some(base + base / 8 * u64::from(window & 7));
    }
    // One segment: as much as it has, which follows the number of its dictionary.
    let start = 5 + [0, 1, 2, 4][usize::from(descriptor & 3)];
    let length = 1 << (descriptor >> 6);
    let mut size = [0; 8];
    size[..length].copy_from_slice(frame.get(start..start + length)?);
    Some(u64::from_le_bytes(size))
}

/// Puts the bytes of values together again: byte i of value j lies at `i·count + j`.
fn unshuffle(sorted: &[u8], output: &mut [u8], value_bytes: usize) {
    let count = sorted.len() / value_bytes;
    for (j, value) in output.chunks_exact_mut(value_bytes).enumerate() {
        for (i, byte) in value.iter_mut().enumerate() {
            *byte = sorted[i * count + j];
        }
    }
    let whole = count * value_bytes;
    output[whole..].copy_from_slice(&sorted[whole..]);
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    const PLAIN: &[u8] = include_bytes!("../../tests/fixtures/blosc.bin");

    /// Chunks by c-blosc of every codec, plain and shuffled, and of several blocks.
    const CHUNKS: [(&str, &[u8]); 11] = [
        (
            "blosclz",
            include_bytes!("../../tests/fixtures/blosc_blosclz_0.bin"),
        ),
        (
            "blosclz, shuffled",
            include_bytes!("../../tests/fixtures/blosc_blosclz_1.bin"),
        ),
        (
            "lz4",
            include_bytes!("../../tests/fixtures/blosc_lz4_0.bin"),
        ),
        (
            "lz4, shuffled",
            include_bytes!("../../tests/fixtures/blosc_lz4_1.bin"),
        ),
        (
            "lz4hc",
            include_bytes!("../../tests/fixtures/blosc_lz4hc_0.bin"),
        ),
        (
            "lz4hc, shuffled",
            include_bytes!("../../tests/fixtures/blosc_lz4hc_1.bin"),
        ),
        (
            "zlib",
            include_bytes!("../../tests/fixtures/blosc_zlib_0.bin"),
        ),
        (
            "zlib, shuffled",
            include_bytes!("../../tests/fixtures/blosc_zlib_1.bin"),
        ),
        (
            "zstd",
            include_bytes!("../../tests/fixtures/blosc_zstd_0.bin"),
        ),
        (
            "zstd, shuffled",
            include_bytes!("../../tests/fixtures/blosc_zstd_1.bin"),
        ),
        (
            "blocks",
            include_bytes!("../../tests/fixtures/blosc_blocks.bin"),
        ),
    ];

    #[test]
    fn every_codec_gives_what_c_blosc_packed() {
        for (name, chunk) in CHUNKS {
            let mut output = vec![0; PLAIN.len()];
            blosc(chunk, &mut output, name).unwrap();
            assert!(output == PLAIN, "{name}");
            let mut short = vec![0; PLAIN.len() - 4];
            assert!(blosc(chunk, &mut short, name).is_err(), "{name}");
        }
    }

    #[test]
    fn bit_shuffled_chunks_are_refused_by_name() {
        let chunk = include_bytes!("../../tests/fixtures/blosc_bitshuffle.bin");
        let error = blosc(chunk, &mut vec![0; PLAIN.len()], "values").unwrap_err();
        assert!(error.to_string().contains("bit shuffle"), "{error}");
    }

    #[test]
    fn a_frame_of_a_huge_window_is_refused() {
        let window = |bytes: &[u8]| zstd_window(&[&[0x28, 0xb5, 0x2f, 0xfd], bytes].concat());
        assert_eq!(window(&[0x00, 0x00]), Some(1 << 10));
        assert_eq!(window(&[0x00, 31 << 3]), Some(1 << 41));
        assert_eq!(window(&[0xa0, 1, 2, 3, 4]), Some(0x0403_0201));
        let frame = [0x28, 0xb5, 0x2f, 0xfd, 0x00, 31 << 3, 0x01, 0x00, 0x00];
        assert_eq!(zstd(&frame, &mut [0]), None);
    }

    proptest! {
        #![proptest_config(ProptestConfig {
            cases: 20_000,
            failure_persistence: None,
            ..ProptestConfig::default()
        })]

        #[test]
        fn broken_chunks_are_harmless(
            which in 0..CHUNKS.len(),
            changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..4),
            end in prop::option::of(any::<prop::sample::Index>()),
        ) {
            let mut chunk = CHUNKS[which].1.to_vec();
            for (at, value) in changes {
                let at = at.index(chunk.len());
                chunk[at] = value;
            }
            if let Some(end) = end {
                chunk.truncate(end.index(chunk.len()));
            }
            let mut output = vec![0; PLAIN.len()];
            drop(blosc(&chunk, &mut output, "chunk"));
        }
    }
}
