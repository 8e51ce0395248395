//! The path tracer against the reference images of two independent path tracers
//! (`../shared/reference`), full and single.
//!
//! Stated bound: z-scores of 8×8 blocks with both variances. Their deviation scatters by 1/√600 = 0.04
//! about 1, and heavy tails (a point light in fog) widen it: a false alarm is beyond five of those. Our
//! own variance is an upper estimate (samples are better spread than independent ones), so values below
//! 1 are right. The whole picture's mean is held to 4 standard errors, a false alarm in 16,000.

#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "helper functions of tests"
)]

use tyndall_quality::{BLOCK_SIDE, block_z};
use tyndall_scene::{StopRule, Technique};
use tyndall_tests::picture_z::picture_z;
use tyndall_tests::{gpu, published};

/// Green: the scenes are all but grey, so that other channels would say the same again.
const CHANNEL: usize = 1;

fn agrees(name: &str, kind: &str, samples: u32) {
    let Some(published::Published { mut scene, image }) = published::find(name, kind) else {
        return;
    };
    scene.render.technique = Technique::Reference;
    scene.render.stop = StopRule::Samples(samples);
    if kind == "single" {
        scene.render.reference.max_scatterings = Some(1);
    }
    let still = gpu::render(&mut gpu::renderer(), scene);
    assert_eq!(still.truncated, 0, "paths given up");
    let variance = still.variance.as_ref().unwrap();
    let own = gpu::image(&still).with_variance(variance.clone()).unwrap();
    let blocks = block_z(&own, &image, BLOCK_SIDE).unwrap();
    let (picture, ratio) = picture_z(&own, &image, CHANNEL);
    println!(
        "{name} {kind}: {samples} samples, estimated error {:.4}, block z deviation {:.2}, picture z {picture:+.2}, mean ratio {ratio:.4}",
        still.frame.stats.estimated_error.unwrap_or(-1.0),
        blocks.deviation,
    );
    assert!(blocks.deviation < 1.25, "{name} {kind}: {blocks:?}");
    assert!(picture.abs() < 4.0, "{name} {kind}: {picture}");
}

#[test]
fn fog_box_full_agrees() {
    agrees("fog_box", "full", 64);
}

#[test]
fn fog_box_single_agrees() {
    agrees("fog_box", "single", 64);
}

#[test]
fn exp_fog_single_agrees() {
    agrees("exp_fog", "single", 64);
}

#[test]
fn furnace_full_agrees() {
    agrees("furnace", "full", 64);
}

#[test]
fn light_shafts_full_agrees() {
    agrees("light_shafts", "full", 64);
}

#[test]
fn light_shafts_single_agrees() {
    agrees("light_shafts", "single", 64);
}

#[test]
fn smoke_plume_full_agrees() {
    agrees("smoke_plume", "full", 64);
}

#[test]
fn smoke_plume_single_agrees() {
    // More than the others: at 64 the blocks' scores have heavy tails (seeds 0 to 3 gave 1.28, 1.12,
    // 0.90 and 0.80), since the plume fills few of them.
    agrees("smoke_plume", "single", 256);
}
