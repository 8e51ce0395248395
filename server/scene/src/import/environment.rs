//! Environment maps: Radiance `.hdr` and OpenEXR.

use std::io::Cursor;
use std::sync::Arc;

use exr::prelude::{ReadChannels, ReadLayers, SampleType};
use tyndall_files::{
    ExrError, ExrLimits, ImageError, ImageLimits, decode_radiance, guarded, read_exr_header,
};

use crate::error::SceneError;
use crate::files::Folder;
use crate::limits::Limits;
use crate::scene::EnvironmentMap;

/// What infinity in a 16-bit channel becomes: the largest value of the format. Writers overflow at
/// suns, so there it stands for something bright.
const HALF_MAX: f32 = 65504.0;
/// Largest radiance of a pixel; keeps sums of products finite in `f32`. Unit: W·m⁻²·sr⁻¹.
const BRIGHTEST: f32 = 1e9;
/// Most channels of an EXR file: every block is decoded with all of them.
const CHANNELS: usize = 64;

/// What a format yields.
struct Decoded {
    width: usize,
    height: usize,
    pixels: Vec<[f32; 3]>,
    /// Whether channels have 16 bits.
    half: bool,
}

/// Loads a map; the warning says which pixels were mended.
pub(super) fn load(
    path: &str,
    file: &str,
    folder: &Folder,
    limits: &Limits,
) -> Result<(EnvironmentMap, Option<String>), SceneError> {
    let bytes = folder.read(path, file)?;
    let refused = |message: String| SceneError::Model {
        path: path.to_owned(),
        file: file.to_owned(),
        location: "image".to_owned(),
        message,
    };
    let too_large = |found: u64, limit: u64| SceneError::Limit {
        path: path.to_owned(),
        what: "the number of pixels of the environment map",
        found,
        limit,
    };
    let most = limits.environment_pixels;
    let mut decoded = if bytes.starts_with(&[0x76, 0x2f, 0x31, 0x01]) {
        let limits = ExrLimits {
            pixels: most,
            channels: CHANNELS,
            bytes: u64::MAX,
        };
        read_exr_header(&bytes, limits).map_err(|error| match error {
            ExrError::Pixels { found, limit } => too_large(found, limit),
            other => refused(other.to_string()),
        })?;
        guarded("OpenEXR", || decode_exr(&bytes))
            .map_err(|failed| refused(failed.to_string()))?
            .map_err(|error| refused(error.to_string()))?
    } else {
        decode_hdr(&bytes, most).map_err(|error| match error {
            ImageError::Pixels { found, limit } => too_large(found, limit),
            ImageError::Broken(error) => refused(format!("neither Radiance nor EXR: {error}")),
            other => refused(other.to_string()),
        })?
    };
    if decoded.pixels.len() != decoded.width * decoded.height {
        return Err(refused("fewer pixels than its header says".to_owned()));
    }
    let warning = mend(&mut decoded).map(|what| format!("{path}: {file}: {what}"));
    let map = EnvironmentMap {
        width: decoded.width as u32,
        height: decoded.height as u32,
        pixels: Arc::new(decoded.pixels),
    };
    Ok((map, warning))
}

/// Radiance divides out the exposure that the header names.
fn decode_hdr(bytes: &[u8], pixels: u64) -> Result<Decoded, ImageError> {
    let side = u32::MAX;
    let (picture, exposure) = decode_radiance(bytes, ImageLimits { side, pixels })?;
    let exposure = exposure.filter(|e| e.is_finite() && *e > 0.0);
    let scale = 1.0 / exposure.unwrap_or(1.0);
    let (width, height) = (picture.width() as usize, picture.height() as usize);
    let values = picture.into_rgb32f();
    let pixels = values.as_raw().chunks_exact(3);
    Ok(Decoded {
        width,
        height,
        pixels: pixels
            .map(|p| [p[0] * scale, p[1] * scale, p[2] * scale])
            .collect(),
        half: false,
    })
}

fn decode_exr(bytes: &[u8]) -> exr::error::Result<Decoded> {
    let image = exr::prelude::read()
        .no_deep_data()
        .largest_resolution_level()
        .rgba_channels(
            |size, channels| {
                let kinds = [&channels.0, &channels.1, &channels.2];
                Decoded {
                    width: size.width(),
                    height: size.height(),
                    pixels: vec![[0.0; 3]; size.area()],
                    half: kinds.iter().any(|kind| kind.sample_type == SampleType::F16),
                }
            },
            |decoded: &mut Decoded, at, (r, g, b, _): (f32, f32, f32, f32)| {
                let index = at.x() + at.y() * decoded.width;
                decoded.pixels[index] = [r, g, b];
            },
        )
        .first_valid_layer()
        .all_attributes()
        .non_parallel()
        .from_buffered(Cursor::new(bytes))?;
    Ok(image.layer_data.channel_data.pixels)
}

/// Makes every value finite, not negative and not too large; says how many pixels were not.
fn mend(decoded: &mut Decoded) -> Option<String> {
    let (mut not_finite, mut negative, mut overflown, mut bright) = (0_u64, 0_u64, 0_u64, 0_u64);
    for pixel in &mut decoded.pixels {
        let [
            mut is_not_finite,
            mut is_negative,
            mut is_overflown,
            mut is_bright,
        ] = [false; 4];
        for value in pixel {
            if *value == f32::INFINITY && decoded.half {
                is_overflown = true;
                *value = HALF_MAX;
            } else if !value.is_finite() {
                is_not_finite = true;
                *value = 0.0;
            } else if *value < 0.0 {
                is_negative = true;
                *value = 0.0;
            } else if *value > BRIGHTEST {
                is_bright = true;
                *value = BRIGHTEST;
            }
        }
        not_finite += u64::from(is_not_finite);
        negative += u64::from(is_negative);
        overflown += u64::from(is_overflown);
        bright += u64::from(is_bright);
    }
    let said: Vec<String> = [
        (not_finite, "are not finite and count as 0".to_owned()),
        (negative, "are negative and count as 0".to_owned()),
        (
            overflown,
            format!("are infinite in 16 bits and count as {HALF_MAX}, the largest value there"),
        ),
        (bright, format!("are above {BRIGHTEST:e} and count as that")),
    ]
    .into_iter()
    .filter(|(count, _)| *count > 0)
    .map(|(count, what)| format!("{count} pixels {what}"))
    .collect();
    (!said.is_empty()).then(|| said.join("; "))
}
