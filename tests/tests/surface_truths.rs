//! The path tracer against Mitsuba where surfaces have textures: base colour under every wrap mode,
//! metallic-roughness, normal maps, cut-outs (one of them shines), an environment map that is turned, each
//! in vacuum and in fog; textures that are turned, scaled or on the second set of coordinates. The truths, how they are made and what they leave out: `tests/data/surface_truths`.
//!
//! Stated bound: z-scores of 4×4 blocks with both variances, 192 blocks of three channels. If the
//! channels knew all of one another the deviation would scatter by 1/√(2·192) = 0.05 about 1; 1.25 is
//! five of those, a false alarm below 1e-6. Our own variance is an upper estimate (samples are better
//! spread than independent ones), so values below 1 are right. The mean of every channel is held to 4
//! standard errors: a false alarm in 16,000 a channel, in 500 of the whole file; seeds are fixed.

#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "helper functions of tests"
)]

use std::path::Path;

use tyndall_quality::block_z;
use tyndall_scene::StopRule;
use tyndall_tests::picture_z::picture_z;
use tyndall_tests::{estimate, gpu};

/// Side of a block. Unit: pixel.
const BLOCK: u32 = 4;

fn agrees(name: &str, samples: u32) {
    let folder = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/data/surface_truths"));
    let loaded = tyndall_scene::load(&folder.join(format!("{name}.json"))).unwrap();
    assert_eq!(loaded.warnings, [""; 0], "{name}");
    let mut scene = loaded.scene;
    scene.render.stop = StopRule::Samples(samples);
    let (width, height) = (scene.render.width, scene.render.height);
    let still = estimate::with_renderer(|renderer| gpu::render(renderer, scene));
    assert_eq!(still.truncated, 0, "paths given up");
    let variance = still.variance.as_ref().unwrap();
    let image = gpu::image(&still)
        .with_variance(variance.iter().map(|v| [v[0], v[1], v[2]]).collect())
        .unwrap();
    let truth = tyndall_picture::read(&folder.join(format!("{name}.npz")))
        .unwrap()
        .image;
    assert_eq!((truth.width(), truth.height()), (width, height));
    assert!(truth.variance().is_some(), "{name}");
    let blocks = block_z(&image, &truth, BLOCK).unwrap();
    let channels: [_; 3] = std::array::from_fn(|c| picture_z(&image, &truth, c));
    println!(
        "{name}: {samples} samples, block z deviation {:.3} (greatest {:.1}), picture z {:+.2} {:+.2} {:+.2}, mean ratio {:.4} {:.4} {:.4}",
        blocks.deviation,
        blocks.max,
        channels[0].0,
        channels[1].0,
        channels[2].0,
        channels[0].1,
        channels[1].1,
        channels[2].1
    );
    // At least half of the picture has something in it.
    assert!(blocks.count >= 288, "{name}: {} scores", blocks.count);
    assert!(blocks.deviation < 1.25, "{name}: {}", blocks.deviation);
    for (z, ratio) in channels {
        assert!(z.abs() < 4.0, "{name}: z {z}, ratio {ratio}");
    }
}

#[test]
fn base_colour_textures_agree_under_every_wrap_mode() {
    agrees("base_color", 64);
}

#[test]
fn base_colour_textures_agree_in_fog() {
    agrees("base_color_fog", 64);
}

#[test]
fn metallic_roughness_textures_agree() {
    agrees("metallic_roughness", 64);
}

#[test]
fn metallic_roughness_textures_agree_in_fog() {
    agrees("metallic_roughness_fog", 64);
}

#[test]
fn normal_maps_agree() {
    agrees("normal_map", 64);
}

#[test]
fn normal_maps_agree_in_fog() {
    agrees("normal_map_fog", 64);
}

#[test]
fn textures_agree_where_they_are_turned_or_on_the_second_coordinates() {
    agrees("placements", 64);
}

#[test]
fn cut_outs_agree_and_holes_do_not_shine() {
    agrees("cut_out", 64);
}

#[test]
fn cut_outs_agree_in_fog() {
    agrees("cut_out_fog", 64);
}

#[test]
fn environment_maps_agree() {
    agrees("environment", 64);
}

#[test]
fn environment_maps_agree_in_fog() {
    agrees("environment_fog", 64);
}
