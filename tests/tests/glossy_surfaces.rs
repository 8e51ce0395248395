//! Metallic, glossy and normal-mapped surfaces as `single_scattering` shades them, against the path tracer
//! that stops after one scattering, which itself is held to Mitsuba on the same scenes (`surface_truths.rs`).
//!
//! Stated bound: relRMSE without the worst 0.1 % of pixels, the truth's own variance taken off, below 3 %,
//! and means within 1 %: what is left is the technique's own noise under small lights and rounding to half
//! precision in the G-buffer. Under the roughness map the noise alone is 4.6 % at 256 samples; the bound is
//! 6 % there.

#![allow(clippy::print_stdout, reason = "tests print what they measure")]

use std::path::Path;

use serde_json::json;
use tyndall_quality::{mean_ratio, relative_rmse_trim_debiased};
use tyndall_scene::{CorrectionMode, Scene, ShadowMode, StopRule, Technique};
use tyndall_tests::estimate::with_renderer;
use tyndall_tests::gpu;

fn agrees(name: &str, mut scene: Scene, samples: u32, most: f64) {
    scene.render.correction = CorrectionMode::Off;
    scene.render.technique = Technique::Reference;
    scene.render.reference.max_scatterings = Some(1);
    scene.render.stop = StopRule::Samples(1024);
    let truth = with_renderer(|renderer| gpu::render(renderer, scene.clone()));
    let variance = truth.variance.as_ref().expect("the reference knows it");
    let truth = gpu::image(&truth)
        .with_variance(variance.clone())
        .expect("a variance a pixel");
    scene.render.technique = Technique::SingleScattering;
    scene.render.shadows.mode = ShadowMode::Traced;
    scene.render.stop = StopRule::Samples(samples);
    let found = with_renderer(|renderer| gpu::image(&gpu::render(renderer, scene)));
    let error = relative_rmse_trim_debiased(&found, &truth).expect("pictures of one size");
    let ratio = mean_ratio(&found, &truth).expect("pictures of one size");
    println!("{name}: relRMSE_trim {error:.4}, mean ratio {ratio:.4}");
    assert!(error < most, "{name}: {error}");
    assert!((ratio - 1.0).abs() < 0.01, "{name}: {ratio}");
}

fn loaded(name: &str) -> Scene {
    let folder = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/data/surface_truths"));
    let loaded = tyndall_scene::load(&folder.join(format!("{name}.json")));
    loaded.expect("a scene of the tests").scene
}

#[test]
fn metallic_roughness_textures_are_shaded_as_the_path_tracer_does() {
    agrees(
        "metallic_roughness",
        loaded("metallic_roughness"),
        256,
        0.06,
    );
}

#[test]
fn normal_maps_are_shaded_as_the_path_tracer_does() {
    agrees("normal_map", loaded("normal_map"), 256, 0.03);
}

#[test]
fn a_glossy_floor_reflects_lamps_panels_and_the_sky() {
    for (metallic, roughness) in [(0.0, 0.4), (1.0, 0.3), (0.5, 0.7)] {
        let floor = json!({ "kind": "quad", "corner": [-50, 0, 50], "edge_u": [100, 0, 0], "edge_v": [0, 0, -100],
            "material": { "base_color": [0.8, 0.5, 0.3], "metallic": metallic, "roughness": roughness } });
        let panel = json!({ "kind": "quad", "corner": [-1, 1.5, -3], "edge_u": [0, 1, 0], "edge_v": [2, 0, 0],
            "material": { "base_color": 0, "emission": [4, 5, 6] } });
        let scene = gpu::scene(&json!({
            "version": 1,
            "camera": { "position": [0, 1.2, 3], "target": [0, 0, -1], "vertical_fov_degrees": 30 },
            "geometry": [floor, panel],
            "lights": [
                { "kind": "point", "position": [0.5, 1.5, -2], "intensity": [6, 5, 4] },
                { "kind": "environment", "radiance": [0.2, 0.3, 0.5] },
            ],
            "media": [{ "kind": "homogeneous", "sigma_t": 0.05, "albedo": 0.5,
                "bounds": { "min": [-5, -1, -5], "max": [5, 5, 5] } }],
            "render": { "width": 32, "height": 24 },
        }));
        agrees(
            &format!("metallic {metallic}, roughness {roughness}"),
            scene,
            512,
            0.03,
        );
    }
}
