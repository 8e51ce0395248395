//! Relative errors and z-scores against the formulas of the reference images' `compare.py`, computed
//! in `NumPy` by `make_fixtures.py`.

#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "helper functions of tests"
)]

use std::path::PathBuf;

use tyndall_quality::{Comparison, Image};

fn hdr(name: &str, share: f32) -> Image {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/fixtures");
    let bytes = std::fs::read(folder.join(name)).unwrap();
    let words = bytes.chunks_exact(4);
    let values: Vec<f32> = words
        .map(|word| f32::from_le_bytes(word.try_into().unwrap()))
        .collect();
    let rgb: Vec<[f32; 3]> = values
        .chunks_exact(3)
        .map(|p| p.try_into().unwrap())
        .collect();
    let variance = rgb.iter().map(|p| p.map(|v| (share * v).powi(2))).collect();
    let image = Image::new(72, 48, rgb).unwrap();
    image.with_variance(variance).unwrap()
}

#[test]
fn every_measure_is_that_of_compare_py() {
    let json: serde_json::Value =
        serde_json::from_str(include_str!("fixtures/expected.json")).unwrap();
    let image = hdr("hdr_test.f32", 0.05);
    let reference = hdr("hdr_reference.f32", 0.1);
    let found = Comparison::of(&image, &reference).unwrap();
    let z = found.block_z.unwrap();
    let own = found.reference_estimated_error.unwrap();
    let pairs = [
        ("relative_rmse", found.relative_rmse),
        (
            "relative_rmse_debiased",
            found.relative_rmse_debiased.unwrap(),
        ),
        ("relative_rmse_trim", found.relative_rmse_trim),
        ("relative_mse", found.relative_mse),
        ("relative_mse_trim", found.relative_mse_trim),
        ("mean_ratio", found.mean_ratio),
        ("reference_error_trim", own.relative_error_trim),
        ("block_z_mean", z.mean),
        ("block_z_deviation", z.deviation),
        ("block_z_max", z.max),
        ("block_z_outside_3", z.outside_3 as f64),
    ];
    for (name, value) in pairs {
        let expected = json["measures"][name].as_f64().unwrap();
        let difference = (value - expected).abs();
        assert!(
            difference <= 1e-5 * expected.abs().max(1.0),
            "{name}: {value}, not {expected}"
        );
    }
}
