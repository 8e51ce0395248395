//! The path tracer against the reference images of two independent path tracers
//! (`../shared/reference`), full and single.
//!
//! Stated bound: z-scores of 8×8 blocks with both variances. Their deviation scatters by 1/√600 = 0.04
//! about 1, and heavy tails (a point light in fog) widen it: a false alarm is beyond five of those.

#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "helper functions of tests"
)]

use tyndall_scene::{StopRule, Technique};
use tyndall_tests::{gpu, npz, pm_ref, shared_folder};

/// Deviation and mean of the block z-scores, and the ratio of the means.
struct Agreement {
    z_deviation: f64,
    z_mean: f64,
    mean_ratio: f64,
}

fn compare(name: &str, kind: &str, samples: u32) -> Option<Agreement> {
    let shared = shared_folder::find(name)?;
    let description = pm_ref::load(&shared.join(format!("reference/scenes/{name}.json"))).unwrap();
    let mut scene = tyndall_scene::build(description, Some(&shared.join("reference")))
        .unwrap()
        .scene;
    scene.render.technique = Technique::Reference;
    scene.render.stop = StopRule::Samples(samples);
    if kind == "single" {
        scene.render.reference.max_scatterings = Some(1);
    }
    let (width, height) = (scene.render.width as usize, scene.render.height as usize);
    let started = std::time::Instant::now();
    let still = gpu::render(&mut gpu::renderer(), scene);
    let seconds = started.elapsed().as_secs_f64();
    let file = shared.join(format!("reference/data/ref_{name}_{kind}.npz"));
    let mean = npz::read_f32(&file, "mean").unwrap();
    let stderr = npz::read_f32(&file, "stderr").unwrap();
    let variance = still.variance.as_ref().unwrap();
    let image = |i: usize| f64::from(still.radiance[i / 3][i % 3]);
    let (mut sum, mut squares, mut count) = (0.0, 0.0, 0.0);
    for by in 0..height / 8 {
        for bx in 0..width / 8 {
            let (mut difference, mut both) = (0.0, 0.0);
            for i in 0..64 {
                let pixel = (8 * by + i / 8) * width + 8 * bx + i % 8;
                let at = 3 * pixel + 1;
                difference += image(at) - f64::from(mean[at]);
                both += f64::from(stderr[at]).powi(2) + f64::from(variance[pixel][1]);
            }
            if both > 0.0 {
                let z = difference / both.sqrt();
                sum += z;
                squares += z * z;
                count += 1.0;
            }
        }
    }
    let total = |values: &mut dyn Iterator<Item = f64>| values.sum::<f64>();
    let mut error: Vec<f64> = (0..width * height)
        .map(|p| {
            (0..3)
                .map(|c| {
                    let r = f64::from(mean[3 * p + c]);
                    (image(3 * p + c) - r).powi(2) - f64::from(stderr[3 * p + c]).powi(2)
                })
                .sum::<f64>()
                / 3.0
        })
        .collect();
    error.sort_by(f64::total_cmp);
    let kept = error.len() - error.len().div_ceil(1000);
    let picture_mean = total(&mut (0..mean.len()).map(image)) / mean.len() as f64;
    let trimmed = (error[..kept].iter().sum::<f64>().max(0.0) / kept as f64).sqrt() / picture_mean;
    let agreement = Agreement {
        z_deviation: f64::sqrt(squares / count),
        z_mean: sum / count,
        mean_ratio: total(&mut (0..mean.len()).map(image))
            / total(&mut mean.iter().map(|v| f64::from(*v))),
    };
    println!(
        "{name} {kind}: {samples} samples in {seconds:.2} s, estimated error {:.4}, relRMSE_trim {trimmed:.4}, mean ratio {:.5}, block z mean {:.2} deviation {:.2}",
        still.frame.stats.estimated_error.unwrap_or(-1.0),
        agreement.mean_ratio,
        agreement.z_mean,
        agreement.z_deviation
    );
    Some(agreement)
}

fn agrees(name: &str, kind: &str, samples: u32) {
    if let Some(found) = compare(name, kind, samples) {
        assert!(
            found.z_deviation < 1.25,
            "{name} {kind}: {}",
            found.z_deviation
        );
        assert!(
            (found.mean_ratio - 1.0).abs() < 0.01,
            "{name} {kind}: {}",
            found.mean_ratio
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
    agrees("smoke_plume", "single", 64);
}
