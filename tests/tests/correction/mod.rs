//! The corrected picture against the published images of two independent path tracers, with real samples.

#![allow(clippy::print_stdout, reason = "tests print what they measure")]

mod calibration;
mod gains;
mod limit;
mod motion;
mod places;
mod sizes;
mod spread;
mod stress;

use tyndall_scene::{Scene, ShadowMode, Technique};

/// As on the page: mapped shadows, interleaved strata.
pub(crate) fn interactive(scene: &mut Scene) {
    scene.render.technique = Technique::SingleScattering;
    scene.render.single_scattering.steps = 64;
    scene.render.single_scattering.interleave = 4;
    scene.render.single_scattering.equiangular = true;
    scene.render.shadows.mode = ShadowMode::Mapped;
    scene.render.shadows.resolution = 2048;
}
