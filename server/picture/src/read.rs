//! Any picture that can be compared, by its ending.

use std::path::Path;

use image::DynamicImage;
use tyndall_files::{ImageLimits, decode_image, decode_radiance};
use tyndall_quality::Image;

use crate::display::decode_srgb;
use crate::error::whole;
use crate::npy::{read_npy, read_npz};
use crate::{PictureError, read_exr};

/// Largest picture that is read.
const LIMITS: ImageLimits = ImageLimits {
    side: 65_536,
    pixels: 64 << 20,
};

/// What the values of a picture mean.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Range {
    /// Linear radiance.
    Hdr,
    /// Displayed values, decoded to linear in [0, 1].
    Ldr,
}

/// A picture from a file.
#[derive(Debug, Clone, PartialEq)]
pub struct Picture {
    /// Its pixels, with their variance if the file has it.
    pub image: Image,
    /// What they mean.
    pub range: Range,
}

/// Reads `.exr` (variance from its layers), `.hdr`, `.npy`, `.npz` (arrays `mean` and `stderr`), or
/// `.png` and `.jpg`, which hold displayed values.
///
/// # Errors
/// [`PictureError`] if the file can't be read or its ending is another.
pub fn read(path: &Path) -> Result<Picture, PictureError> {
    let ending = path.extension().and_then(|ending| ending.to_str());
    let ending = ending.unwrap_or_default().to_ascii_lowercase();
    let (image, range) = match ending.as_str() {
        "exr" => (read_exr(path)?.0.image()?, Range::Hdr),
        "npy" => (read_npy(path)?, Range::Hdr),
        "npz" => (read_npz(path)?, Range::Hdr),
        "hdr" => (radiance(path)?, Range::Hdr),
        "png" | "jpg" | "jpeg" => (displayed(path)?, Range::Ldr),
        _ => {
            return Err(PictureError::Format {
                file: path.to_owned(),
                allowed: ".exr, .hdr, .npy, .npz, .png or .jpg",
            });
        }
    };
    Ok(Picture { image, range })
}

fn radiance(path: &Path) -> Result<Image, PictureError> {
    let decoded = decode_radiance(&whole(path)?, LIMITS);
    let (picture, _exposure) = decoded.map_err(|error| PictureError::content(path, error))?;
    image(&picture, |value| value)
}

fn displayed(path: &Path) -> Result<Image, PictureError> {
    let decoded = decode_image(&whole(path)?, LIMITS);
    let picture = decoded.map_err(|error| PictureError::content(path, error))?;
    image(&picture, decode_srgb)
}

fn image(picture: &DynamicImage, linear: impl Fn(f32) -> f32) -> Result<Image, PictureError> {
    let decoded = picture.to_rgb32f();
    let (width, height) = decoded.dimensions();
    let pixels = decoded.pixels().map(|pixel| pixel.0.map(&linear)).collect();
    Ok(Image::new(width, height, pixels)?)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::write_png;

    #[test]
    fn a_png_comes_back_linear() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("x.png");
        write_png(&path, 2, 1, &[[0, 128, 255], [255; 3]]).unwrap();
        let picture = read(&path).unwrap();
        assert_eq!(picture.range, Range::Ldr);
        let [black, middle, white] = picture.image.rgb()[0];
        assert_eq!((black, white), (0.0, 1.0));
        assert!((middle - 0.2158).abs() < 1e-3, "{middle}");
    }

    #[test]
    fn other_endings_are_named() {
        let error = read(Path::new("x.tiff")).unwrap_err().to_string();
        assert!(
            error.contains("x.tiff") && error.contains(".exr"),
            "{error}"
        );
    }
}
