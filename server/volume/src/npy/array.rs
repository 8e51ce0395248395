//! An array as plain numbers, for those who want no grid: pictures.

use std::io::{ErrorKind, Read};

use super::header::Header;
use crate::VolumeError;

/// How much is read at once: a multiple of every number's length. Unit: byte.
const BLOCK: usize = 1 << 16;

/// Floating-point numbers along three axes.
#[derive(Debug, Clone, PartialEq)]
pub struct Array {
    /// Numbers along each axis; the last index changes fastest.
    pub shape: [u32; 3],
    /// All numbers, as many as the shape says.
    pub values: Vec<f32>,
}

impl Array {
    /// Reads an array of `length` bytes, its header included. `axes` names the axes in errors.
    ///
    /// Memory grows with what has been read, whatever the header says.
    ///
    /// # Errors
    /// [`VolumeError::Invalid`] where the bytes do not follow the format or the array has not three
    /// axes, [`VolumeError::Unsupported`] for integers and for Fortran order, [`VolumeError::Limit`]
    /// if the file holds more than `most_bytes`.
    pub fn read(
        source: &mut impl Read,
        length: u64,
        most_bytes: u64,
        axes: &str,
    ) -> Result<Self, VolumeError> {
        VolumeError::within("bytes of the file", length, most_bytes)?;
        let Header {
            shape,
            number,
            big_endian,
            fortran_order,
            length: header_bytes,
        } = Header::read(source, axes)?;
        if !number.is_float() {
            return Err(VolumeError::unsupported("descr", "an array of integers"));
        }
        if fortran_order {
            return Err(VolumeError::unsupported("fortran_order", "True"));
        }
        let mut left = length.saturating_sub(header_bytes);
        let numbers: u128 = shape.map(u128::from).into_iter().product();
        let bytes = numbers.saturating_mul(number.bytes() as u128);
        if bytes != u128::from(left) {
            let allowed = format!("{bytes} bytes for the shape {shape:?}");
            return Err(VolumeError::invalid(
                "array",
                format!("{left} bytes"),
                allowed,
            ));
        }
        let mut block = vec![0; BLOCK];
        let mut values = Vec::new();
        while left > 0 {
            let block = &mut block[..left.min(BLOCK as u64) as usize];
            source
                .read_exact(block)
                .map_err(|error| match error.kind() {
                    ErrorKind::UnexpectedEof => {
                        let allowed = format!("{left} bytes more");
                        VolumeError::invalid("array", "the end of the data", allowed)
                    }
                    _ => error.into(),
                })?;
            values.extend(number.decode(big_endian, block));
            left -= block.len() as u64;
        }
        Ok(Self { shape, values })
    }
}
