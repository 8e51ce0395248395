//! Pictures against the published images of two independent path tracers: light scattered once, on a
//! surface or in the medium.
//!
//! Stated bounds (relRMSE without the worst 0.1 % of pixels, the images' own variance taken off): 2 %
//! at the high setting, 5 % at the interactive one, where nothing else is said.

use std::time::Instant;

use tyndall_quality::{block_z, mean_ratio, relative_rmse_trim_debiased};
use tyndall_scene::{Scene, ShadowMode, StopRule, Technique};
use tyndall_tests::{gpu, published};

/// Largest deviation of the 300 block z-scores that passes for noise. Their deviation scatters by
/// 1/√600 = 0.04 about 1 and our own noise adds a little: a false alarm is beyond five of those.
const MAX_BLOCK_Z: f64 = 1.25;

struct Errors {
    relative_rmse: f64,
    mean_ratio: f64,
    /// Deviation of the z-scores of 8×8 blocks.
    block_z: f64,
}

/// Converged: traced shadows, equiangular strata.
fn high(scene: &mut Scene) {
    scene.render.stop = StopRule::Samples(256);
    scene.render.single_scattering.steps = 32;
    scene.render.single_scattering.equiangular = true;
    scene.render.shadows.mode = ShadowMode::Traced;
}

/// What a viewer gets within a second or two of a picture that stands still.
fn interactive(scene: &mut Scene) {
    scene.render.stop = StopRule::Samples(16);
    scene.render.single_scattering.steps = 64;
    scene.render.single_scattering.interleave = 4;
    scene.render.single_scattering.equiangular = true;
    scene.render.shadows.mode = ShadowMode::Mapped;
    scene.render.shadows.resolution = 2048;
}

fn compare(name: &str, label: &str, settings: fn(&mut Scene)) -> Option<Errors> {
    let truth = published::find(name, "single")?;
    let mut scene = truth.scene;
    scene.render.technique = Technique::SingleScattering;
    settings(&mut scene);
    let started = Instant::now();
    let image = gpu::image(&gpu::render(&mut gpu::renderer(), scene));
    let seconds = started.elapsed().as_secs_f64();
    let found = (
        relative_rmse_trim_debiased(&image, &truth.image),
        mean_ratio(&image, &truth.image),
        block_z(&image, &truth.image, 8),
    );
    let (Ok(relative_rmse), Ok(mean_ratio), Ok(blocks)) = found else {
        panic!("{name}: {found:?}");
    };
    let errors = Errors {
        relative_rmse,
        mean_ratio,
        block_z: blocks.deviation,
    };
    println!(
        "{name} {label}: relRMSE_trim {relative_rmse:.4}, mean ratio {mean_ratio:.4}, block z deviation {:.2}, {seconds:.1} s with start-up",
        errors.block_z
    );
    Some(errors)
}

fn converged(name: &str) {
    if let Some(errors) = compare(name, "high", high) {
        assert!(errors.block_z < MAX_BLOCK_Z, "{}", errors.block_z);
        assert!(errors.relative_rmse < 0.02, "{}", errors.relative_rmse);
        assert!(
            (errors.mean_ratio - 1.0).abs() < 0.005,
            "{}",
            errors.mean_ratio
        );
    }
}

fn quick(name: &str) {
    if let Some(errors) = compare(name, "interactive", interactive) {
        assert!(errors.relative_rmse < 0.05, "{}", errors.relative_rmse);
        assert!(
            (errors.mean_ratio - 1.0).abs() < 0.01,
            "{}",
            errors.mean_ratio
        );
    }
}

#[test]
fn light_shafts_are_within_two_percent_at_the_high_setting() {
    converged("light_shafts");
}

#[test]
fn fog_box_is_within_two_percent_at_the_high_setting() {
    converged("fog_box");
}

#[test]
fn exponential_fog_is_within_two_percent_at_the_high_setting() {
    converged("exp_fog");
}

#[test]
fn a_smoke_plume_is_within_two_percent_at_the_high_setting() {
    // Not held to noise: the trapezoids along the ray and the light volume are second order in their
    // spacing, and leave 0.6 % (block z deviation 6.4).
    if let Some(errors) = compare("smoke_plume", "high", high) {
        assert!(errors.relative_rmse < 0.02, "{}", errors.relative_rmse);
        assert!(
            (errors.mean_ratio - 1.0).abs() < 0.005,
            "{}",
            errors.mean_ratio
        );
    }
}

#[test]
fn light_shafts_are_within_five_percent_interactively() {
    quick("light_shafts");
}

#[test]
fn fog_box_is_within_five_percent_interactively() {
    quick("fog_box");
}

#[test]
fn exponential_fog_is_within_five_percent_interactively() {
    quick("exp_fog");
}

#[test]
fn a_smoke_plume_is_within_five_percent_interactively() {
    quick("smoke_plume");
}
