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

use tyndall_scene::{StopRule, Technique};
use tyndall_tests::{gpu, npz, pm_ref, shared_folder};

/// How two pictures differ in units of their noise, in the green channel.
struct Agreement {
    /// Deviation of the z-scores of 8×8 blocks.
    blocks: f64,
    /// z-score of the whole picture's mean.
    picture: f64,
}

/// Sums of differences and of both variances.
#[derive(Default, Clone, Copy)]
struct Sums {
    difference: f64,
    variance: f64,
}

impl Sums {
    fn z(self) -> Option<f64> {
        (self.variance > 0.0).then(|| self.difference / self.variance.sqrt())
    }
}

fn compare(name: &str, kind: &str, samples: u32) -> Option<Agreement> {
    let shared = shared_folder::find(name)?;
    let folder = shared.join("reference");
    let description = pm_ref::load(&folder.join(format!("scenes/{name}.json"))).unwrap();
    let mut scene = tyndall_scene::build(description, Some(&folder))
        .unwrap()
        .scene;
    scene.render.technique = Technique::Reference;
    scene.render.stop = StopRule::Samples(samples);
    if kind == "single" {
        scene.render.reference.max_scatterings = Some(1);
    }
    let (width, height) = (scene.render.width as usize, scene.render.height as usize);
    let still = gpu::render(&mut gpu::renderer(), scene);
    assert_eq!(still.truncated, 0, "paths given up");
    let file = folder.join(format!("data/ref_{name}_{kind}.npz"));
    let mean = npz::read_f32(&file, "mean").unwrap();
    let stderr = npz::read_f32(&file, "stderr").unwrap();
    let variance = still.variance.as_ref().unwrap();
    let mut blocks = vec![Sums::default(); (width / 8) * (height / 8)];
    let mut picture = Sums::default();
    for pixel in 0..width * height {
        let at = 3 * pixel + 1;
        let difference = f64::from(still.radiance[pixel][1]) - f64::from(mean[at]);
        let both = f64::from(stderr[at]).powi(2) + f64::from(variance[pixel][1]);
        let block = &mut blocks[pixel / width / 8 * (width / 8) + pixel % width / 8];
        for sums in [block, &mut picture] {
            sums.difference += difference;
            sums.variance += both;
        }
    }
    let scores: Vec<f64> = blocks.into_iter().filter_map(Sums::z).collect();
    let squares = scores.iter().map(|z| z * z).sum::<f64>();
    let agreement = Agreement {
        blocks: (squares / scores.len() as f64).sqrt(),
        picture: picture.z().unwrap(),
    };
    println!(
        "{name} {kind}: {samples} samples, estimated error {:.4}, block z deviation {:.2}, picture z {:+.2}",
        still.frame.stats.estimated_error.unwrap_or(-1.0),
        agreement.blocks,
        agreement.picture
    );
    Some(agreement)
}

fn agrees(name: &str, kind: &str, samples: u32) {
    agrees_within(name, kind, samples, 1.25);
}

fn agrees_within(name: &str, kind: &str, samples: u32, most: f64) {
    if let Some(found) = compare(name, kind, samples) {
        assert!(found.blocks < most, "{name} {kind}: {}", found.blocks);
        assert!(
            found.picture.abs() < 4.0,
            "{name} {kind}: {}",
            found.picture
        );
    }
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
    // The plume fills few blocks, and their scores have heavy tails: seeds 0 to 3 gave 1.28, 1.12, 0.90
    // and 0.80.
    agrees_within("smoke_plume", "single", 64, 1.6);
}
