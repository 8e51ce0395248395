//! The filter of the picture: against exact kernels, closed forms, conservation, and published images.

#![allow(clippy::print_stdout, reason = "tests print what they measure")]

mod conservation;
mod presets;
mod remedies;
mod skips;
mod spread;
mod truth;
mod width;

use serde_json::{Value, json};
use tyndall_quality::relative_rmse;
use tyndall_render::Still;
use tyndall_scene::{LevelFetch, Scene, ScreenSpaceFilter, Technique};
use tyndall_tests::{estimate, gpu};

/// Looks along −z from 10 m at what stands in the plane z = 0, 1 m high, so narrowly that distances hardly
/// differ: `geometry` behind `media`, without lights, 64×64 pixels, one sample in their middles.
fn narrow(geometry: &Value, media: &Value) -> Scene {
    let mut scene = gpu::scene(&json!({
        "version": 1,
        "camera": { "position": [0, 0, 10], "target": [0, 0, 0], "vertical_fov_degrees": 5.724_810_452 },
        "geometry": geometry, "media": media,
        "render": { "width": 64, "height": 64, "samples": 1,
            "shadows": { "mode": "off" } },
    }));
    scene.render.technique = Technique::ScreenSpace;
    scene.render.screen_space.in_scatter = false;
    scene
}

/// A black wall of emitting squares: corner, side and radiance of each.
fn panels(panels: &[([f64; 3], f64, f64)]) -> Value {
    let quads = panels.iter().map(|(corner, side, radiance)| {
        json!({ "kind": "quad", "corner": corner, "edge_u": [side, 0, 0], "edge_v": [0, side, 0],
            "material": { "base_color": 0.0, "emission": radiance } })
    });
    Value::Array(quads.collect())
}

fn fog(sigma_s: f64, sigma_a: f64, g: f64) -> Value {
    json!([{ "kind": "homogeneous", "sigma_s": sigma_s, "sigma_a": sigma_a, "g": g }])
}

fn render(scene: Scene) -> Still {
    let still = estimate::with_renderer(|renderer| gpu::render(renderer, scene));
    let bad = still
        .radiance
        .iter()
        .flatten()
        .filter(|v| !v.is_finite() || **v < 0.0);
    assert_eq!(bad.count(), 0, "values that are not finite or negative");
    still
}

fn with_filter(scene: &Scene, filter: ScreenSpaceFilter) -> Scene {
    let mut scene = scene.clone();
    scene.render.screen_space.filter = filter;
    scene
}

/// Relative difference of two pictures.
fn differ(a: &Still, b: &Still) -> f64 {
    relative_rmse(&gpu::image(a), &gpu::image(b)).expect("same size")
}

/// Every filter, with each way to read levels.
fn every_filter(scene: &Scene) -> Vec<(String, Scene)> {
    let mut all = vec![
        (
            "splat".to_owned(),
            with_filter(scene, ScreenSpaceFilter::Splat),
        ),
        (
            "gather".to_owned(),
            with_filter(scene, ScreenSpaceFilter::Gather),
        ),
    ];
    for fetch in [
        LevelFetch::LinearBilinear,
        LevelFetch::LinearBicubic,
        LevelFetch::CubicBicubic,
    ] {
        let mut scene = with_filter(scene, ScreenSpaceFilter::Hierarchical);
        scene.render.screen_space.fetch = fetch;
        all.push((format!("hierarchical {fetch:?}"), scene));
    }
    all
}
