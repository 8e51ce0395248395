//! `NumPy` arrays of pixels: `.npy`, and the `mean` and `stderr` of an `.npz`.

use std::io::{Cursor, Read as _};
use std::path::Path;

use tyndall_quality::Image;

use crate::PictureError;

/// Largest array that is read. Unit: byte.
const LARGEST: u64 = 4 << 30;

/// Reads an array of shape [height, width, 3 or more], float32 or float64, C order.
///
/// # Errors
/// [`PictureError`] with what was found instead.
pub fn read_npy(path: &Path) -> Result<Image, PictureError> {
    let bytes = std::fs::read(path).map_err(|error| PictureError::io(path, error))?;
    let (width, height, pixels) =
        parse(&bytes).map_err(|what| PictureError::content(path, what))?;
    Ok(Image::new(width, height, pixels)?)
}

/// Reads arrays `mean` and, if there, `stderr` (standard error, squared into the variance).
pub(crate) fn read_npz(path: &Path) -> Result<Image, PictureError> {
    let content = |what: &dyn std::fmt::Display| PictureError::content(path, what);
    let file = std::fs::File::open(path).map_err(|error| PictureError::io(path, error))?;
    let mut archive = zip::ZipArchive::new(file).map_err(|error| content(&error))?;
    let mut member = |name: &str| -> Result<_, PictureError> {
        let member = archive
            .by_name(name)
            .map_err(|error| content(&format_args!("{name}: {error}")))?;
        let mut bytes = Vec::new();
        member
            .take(LARGEST)
            .read_to_end(&mut bytes)
            .map_err(|error| PictureError::io(path, error))?;
        parse(&bytes).map_err(|what| content(&format_args!("{name}: {what}")))
    };
    let (width, height, mean) = member("mean.npy")?;
    let image = Image::new(width, height, mean)?;
    let Ok((_, _, stderr)) = member("stderr.npy") else {
        return Ok(image);
    };
    let variance = stderr.iter().map(|p| p.map(|value| value * value));
    Ok(image.with_variance(variance.collect())?)
}

/// Width, height and RGB of an array.
fn parse(bytes: &[u8]) -> Result<(u32, u32, Vec<[f32; 3]>), String> {
    let mut reader = Cursor::new(bytes);
    let mut magic = [0; 8];
    let short = |_| "the file ends early".to_owned();
    reader.read_exact(&mut magic).map_err(short)?;
    if magic[..6] != *b"\x93NUMPY" {
        return Err("not a .npy array".into());
    }
    // The header's length takes 2 bytes in version 1 and 4 after.
    let mut length = [0; 4];
    let length_bytes = if magic[6] == 1 { 2 } else { 4 };
    reader
        .read_exact(&mut length[..length_bytes])
        .map_err(short)?;
    let start = 8 + length_bytes;
    let end = start + u32::from_le_bytes(length) as usize;
    let header = bytes
        .get(start..end)
        .ok_or("the file ends in its header")
        .map(String::from_utf8_lossy)?;
    let size = if header.contains("'<f4'") {
        4
    } else if header.contains("'<f8'") {
        8
    } else {
        return Err(format!("{header}: expected '<f4' or '<f8'"));
    };
    if !header.contains("'fortran_order': False") {
        return Err(format!("{header}: expected C order"));
    }
    let shape = shape(&header).ok_or_else(|| format!("{header}: no shape"))?;
    let &[height, width, channels] = shape.as_slice() else {
        return Err(format!("shape {shape:?}: expected [height, width, 3]"));
    };
    let bytes_wanted = height
        .checked_mul(width)
        .and_then(|count| count.checked_mul(channels)?.checked_mul(size));
    let data = &bytes[end..];
    if channels < 3 || bytes_wanted != Some(data.len() as u64) {
        return Err(format!(
            "shape {shape:?} with {} bytes: expected [height, width, 3 or more] of {size} bytes each",
            data.len()
        ));
    }
    let value = |word: &[u8]| match *word {
        [a, b, c, d] => f32::from_le_bytes([a, b, c, d]),
        [a, b, c, d, e, f, g, h] => f64::from_le_bytes([a, b, c, d, e, f, g, h]) as f32,
        _ => f32::NAN,
    };
    let size = size as usize;
    let pixels = data
        .chunks_exact(channels as usize * size)
        .map(|pixel| std::array::from_fn(|c| value(&pixel[c * size..(c + 1) * size])))
        .collect();
    let side = |value: u64| u32::try_from(value).map_err(|error| format!("side {value}: {error}"));
    Ok((side(width)?, side(height)?, pixels))
}

fn shape(header: &str) -> Option<Vec<u64>> {
    let (_, rest) = header.split_once("'shape': (")?;
    let (numbers, _) = rest.split_once(')')?;
    let numbers = numbers.split(',').map(str::trim);
    numbers
        .filter(|text| !text.is_empty())
        .map(|text| text.parse().ok())
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn array(header: &str, data: &[u8]) -> Vec<u8> {
        let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
        bytes.extend((header.len() as u16).to_le_bytes());
        bytes.extend(header.as_bytes());
        bytes.extend(data);
        bytes
    }

    #[test]
    fn float32_and_float64_arrays_are_read() {
        let header = "{'descr': '<f4', 'fortran_order': False, 'shape': (1, 2, 3), }";
        let data: Vec<u8> = (0..6).flat_map(|i| (i as f32).to_le_bytes()).collect();
        let (width, height, pixels) = parse(&array(header, &data)).unwrap();
        assert_eq!((width, height), (2, 1));
        assert_eq!(pixels, [[0.0, 1.0, 2.0], [3.0, 4.0, 5.0]]);
        let data: Vec<u8> = (0..6).flat_map(|i| f64::from(i).to_le_bytes()).collect();
        let read = parse(&array(&header.replace("<f4", "<f8"), &data)).unwrap();
        assert_eq!(read.2, pixels);
    }

    #[test]
    fn what_is_no_picture_is_refused() {
        let header = "{'descr': '<f4', 'fortran_order': False, 'shape': (9, 2, 3), }";
        for bytes in [
            array(header, &[0; 24]),
            array(&header.replace("False", "True"), &[0; 216]),
            array(&header.replace("<f4", "<i4"), &[0; 216]),
            array(&header.replace("(9, 2, 3)", "(54,)"), &[0; 216]),
            array(&header.replace("9, 2", "4294967296, 4294967296"), &[0; 24]),
            b"\x93NUMPY\x01\x00\xff\xff{".to_vec(),
            b"PK".to_vec(),
        ] {
            assert!(parse(&bytes).is_err());
        }
    }
}
