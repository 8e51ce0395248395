//! Environment maps: what is read, what is mended, what is refused.

#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "helpers of tests, too, fail by unwrapping and say what they skip"
)]

use std::path::Path;

use crate::support::{shared, walk};
use exr::prelude::{WritableImage, f16};
use serde_json::{Value, json};
use tyndall_scene::{
    EnvironmentDistribution, EnvironmentMap, Limits, Loaded, SceneDescription, SceneEdit,
    SceneError, apply_edit, build_with,
};

fn load_with(folder: &Path, light: &Value, limits: &Limits) -> Result<Loaded, SceneError> {
    let mut light = light.clone();
    light["kind"] = json!("environment");
    let scene = json!({
        "version": 1,
        "camera": {"position": [0, 1, 4], "target": [0, 1, 0]},
        "lights": [light],
    });
    let description = SceneDescription::from_json(&scene.to_string())?;
    build_with(description, Some(folder), limits)
}

fn load(folder: &Path, file: &str) -> Result<Loaded, SceneError> {
    load_with(folder, &json!({ "map": file }), &Limits::default())
}

fn map(loaded: &Loaded) -> EnvironmentMap {
    loaded.scene.environment.clone().unwrap().map.unwrap()
}

/// Radiance pixels without run lengths.
fn hdr(header: &str, width: usize, pixels: &[[u8; 4]]) -> Vec<u8> {
    let height = pixels.len() / width;
    let mut bytes = format!("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n{header}\n").into_bytes();
    bytes.extend(format!("-Y {height} +X {width}\n").as_bytes());
    bytes.extend(pixels.as_flattened());
    bytes
}

fn exr_f32(path: &Path, size: (usize, usize), pixel: impl Fn(usize, usize) -> [f32; 3] + Sync) {
    exr::prelude::write_rgb_file(path, size.0, size.1, |x, y| {
        let [r, g, b] = pixel(x, y);
        (r, g, b)
    })
    .unwrap();
}

#[test]
fn radiance_maps_keep_rows_and_divide_out_the_exposure() {
    let folder = tempfile::tempdir().unwrap();
    // Mantissa 128 and exponent 129: 1; each step of the exponent doubles.
    let pixels = [
        [128, 0, 0, 129],
        [0, 128, 0, 130],
        [0, 0, 128, 131],
        [0, 0, 0, 0],
    ];
    std::fs::write(folder.path().join("a.hdr"), hdr("EXPOSURE=2\n", 2, &pixels)).unwrap();
    let light = json!({"map": "a.hdr", "radiance": [1, 2, 3], "rotation_degrees": 90});
    let loaded = load_with(folder.path(), &light, &Limits::default()).unwrap();
    let map = map(&loaded);
    assert_eq!((map.width, map.height), (2, 2));
    let expected = [[0.5, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 2.0], [0.0; 3]];
    for (found, expected) in map.pixels.iter().zip(expected) {
        for (found, expected) in found.iter().zip(expected) {
            assert!((found - expected).abs() < 0.01, "{found} is not {expected}");
        }
    }
    let environment = loaded.scene.environment.unwrap();
    assert_eq!(environment.radiance, [1.0, 2.0, 3.0]);
    assert!((environment.rotation - 1.570_796_4).abs() < 1e-6);
    assert!(loaded.warnings.is_empty());
}

#[test]
fn pixels_that_are_no_radiance_are_mended_and_counted() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.exr");
    exr_f32(&path, (4, 2), |x, y| match (x, y) {
        (0, 0) => [f32::NAN, 1.0, 1.0],
        (1, 0) => [f32::INFINITY, f32::NEG_INFINITY, 2.0],
        (2, 0) => [-1.0, 3.0, 3.0],
        (3, 0) => [1e30, 4.0, 4.0],
        _ => [0.25, 0.5, 1.0],
    });
    let loaded = load(folder.path(), "a.exr").unwrap();
    let pixels = map(&loaded).pixels;
    assert_eq!(pixels[0], [0.0, 1.0, 1.0]);
    assert_eq!(pixels[1], [0.0, 0.0, 2.0]);
    assert_eq!(pixels[2], [0.0, 3.0, 3.0]);
    assert_eq!(pixels[3], [1e9, 4.0, 4.0]);
    assert_eq!(pixels[4], [0.25, 0.5, 1.0]);
    assert_eq!(
        loaded.warnings,
        [
            "lights[0].map: a.exr: 2 pixels are not finite and count as 0; 1 pixels are negative and \
          count as 0; 1 pixels are above 1e9 and count as that"
        ]
    );

    let size = (4, 2);
    let channels = exr::prelude::SpecificChannels::rgb(|at: exr::prelude::Vec2<usize>| {
        let red = if at.x() == 1 {
            f16::INFINITY
        } else {
            f16::from_f32(0.5)
        };
        (red, f16::from_f32(0.25), f16::from_f32(2.0))
    });
    let image = exr::prelude::Image::from_channels(size, channels);
    image
        .write()
        .to_file(folder.path().join("half.exr"))
        .unwrap();
    let loaded = load(folder.path(), "half.exr").unwrap();
    assert_eq!(map(&loaded).pixels[1], [65504.0, 0.25, 2.0]);
    assert_eq!(map(&loaded).pixels[2], [0.5, 0.25, 2.0]);
    assert!(loaded.warnings[0].contains("2 pixels are infinite in 16 bits and count as 65504"));
}

#[test]
fn maps_that_are_none_or_too_large_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    exr_f32(&at("good.exr"), (64, 32), |x, _| [x as f32; 3]);
    std::fs::write(at("text.hdr"), "no image").unwrap();
    std::fs::write(at("empty.exr"), "").unwrap();
    let huge = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1000000 +X 1000000\n";
    std::fs::write(at("huge.hdr"), huge).unwrap();
    std::fs::write(
        at("none.hdr"),
        b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 0 +X 0\n",
    )
    .unwrap();
    for file in [
        "text.hdr",
        "empty.exr",
        "none.hdr",
        "huge.hdr",
        "absent.hdr",
    ] {
        let error = load(folder.path(), file).unwrap_err();
        assert_eq!(error.path(), Some("lights[0].map"), "{error}");
    }
    for file in ["good.exr", "huge.hdr"] {
        let limits = Limits {
            environment_pixels: 2047,
            ..Limits::default()
        };
        let error = load_with(folder.path(), &json!({ "map": file }), &limits).unwrap_err();
        assert!(
            matches!(error, SceneError::Limit { limit: 2047, .. }),
            "{error}"
        );
    }
}

#[test]
fn edits_keep_the_map() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("a.hdr"), hdr("", 1, &[[128, 0, 0, 129]])).unwrap();
    let loaded = load(folder.path(), "a.hdr").unwrap();
    let edit = |light: Value| {
        let edit: SceneEdit = serde_json::from_value(json!({ "lights": [light] })).unwrap();
        apply_edit(&loaded.description, &loaded.scene, &edit)
    };
    let turned = json!({"kind": "environment", "map": "a.hdr", "rotation_degrees": 10});
    let (_, scene) = edit(turned).unwrap();
    assert_eq!(scene.environment.unwrap().map.unwrap(), map(&loaded));
    let (_, scene) = edit(json!({"kind": "environment", "radiance": 2})).unwrap();
    assert_eq!(scene.environment.unwrap().map, None);
    let error = edit(json!({"kind": "environment", "map": "b.hdr"})).unwrap_err();
    assert_eq!(error.path(), Some("lights[0].map"));
}

#[test]
fn real_maps_load_and_are_sampled() {
    let Some(folder) = shared().map(|folder| folder.join("data/envmaps")) else {
        return;
    };
    for file in walk(&folder) {
        let name = file.file_name().unwrap().to_str().unwrap();
        let start = std::time::Instant::now();
        let loaded = load(&folder, name).unwrap();
        let read = start.elapsed();
        let map = map(&loaded);
        let distribution = EnvironmentDistribution::new(&map);
        println!(
            "{name}: {}×{}, read in {read:.0?}, distribution in {:.0?}, {:?}",
            map.width,
            map.height,
            start.elapsed().saturating_sub(read),
            loaded.warnings
        );
        let integral: f64 = (0..map.pixels.len())
            .map(|i| f64::from(distribution.pdf[i]) * map.solid_angle(i as u32 / map.width))
            .sum();
        assert!((integral - 1.0).abs() < 1e-4, "{integral}");
        // Luminance over density, averaged, estimates the integral of the map: within a few
        // parts in a hundred, since the density follows it.
        let samples = 4000_u32;
        let mut sum = 0.0;
        for i in 0..samples {
            let numbers = [0.754_877_666, 0.569_840_296, 0.430_159_709]
                .map(|step| (f64::from(i) * step + 0.5).fract());
            let sample = distribution.sample(numbers).unwrap();
            let [r, g, b] = map.pixels[sample.pixel as usize].map(f64::from);
            sum += (0.2126 * r + 0.7152 * g + 0.0722 * b) / f64::from(sample.pdf);
        }
        let found = sum / f64::from(samples) / distribution.total;
        assert!((found - 1.0).abs() < 0.05, "{name}: {found}");
    }
}
