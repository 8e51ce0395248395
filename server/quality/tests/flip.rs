//! FLIP against the authors' program: images and errors made by `make_fixtures.py`
//! (flip-evaluator 1.7 of `PyPI`).

#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "helper functions of tests"
)]

use std::path::PathBuf;

use tyndall_quality::{FlipMap, Image, PIXELS_PER_DEGREE, hdr_flip, ldr_flip};

const WIDTH: u32 = 72;
const HEIGHT: u32 = 48;

fn file(name: &str) -> Vec<u8> {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/fixtures");
    std::fs::read(folder.join(name)).unwrap()
}

fn expected(case: &str, key: &str) -> f64 {
    let json: serde_json::Value = serde_json::from_slice(&file("expected.json")).unwrap();
    assert_eq!(json["width"], WIDTH);
    json["cases"][case][key].as_f64().unwrap()
}

fn floats(name: &str) -> Vec<f32> {
    let bytes = file(name);
    let words = bytes.chunks_exact(4);
    words
        .map(|word| f32::from_le_bytes(word.try_into().unwrap()))
        .collect()
}

fn hdr(name: &str) -> Image {
    let values = floats(name);
    let rgb = values.chunks_exact(3).map(|p| p.try_into().unwrap());
    Image::new(WIDTH, HEIGHT, rgb.collect()).unwrap()
}

fn ldr(name: &str) -> Image {
    let bytes = file(name);
    let pixels = &bytes[bytes.len() - (3 * WIDTH * HEIGHT) as usize..];
    let linear = |byte: u8| {
        let value = f32::from(byte) / 255.0;
        if value <= 0.04045 {
            value / 12.92
        } else {
            ((value + 0.055) / 1.055).powf(2.4)
        }
    };
    let rgb = pixels
        .chunks_exact(3)
        .map(|p| [p[0], p[1], p[2]].map(linear));
    Image::new(WIDTH, HEIGHT, rgb.collect()).unwrap()
}

fn assert_close(case: &str, map: &FlipMap) {
    let theirs = floats(&format!("{case}.f32"));
    let pairs = map.errors.iter().zip(&theirs);
    let worst = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
    let mean = (map.mean() - expected(case, "mean")).abs();
    println!("{case}: mean differs by {mean:.2e}, worst pixel by {worst:.2e}");
    assert!(mean <= 1e-3, "{case}: mean differs by {mean}");
    assert!(worst <= 1e-2, "{case}: a pixel differs by {worst}");
}

#[test]
fn ldr_flip_is_that_of_the_authors() {
    let map = ldr_flip(
        &ldr("ldr_test.ppm"),
        &ldr("ldr_reference.ppm"),
        PIXELS_PER_DEGREE,
    );
    assert_close("ldr_error", &map.unwrap());
}

#[test]
fn hdr_flip_is_that_of_the_authors() {
    let flip = hdr_flip(
        &hdr("hdr_test.f32"),
        &hdr("hdr_reference.f32"),
        PIXELS_PER_DEGREE,
    )
    .unwrap();
    let close = |found: f32, key: &str| {
        let expected = expected("hdr_error", key);
        assert!(
            (f64::from(found) - expected).abs() < 1e-3,
            "{key}: {found}, not {expected}"
        );
    };
    close(flip.start_exposure, "startExposure");
    close(flip.stop_exposure, "stopExposure");
    close(flip.exposures as f32, "numExposures");
    assert_close("hdr_error", &flip.map);
}

#[test]
fn a_picture_has_no_difference_from_itself() {
    let image = hdr("hdr_test.f32");
    let flip = hdr_flip(&image, &image, PIXELS_PER_DEGREE).unwrap();
    assert_eq!(flip.map.mean(), 0.0);
}
