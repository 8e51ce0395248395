//! Pictures against the published images of two independent path tracers: all orders of scattering.

use tyndall_quality::{mean_ratio, relative_rmse_trim_debiased};
use tyndall_scene::{Scene, StopRule, Technique};
use tyndall_tests::{gpu, published};

use super::render;

/// Error and mean of a technique at 16 samples.
fn error(scene: &Scene, technique: Technique, truth: &tyndall_quality::Image) -> (f64, f64) {
    let mut scene = scene.clone();
    scene.render.technique = technique;
    scene.render.stop = StopRule::Samples(16);
    let image = gpu::image(&render(scene));
    let error = relative_rmse_trim_debiased(&image, truth).expect("same size");
    (error, mean_ratio(&image, truth).expect("same size"))
}

#[test]
fn the_filtered_picture_is_nearer_to_the_whole_truth_than_single_scattering() {
    for name in ["fog_box", "light_shafts", "smoke_plume"] {
        let Some(truth) = published::find(name, "full") else {
            return;
        };
        let (single, single_mean) = error(&truth.scene, Technique::SingleScattering, &truth.image);
        let (filtered, mean) = error(&truth.scene, Technique::ScreenSpace, &truth.image);
        println!(
            "{name}: screen_space {filtered:.3} (mean {mean:.3}), single_scattering {single:.3} (mean {single_mean:.3})"
        );
        assert!(filtered < single, "{name}: {filtered} for {single}");
    }
}
