//! Ten thousand changed pictures of each format: a decoder may refuse one, but always comes back soon.

#![allow(
    clippy::unwrap_used,
    reason = "helpers of tests, too, fail by unwrapping"
)]

use std::io::Cursor;
use std::time::Duration;

use image::codecs::hdr::HdrEncoder;
use image::codecs::jpeg::JpegEncoder;
use image::{ExtendedColorType, ImageEncoder as _, Rgb};
use tyndall_files::{ExrLimits, ImageLimits, decode_image, decode_radiance, read_exr_header};
use tyndall_mutations::{Kind, attack};

/// How long a picture of a few pixels may take.
const SOON: Duration = Duration::from_secs(2);
const LIMITS: ImageLimits = ImageLimits {
    side: 4096,
    pixels: 1 << 20,
};

fn png(color: png::ColorType, depth: png::BitDepth, bytes: &[u8]) -> Vec<u8> {
    let mut out = Vec::new();
    let mut encoder = png::Encoder::new(&mut out, 8, 4);
    encoder.set_color(color);
    encoder.set_depth(depth);
    if color == png::ColorType::Indexed {
        encoder.set_palette((0..48).collect::<Vec<u8>>());
        encoder.set_trns(vec![0, 128, 255]);
    }
    let mut writer = encoder.write_header().unwrap();
    writer.write_image_data(bytes).unwrap();
    writer.finish().unwrap();
    out
}

#[test]
fn changed_png_files_are_harmless() {
    use png::{BitDepth, ColorType};
    let pixels: Vec<u8> = (0..=255).collect();
    let few: Vec<u8> = pixels.iter().map(|value| value % 16).collect();
    let seeds = [
        png(ColorType::Rgba, BitDepth::Eight, &pixels[..128]),
        png(ColorType::Rgba, BitDepth::Sixteen, &pixels),
        png(ColorType::Grayscale, BitDepth::Two, &pixels[..8]),
        png(ColorType::Indexed, BitDepth::Eight, &few[..32]),
    ];
    attack("png", &seeds, Kind::Binary, SOON, |bytes| {
        decode_image(bytes, LIMITS).is_ok()
    });
}

#[test]
fn changed_jpeg_files_are_harmless() {
    let pixels: Vec<u8> = (0..=255).collect();
    let jpeg = |quality: u8, color: ExtendedColorType| {
        let mut out = Vec::new();
        let encoder = JpegEncoder::new_with_quality(&mut out, quality);
        let length = 64 * usize::from(color.channel_count());
        encoder.write_image(&pixels[..length], 8, 8, color).unwrap();
        out
    };
    let seeds = [
        jpeg(90, ExtendedColorType::Rgb8),
        jpeg(30, ExtendedColorType::L8),
    ];
    attack("jpeg", &seeds, Kind::Binary, SOON, |bytes| {
        decode_image(bytes, LIMITS).is_ok()
    });
}

#[test]
fn changed_radiance_files_are_harmless() {
    let pixels: Vec<Rgb<f32>> = (0..64_u8).map(|i| Rgb([f32::from(i), 0.5, 9e3])).collect();
    let mut seed = Vec::new();
    HdrEncoder::new(&mut seed).encode(&pixels, 16, 4).unwrap();
    attack("hdr", &[seed], Kind::Text, SOON, |bytes| {
        decode_radiance(bytes, LIMITS).is_ok()
    });
}

#[test]
fn changed_headers_of_exr_files_are_harmless() {
    use exr::prelude::{Image, SpecificChannels, Vec2, WritableImage as _};
    let channels = SpecificChannels::rgb(|at: Vec2<usize>| (at.x() as f32, 0.5, at.y() as f32));
    let mut seed = Cursor::new(Vec::new());
    let image = Image::from_channels((6, 4), channels);
    image.write().to_buffered(&mut seed).unwrap();
    let limits = ExrLimits {
        pixels: 1 << 20,
        channels: 64,
        bytes: 1 << 24,
    };
    let seeds = [seed.into_inner()];
    attack("exr header", &seeds, Kind::Binary, SOON, |bytes| {
        read_exr_header(bytes, limits).is_ok()
    });
}
