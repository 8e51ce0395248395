//! Pictures against the reference images of two independent path tracers (`../shared/reference`):
//! light scattered once, on a surface or in the medium.
//!
//! Stated bound: relRMSE without the worst 0.1 % of pixels, the reference's own variance taken off,
//! and the ratio of the means. The pictures are converged (jittered march, traced shadows), so what is
//! left is bias and the reference's outliers.

#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "helper functions of tests"
)]

use tyndall_scene::{ShadowMode, StopRule};
use tyndall_tests::{gpu, npz, pm_ref, shared_folder};

/// Largest deviation of the 300 block z-scores that passes for noise. Their deviation scatters by
/// 1/√600 = 0.04 about 1 and our own noise adds a little: a false alarm is beyond five of those.
const MAX_BLOCK_Z: f64 = 1.25;

struct Errors {
    relative_rmse: f64,
    mean_ratio: f64,
    /// Deviation of the z-scores of 8×8 blocks.
    block_z: f64,
}

fn compare(name: &str, mode: ShadowMode) -> Option<Errors> {
    let shared = shared_folder::find(name)?;
    let description = pm_ref::load(&shared.join(format!("reference/scenes/{name}.json"))).unwrap();
    let mut scene = tyndall_scene::build(description, None).unwrap().scene;
    scene.render.stop = StopRule::Samples(256);
    scene.render.single_scattering.steps = 32;
    scene.render.shadows.mode = mode;
    scene.render.shadows.resolution = 2048;
    let (width, height) = (scene.render.width as usize, scene.render.height as usize);
    let still = gpu::render(&mut gpu::renderer(), scene);
    let file = shared.join(format!("reference/data/ref_{name}_single.npz"));
    let mean = npz::read_f32(&file, "mean").unwrap();
    let stderr = npz::read_f32(&file, "stderr").unwrap();
    assert_eq!(mean.len(), 3 * width * height, "reference size");
    let image = |i: usize| f64::from(still.radiance[i / 3][i % 3]);
    let mut squares: Vec<f64> = (0..width * height)
        .map(|p| {
            (0..3)
                .map(|c| {
                    (image(3 * p + c) - f64::from(mean[3 * p + c])).powi(2)
                        - f64::from(stderr[3 * p + c]).powi(2)
                })
                .sum::<f64>()
                / 3.0
        })
        .collect();
    squares.sort_by(f64::total_cmp);
    let kept = squares.len() - squares.len().div_ceil(1000);
    let mean_square = squares[..kept].iter().sum::<f64>() / kept as f64;
    let reference_mean = mean.iter().map(|v| f64::from(*v)).sum::<f64>() / mean.len() as f64;
    let image_mean = (0..mean.len()).map(image).sum::<f64>() / mean.len() as f64;
    let mut z_squares = Vec::new();
    for by in 0..height / 8 {
        for bx in 0..width / 8 {
            let (mut difference, mut variance) = (0.0, 0.0);
            for i in 0..64 {
                let at = 3 * ((8 * by + i / 8) * width + 8 * bx + i % 8) + 1;
                difference += image(at) - f64::from(mean[at]);
                variance += f64::from(stderr[at]).powi(2);
            }
            if variance > 0.0 {
                z_squares.push(difference * difference / variance);
            }
        }
    }
    let errors = Errors {
        relative_rmse: mean_square.max(0.0).sqrt() / reference_mean,
        mean_ratio: image_mean / reference_mean,
        block_z: (z_squares.iter().sum::<f64>() / z_squares.len() as f64).sqrt(),
    };
    println!(
        "{name} {mode:?}: relRMSE_trim {:.4}, mean ratio {:.4}, block z deviation {:.2}",
        errors.relative_rmse, errors.mean_ratio, errors.block_z
    );
    Some(errors)
}

#[test]
fn light_shafts_with_traced_shadows_are_within_one_percent() {
    if let Some(errors) = compare("light_shafts", ShadowMode::Traced) {
        assert!(errors.block_z < MAX_BLOCK_Z, "{}", errors.block_z);
        assert!(errors.relative_rmse < 0.01, "{}", errors.relative_rmse);
        assert!(
            (errors.mean_ratio - 1.0).abs() < 0.003,
            "{}",
            errors.mean_ratio
        );
    }
}

#[test]
fn light_shafts_with_shadow_maps_are_within_three_percent() {
    if let Some(errors) = compare("light_shafts", ShadowMode::Mapped) {
        assert!(errors.relative_rmse < 0.03, "{}", errors.relative_rmse);
        assert!(
            (errors.mean_ratio - 1.0).abs() < 0.01,
            "{}",
            errors.mean_ratio
        );
    }
}

#[test]
fn fog_box_with_traced_shadows_is_within_two_percent() {
    if let Some(errors) = compare("fog_box", ShadowMode::Traced) {
        assert!(errors.block_z < MAX_BLOCK_Z, "{}", errors.block_z);
        assert!(errors.relative_rmse < 0.02, "{}", errors.relative_rmse);
        assert!(
            (errors.mean_ratio - 1.0).abs() < 0.005,
            "{}",
            errors.mean_ratio
        );
    }
}

#[test]
fn fog_box_with_shadow_maps_is_within_three_percent() {
    if let Some(errors) = compare("fog_box", ShadowMode::Mapped) {
        assert!(errors.relative_rmse < 0.03, "{}", errors.relative_rmse);
        assert!(
            (errors.mean_ratio - 1.0).abs() < 0.01,
            "{}",
            errors.mean_ratio
        );
    }
}
