//! Environment maps: Radiance `.hdr` and OpenEXR.

use std::io::Cursor;
use std::sync::Arc;

use exr::prelude::{ReadChannels, ReadLayers, SampleType};
use image::ImageDecoder;
use image::codecs::hdr::HdrDecoder;

use crate::error::SceneError;
use crate::files::Folder;
use crate::limits::{Limits, limit};
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
    let fits = |width: usize, height: usize| {
        if width == 0 || height == 0 {
            return Err(refused(format!(
                "{width}×{height} pixels, allowed 1 or more"
            )));
        }
        let pixels = (width as u64).saturating_mul(height as u64);
        let what = "the number of pixels of the environment map";
        limit(path, what, pixels, limits.environment_pixels)
    };
    let mut decoded = if bytes.starts_with(&[0x76, 0x2f, 0x31, 0x01]) {
        for header in exr::meta::MetaData::read_from_buffered(Cursor::new(&bytes), false)
            .map_err(|error| refused(error.to_string()))?
            .headers
        {
            fits(header.layer_size.width(), header.layer_size.height())?;
            if header.channels.list.len() > CHANNELS {
                let found = header.channels.list.len();
                return Err(refused(format!("{found} channels, allowed {CHANNELS}")));
            }
        }
        decode_exr(&bytes).map_err(|error| refused(error.to_string()))?
    } else {
        let decoder = HdrDecoder::new(Cursor::new(&bytes))
            .map_err(|error| refused(format!("neither Radiance nor EXR: {error}")))?;
        let (width, height) = decoder.dimensions();
        fits(width as usize, height as usize)?;
        decode_hdr(decoder).map_err(|error| refused(error.to_string()))?
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
fn decode_hdr(decoder: HdrDecoder<Cursor<&Vec<u8>>>) -> image::ImageResult<Decoded> {
    let (width, height) = decoder.dimensions();
    let header = decoder.metadata();
    let exposure = header.exposure.filter(|e| e.is_finite() && *e > 0.0);
    let scale = 1.0 / exposure.unwrap_or(1.0);
    let values = image::DynamicImage::from_decoder(decoder)?.into_rgb32f();
    let pixels = values.as_raw().chunks_exact(3);
    Ok(Decoded {
        width: width as usize,
        height: height as usize,
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
