//! How numbers are stored in files, and how they are read as float32.

use half::f16;

/// How a number is stored.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Number {
    F16,
    F32,
    F64,
    U8,
    U16,
    U32,
    U64,
    I8,
    I16,
    I32,
    I64,
}

impl Number {
    /// Length. Unit: byte.
    pub(crate) fn bytes(self) -> usize {
        match self {
            Self::U8 | Self::I8 => 1,
            Self::F16 | Self::U16 | Self::I16 => 2,
            Self::F32 | Self::U32 | Self::I32 => 4,
            Self::F64 | Self::U64 | Self::I64 => 8,
        }
    }

    /// Whether it is a floating-point number.
    pub(crate) fn is_float(self) -> bool {
        matches!(self, Self::F16 | Self::F32 | Self::F64)
    }

    /// The numbers that lie one after the other in `bytes`; what is left over at the end is no number.
    pub(crate) fn decode(self, big_endian: bool, bytes: &[u8]) -> impl Iterator<Item = f32> {
        bytes.chunks_exact(self.bytes()).map(move |bytes| {
            let mut word = [0; 8];
            word[..bytes.len()].copy_from_slice(bytes);
            if big_endian {
                word[..bytes.len()].reverse();
            }
            self.value(word)
        })
    }

    /// The number in the low bytes of a word.
    fn value(self, word: [u8; 8]) -> f32 {
        let [a, b, c, d, ..] = word;
        match self {
            Self::F16 => f16::from_le_bytes([a, b]).to_f32(),
            Self::F32 => f32::from_le_bytes([a, b, c, d]),
            Self::F64 => f64::from_le_bytes(word) as f32,
            Self::U8 => a.into(),
            Self::U16 => u16::from_le_bytes([a, b]).into(),
            Self::U32 => u32::from_le_bytes([a, b, c, d]) as f32,
            Self::U64 => u64::from_le_bytes(word) as f32,
            Self::I8 => a.cast_signed().into(),
            Self::I16 => i16::from_le_bytes([a, b]).into(),
            Self::I32 => i32::from_le_bytes([a, b, c, d]) as f32,
            Self::I64 => i64::from_le_bytes(word) as f32,
        }
    }
}
