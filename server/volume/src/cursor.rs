//! A place in a file that is held whole: every step is checked against the end.

use crate::VolumeError;

/// Longest text that a file may hold. Unit: byte.
const MAX_TEXT: usize = 1 << 16;

/// Reads forward through bytes, little-endian.
#[derive(Debug, Clone)]
pub(crate) struct Cursor<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl<'a> Cursor<'a> {
    pub(crate) fn new(bytes: &'a [u8]) -> Self {
        Self { bytes, at: 0 }
    }

    /// A cursor at byte `at`, which may be the end but not beyond.
    pub(crate) fn at(bytes: &'a [u8], at: u64, field: &str) -> Result<Self, VolumeError> {
        match usize::try_from(at) {
            Ok(at) if at <= bytes.len() => Ok(Self { bytes, at }),
            _ => Err(VolumeError::invalid(
                field,
                format!("offset {at}"),
                format!("at most {}, the end of the data", bytes.len()),
            )),
        }
    }

    /// Bytes before the cursor.
    pub(crate) fn position(&self) -> usize {
        self.at
    }

    /// Bytes from the cursor to the end.
    pub(crate) fn left(&self) -> usize {
        self.bytes.len() - self.at
    }

    /// The next `count` bytes.
    pub(crate) fn take(&mut self, count: usize, field: &str) -> Result<&'a [u8], VolumeError> {
        if count > self.left() {
            return Err(VolumeError::invalid(
                field,
                format!("{count} bytes at byte {}", self.at),
                format!("{} bytes to the end of the data", self.left()),
            ));
        }
        let taken = &self.bytes[self.at..self.at + count];
        self.at += count;
        Ok(taken)
    }

    pub(crate) fn array<const N: usize>(&mut self, field: &str) -> Result<[u8; N], VolumeError> {
        let mut array = [0; N];
        array.copy_from_slice(self.take(N, field)?);
        Ok(array)
    }

    pub(crate) fn u8(&mut self, field: &str) -> Result<u8, VolumeError> {
        Ok(self.array::<1>(field)?[0])
    }

    pub(crate) fn u16(&mut self, field: &str) -> Result<u16, VolumeError> {
        Ok(u16::from_le_bytes(self.array(field)?))
    }

    pub(crate) fn u32(&mut self, field: &str) -> Result<u32, VolumeError> {
        Ok(u32::from_le_bytes(self.array(field)?))
    }

    pub(crate) fn i32(&mut self, field: &str) -> Result<i32, VolumeError> {
        Ok(i32::from_le_bytes(self.array(field)?))
    }

    pub(crate) fn u64(&mut self, field: &str) -> Result<u64, VolumeError> {
        Ok(u64::from_le_bytes(self.array(field)?))
    }

    pub(crate) fn i64(&mut self, field: &str) -> Result<i64, VolumeError> {
        Ok(i64::from_le_bytes(self.array(field)?))
    }

    pub(crate) fn f32(&mut self, field: &str) -> Result<f32, VolumeError> {
        Ok(f32::from_le_bytes(self.array(field)?))
    }

    pub(crate) fn f64s<const N: usize>(&mut self, field: &str) -> Result<[f64; N], VolumeError> {
        let mut values = [0.0; N];
        for value in &mut values {
            *value = f64::from_le_bytes(self.array(field)?);
        }
        Ok(values)
    }

    /// A text after its length in 4 bytes; what is not UTF-8 is replaced.
    pub(crate) fn text(&mut self, field: &str) -> Result<String, VolumeError> {
        let length = self.u32(field)? as usize;
        if length > MAX_TEXT {
            return Err(VolumeError::invalid(
                field,
                format!("a text of {length} bytes"),
                format!("at most {MAX_TEXT}"),
            ));
        }
        let bytes = self.take(length, field)?;
        Ok(String::from_utf8_lossy(bytes).into_owned())
    }
}
