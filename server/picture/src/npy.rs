//! `NumPy` arrays of pixels: `.npy`, and the `mean` and `stderr` of an `.npz`.

use std::io::BufReader;
use std::path::Path;

use tyndall_files::{guarded, regular};
use tyndall_quality::Image;
use tyndall_volume::npy::Array;
use tyndall_volume::npz;

use crate::PictureError;

/// Largest array that is read. Unit: byte.
const LARGEST: u64 = 4 << 30;
/// The axes that a picture has.
const AXES: &str = "(height, width, 3 or more)";

/// Reads an array of shape [height, width, 3 or more] of floating-point numbers in C order.
///
/// # Errors
/// [`PictureError`] with what was found instead.
pub fn read_npy(path: &Path) -> Result<Image, PictureError> {
    let (file, length) = regular::open(path).map_err(|error| PictureError::io(path, error))?;
    let array = Array::read(&mut BufReader::new(file), length, LARGEST, AXES)
        .map_err(|error| PictureError::content(path, error))?;
    let (width, height, rgb) = pixels(&array).map_err(|what| PictureError::content(path, what))?;
    Ok(Image::new(width, height, rgb)?)
}

/// Reads arrays `mean` and, if there, `stderr` (standard error, squared into the variance).
pub(crate) fn read_npz(path: &Path) -> Result<Image, PictureError> {
    let (file, _length) = regular::open(path).map_err(|error| PictureError::io(path, error))?;
    let member = |name: &str| -> Result<_, PictureError> {
        let content = |what: &dyn std::fmt::Display| {
            PictureError::content(path, format_args!("{name}: {what}"))
        };
        let array = guarded("zip", || {
            npz::read_array(BufReader::new(&file), name, LARGEST, AXES)
        });
        let array = array.map_err(|failed| content(&failed))?;
        let array = array.map_err(|error| content(&error))?;
        let read = array.map(|array| pixels(&array)).transpose();
        read.map_err(|what| content(&what))
    };
    let Some((width, height, mean)) = member("mean")? else {
        return Err(PictureError::content(path, "no array named mean"));
    };
    let image = Image::new(width, height, mean)?;
    let Some((_, _, stderr)) = member("stderr")? else {
        return Ok(image);
    };
    let variance = stderr.iter().map(|p| p.map(|value| value * value));
    Ok(image.with_variance(variance.collect())?)
}

/// Width, height and RGB of an array; further channels are left out.
fn pixels(array: &Array) -> Result<(u32, u32, Vec<[f32; 3]>), String> {
    let [height, width, channels] = array.shape;
    if channels < 3 {
        return Err(format!(
            "shape: found {channels} channels, allowed: 3 or more"
        ));
    }
    let pixels = array.values.chunks_exact(channels as usize);
    let rgb = pixels.map(|pixel| [pixel[0], pixel[1], pixel[2]]).collect();
    Ok((width, height, rgb))
}

#[cfg(test)]
mod tests {
    use std::fs::File;
    use std::io::Write as _;

    use super::*;

    const HEADER: &str = "{'descr': '<f4', 'fortran_order': False, 'shape': (1, 2, 3), }";

    fn array(header: &str, data: &[u8]) -> Vec<u8> {
        let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
        bytes.extend((header.len() as u16).to_le_bytes());
        bytes.extend(header.as_bytes());
        bytes.extend(data);
        bytes
    }

    fn floats() -> Vec<u8> {
        (0..6).flat_map(|i| (i as f32).to_le_bytes()).collect()
    }

    fn npy(bytes: &[u8]) -> Result<Image, PictureError> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("x.npy");
        std::fs::write(&path, bytes).unwrap();
        read_npy(&path)
    }

    fn npz(arrays: &[(&str, &[u8])]) -> Result<Image, PictureError> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("x.npz");
        let mut archive = zip::ZipWriter::new(File::create(&path).unwrap());
        for (name, bytes) in arrays {
            let options = zip::write::SimpleFileOptions::default();
            archive.start_file(format!("{name}.npy"), options).unwrap();
            archive.write_all(bytes).unwrap();
        }
        archive.finish().unwrap();
        read_npz(&path)
    }

    #[test]
    fn float32_and_float64_arrays_are_read() {
        let image = npy(&array(HEADER, &floats())).unwrap();
        assert_eq!((image.width(), image.height()), (2, 1));
        assert_eq!(image.rgb(), [[0.0, 1.0, 2.0], [3.0, 4.0, 5.0]]);
        let doubles: Vec<u8> = (0..6).flat_map(|i| f64::from(i).to_le_bytes()).collect();
        let read = npy(&array(&HEADER.replace("<f4", "<f8"), &doubles)).unwrap();
        assert_eq!(read, image);
    }

    #[test]
    fn channels_after_the_third_are_left_out() {
        let header = HEADER.replace("(1, 2, 3)", "(1, 1, 6)");
        let image = npy(&array(&header, &floats())).unwrap();
        assert_eq!(image.rgb(), [[0.0, 1.0, 2.0]]);
    }

    #[test]
    fn standard_errors_are_squared_into_the_variance() {
        let bytes = array(HEADER, &floats());
        let pixels = bytes.as_slice();
        let image = npz(&[("mean", pixels)]).unwrap();
        assert_eq!(image.variance(), None);
        let image = npz(&[("stderr", pixels), ("mean", pixels)]).unwrap();
        let variance = image.variance().unwrap();
        assert_eq!(variance, [[0.0, 1.0, 4.0], [9.0, 16.0, 25.0]]);
        for arrays in [
            &[("stderr", pixels)][..],
            &[("mean", pixels), ("stderr", &pixels[..80])],
        ] {
            let error = npz(arrays).unwrap_err().to_string();
            assert!(error.contains("x.npz"), "{error}");
        }
    }

    #[test]
    fn what_is_no_picture_is_refused() {
        let header = HEADER.replace("(1, 2, 3)", "(9, 2, 3)");
        let two = HEADER.replace("(1, 2, 3)", "(1, 3, 2)");
        for (bytes, what) in [
            (array(&header, &[0; 24]), "allowed: 216 bytes"),
            (
                array(&header.replace("False", "True"), &[0; 216]),
                "fortran",
            ),
            (array(&header.replace("<f4", "<i4"), &[0; 216]), "integers"),
            (
                array(&header.replace("(9, 2, 3)", "(54,)"), &[0; 216]),
                "height",
            ),
            (
                array(&header.replace("9, 2", "4294967295, 4294967295"), &[0; 24]),
                "allowed: 221360928",
            ),
            (array(&two, &[0; 24]), "2 channels"),
            (b"\x93NUMPY\x01\x00\xff\xff{".to_vec(), "end of the data"),
            (b"PK".to_vec(), "end of the data"),
        ] {
            let error = npy(&bytes).unwrap_err().to_string();
            assert!(error.contains(what) && error.contains("x.npy"), "{error}");
        }
    }
}
