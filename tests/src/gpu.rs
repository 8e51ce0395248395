//! Rendering in tests: an opened device, small scenes, small pictures.

use std::sync::Arc;

use glam::DVec3;
use tyndall_quality::Image;
use tyndall_render::{Device, DeviceOptions, Renderer, Still, probe};
use tyndall_scene::description::render::CorrectionMode;
use tyndall_scene::{Loaded, Scene, SceneDescription};

use crate::probes;

/// Opens the best adapter there is: the software driver, unless a test machine has a GPU.
pub fn device() -> Device {
    Device::open(&DeviceOptions::default())
        .expect("a Vulkan driver is needed: apt install mesa-vulkan-drivers")
}

/// A renderer on [`device`].
pub fn renderer() -> Renderer {
    Renderer::new(device()).expect("the device was just opened")
}

/// Builds a scene from JSON text without files.
pub fn scene(json: &serde_json::Value) -> Scene {
    loaded(json).scene
}

/// Builds a scene with its description from JSON text without files.
pub fn loaded(json: &serde_json::Value) -> Loaded {
    let mut description =
        SceneDescription::from_json(&json.to_string()).expect("the test's scene parses");
    // Tests are about a technique's own picture unless they say otherwise.
    let correction = &mut description.render.correction;
    correction.get_or_insert(CorrectionMode::Off);
    let march = &mut description.render.single_scattering;
    if march.interleave == 0 {
        march.interleave = 1;
    }
    tyndall_scene::build(description, None).expect("the test's scene is valid")
}

/// Renders a scene at its own size to its own stop rule; fails on any non-finite or negative sample.
pub fn render(renderer: &mut Renderer, scene: Scene) -> Still {
    let (width, height) = (scene.render.width, scene.render.height);
    let mut view = renderer
        .create_view(Arc::new(scene), width, height)
        .expect("the scene is rendered");
    let still = renderer
        .render_still(&mut view, |_| {})
        .expect("the picture is rendered");
    assert_eq!(still.non_finite, 0, "non-finite samples");
    assert_eq!(still.negative, 0, "negative samples");
    still
}

/// Mean of a pixel block's RGB.
pub fn mean_rgb(still: &Still) -> [f64; 3] {
    let n = still.radiance.len() as f64;
    std::array::from_fn(|c| still.radiance.iter().map(|p| f64::from(p[c])).sum::<f64>() / n)
}

/// The linear picture of a still, as measures take it.
pub fn image(still: &Still) -> Image {
    Image::from_rgba(still.frame.width, still.frame.height, &still.radiance)
        .expect("a still has its pixels")
}

/// Runs the probe `name` built for `medium_count` media and returns `count` vectors.
pub fn probe_vec4(
    device: &Device,
    name: &str,
    medium_count: u32,
    buffers: &[(&'static str, &[u8])],
    count: usize,
) -> Vec<[f32; 4]> {
    let workgroups = (count as u32).div_ceil(64);
    let bytes = probe::run(
        device,
        probes::named(name),
        medium_count,
        buffers,
        count as u64 * 16,
        workgroups,
    )
    .expect("the probe runs");
    bytemuck::pod_collect_to_vec(&bytes)
}

/// |found − expected| relative to `expected`.
pub fn relative_error(found: f32, expected: f64) -> f64 {
    (f64::from(found) - expected).abs() / expected.abs().max(1e-30)
}

/// Origins, directions and lengths that fill a cube of half-side `spread`.
pub fn random_segments(count: usize, spread: f64) -> Vec<(DVec3, DVec3, f64)> {
    // A small LCG: the test needs variety, not quality.
    let mut state = 12345_u64;
    let mut next = || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64 * 2.0 - 1.0
    };
    (0..count)
        .map(|_| {
            let origin = DVec3::new(next(), next(), next()) * spread;
            let direction = DVec3::new(next(), next(), next()).normalize_or(DVec3::X);
            (origin, direction, (next().abs() + 0.01) * 3.0 * spread)
        })
        .collect()
}
