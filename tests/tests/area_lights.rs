//! Light of emissive triangles and of the environment, scattered once: closed forms, and the path
//! tracer restricted to one scattering.
//!
//! Pictures of the same scene with [`SEEDS`] seeds give every block of pixels a standard error of its
//! own. Against the path tracer's blocks and their variances |t| ≤ [`MOST`] with 15 degrees of
//! freedom: noise alone exceeds it once in 30,000 comparisons, in one of 100 runs of this file; the seeds are
//! fixed.

#![allow(clippy::print_stdout, reason = "tests print what they measure")]

use std::f64::consts::PI;
use std::sync::Arc;

use serde_json::{Value, json};
use tyndall_render::Still;
use tyndall_scene::{Environment, EnvironmentMap, Scene, ShadowMode, StopRule, Technique};
use tyndall_tests::estimate::with_renderer;
use tyndall_tests::gpu;

const SEEDS: u32 = 16;
const MOST: f64 = 5.8;
/// Side of a picture and of a block. Unit: pixel.
const SIDE: usize = 16;
const BLOCK: usize = 8;

fn still(scene: Scene) -> Still {
    with_renderer(|renderer| gpu::render(renderer, scene))
}

/// Looks down on the origin from (0, 3, 3); no edge of the wide floor is in the picture.
fn scene(geometry: &Value, lights: &Value, media: &Value) -> Value {
    json!({
        "version": 1,
        "camera": { "position": [0.2, 3, 3], "target": [0, 0.2, 0], "vertical_fov_degrees": 40 },
        "geometry": geometry, "lights": lights, "media": media,
        "render": { "technique": "single_scattering", "width": SIDE, "height": SIDE,
            "shadows": { "mode": "traced" } },
    })
}

fn floor() -> Value {
    json!({ "kind": "quad", "corner": [-50, 0, 50], "edge_u": [100, 0, 0], "edge_v": [0, 0, -100],
        "material": { "base_color": 0.5 } })
}

/// Means of the blocks, of green where the scene is grey; of all channels they are compared one by one.
fn blocks(value: impl Fn(usize) -> f64) -> Vec<f64> {
    let across = SIDE / BLOCK;
    let mean = |block: usize| {
        let (x, y) = (block % across * BLOCK, block / across * BLOCK);
        let pixels = (0..BLOCK * BLOCK).map(|i| (y + i / BLOCK) * SIDE + x + i % BLOCK);
        pixels.map(&value).sum::<f64>() / (BLOCK * BLOCK) as f64
    };
    (0..across * across).map(mean).collect()
}

/// Holds a scene to the path tracer that stops after one scattering.
fn agrees(name: &str, mut scene: Scene, samples: u32, truth_samples: u32) {
    let mut truth = scene.clone();
    truth.render.technique = Technique::Reference;
    truth.render.reference.max_scatterings = Some(1);
    truth.render.stop = StopRule::Samples(truth_samples);
    let truth = still(truth);
    assert_eq!(truth.truncated, 0, "{name}");
    scene.render.stop = StopRule::Samples(samples);
    let pictures: Vec<Still> = (0..SEEDS)
        .map(|seed| {
            scene.render.seed = u64::from(seed) + 7;
            still(scene.clone())
        })
        .collect();
    let variance = truth.variance.as_ref().expect("the reference knows it");
    let mut greatest = 0.0_f64;
    let (mut sum, mut truth_sum) = (0.0, 0.0);
    for c in [0, 1, 2] {
        let expected = blocks(|i| f64::from(truth.radiance[i][c]));
        let noise = blocks(|i| f64::from(variance[i][c]));
        let found: Vec<Vec<f64>> = pictures
            .iter()
            .map(|picture| blocks(|i| f64::from(picture.radiance[i][c])))
            .collect();
        for (block, expected) in expected.iter().enumerate() {
            let n = f64::from(SEEDS);
            let mean = found.iter().map(|blocks| blocks[block]).sum::<f64>() / n;
            let squares = found.iter().map(|blocks| (blocks[block] - mean).powi(2));
            let own = squares.sum::<f64>() / (n * (n - 1.0));
            let others = noise[block] / (BLOCK * BLOCK) as f64;
            // What rounding to half precision in the G-buffer may change.
            let off = ((mean - expected).abs() - 1e-4 * expected).max(0.0);
            greatest = greatest.max(off / (own + others).sqrt().max(1e-30));
            sum += mean;
            truth_sum += expected;
        }
    }
    println!(
        "{name}: greatest |t| {greatest:.2}, mean ratio {:.4}",
        sum / truth_sum
    );
    assert!(truth_sum > 0.0, "{name}: black");
    assert!(greatest <= MOST, "{name}: {greatest}");
    // The noise does not hide everything.
    assert!((sum / truth_sum - 1.0).abs() < 0.02, "{name}");
}

#[test]
fn a_white_sky_on_a_grey_floor_gives_its_reflectance() {
    let sky = json!([{ "kind": "environment", "radiance": 2 }]);
    let mut scene = gpu::scene(&scene(&json!([floor()]), &sky, &json!([])));
    scene.render.stop = StopRule::Samples(4);
    for pixel in still(scene).radiance {
        // Without noise; the G-buffer keeps the reflectance in half precision.
        assert!((pixel[1] - 1.0).abs() < 5e-4, "{pixel:?}");
    }
}

#[test]
fn what_only_absorbs_is_seen_against_the_sky_alone() {
    let sky = json!([{ "kind": "environment", "radiance": 3 }]);
    let ball = json!([{ "kind": "sphere", "sigma_s": 0, "sigma_a": 1.5, "center": [0, 0.2, 0], "radius": 1 }]);
    let mut scene = gpu::scene(&scene(&json!([]), &sky, &ball));
    scene.render.stop = StopRule::Samples(2);
    let radiance = still(scene).radiance;
    for pixel in &radiance {
        assert!((pixel[1] - 3.0 * pixel[3]).abs() < 1e-5, "{pixel:?}");
    }
    let middle = radiance[SIDE * SIDE / 2 + SIDE / 2][1];
    assert!(middle < 0.2 * 3.0, "{middle}: a depth of about 2");
}

/// Depth of a soft ball of radius 1 and central extinction `sigma`, from a point at `x` on its diameter
/// up to its surface, at an angle of cosine `cosine` to the diameter.
fn depth(sigma: f64, x: f64, cosine: f64) -> f64 {
    // ∫(1 − r²) from u = x·cosine to the end of the chord.
    let squared = 1.0 - x * x * (1.0 - cosine * cosine);
    let (start, end) = (x * cosine, squared.sqrt());
    sigma * (squared * (end - start) - (end.powi(3) - start.powi(3)) / 3.0)
}

#[test]
fn a_soft_ball_under_a_white_sky_has_its_closed_form() {
    let (sigma, sky) = (1.5, 2.0);
    for g in [0.0, 0.8, -0.8] {
        // Light from every direction, scattered once on the diameter, in f64.
        // The midpoint rule; the lobe's peak needs fine steps.
        let (places, cosines) = (200, 8000);
        let midpoint = |i: i32, n: i32| 2.0 * (f64::from(i) + 0.5) / f64::from(n) - 1.0;
        let mut scattered = 0.0;
        for x in (0..places).map(|i| midpoint(i, places)) {
            let to_eye = depth(sigma, x, -1.0);
            let arriving: f64 = (0..cosines)
                .map(|i| midpoint(i, cosines))
                .map(|cosine| {
                    let phase =
                        (1.0 - g * g) / (4.0 * PI * (1.0 + g * g - 2.0 * g * cosine).powf(1.5));
                    2.0 * PI * phase * (-depth(sigma, x, cosine)).exp() * 2.0 / f64::from(cosines)
                })
                .sum();
            scattered +=
                0.9 * sigma * (1.0 - x * x) * (-to_eye).exp() * arriving * 2.0 / f64::from(places);
        }
        let through = (-depth(sigma, -1.0, 1.0)).exp();
        let expected = sky * (through + scattered);
        let scene = gpu::scene(&json!({
            "version": 1,
            "camera": { "position": [0, 0, 5], "target": [0, 0, 0], "vertical_fov_degrees": 0.1 },
            "lights": [{ "kind": "environment", "radiance": sky }],
            "media": [{ "kind": "sphere", "sigma_t": sigma, "albedo": 0.9, "g": g, "center": [0, 0, 0], "radius": 1 }],
            "render": { "technique": "single_scattering", "width": SIDE, "height": SIDE, "samples": 64 },
        }));
        let radiance = still(scene).radiance;
        let n = radiance.len() as f64;
        let mean = radiance.iter().map(|p| f64::from(p[1])).sum::<f64>() / n;
        let squares = radiance.iter().map(|p| (f64::from(p[1]) - mean).powi(2));
        let error = (squares.sum::<f64>() / (n * (n - 1.0))).sqrt();
        println!("ball g {g}: {mean:.6} ± {error:.1e} for {expected:.6}");
        // 4 standard errors, one false alarm in 16,000; 1e-4 for the width of the picture and rounding.
        assert!((mean - expected).abs() < 4.0 * error + 1e-4 * expected);
        assert!(error < 0.002 * expected, "the noise would hide an error");
    }
}

/// A one-sided panel above the floor that shines down, and a plate in its way: the camera looks through
/// the backs of both, so no edge is in the picture, whose samples all seeds share.
fn panel() -> Value {
    json!([floor(),
        { "kind": "quad", "corner": [-1.5, 2.2, -1.2], "edge_u": [1.2, 0, 0], "edge_v": [0, 0, 1.4],
          "material": { "base_color": 0, "emission": [5, 4, 2] } },
        { "kind": "quad", "corner": [-1, 0.8, -0.6], "edge_u": [0.5, 0, 0], "edge_v": [0, 0, 1],
          "material": { "base_color": 0.3 } }])
}

fn fog(g: f64) -> Value {
    json!({ "kind": "height_fog", "sigma_t": [0.2, 0.3, 0.4], "albedo": 0.9, "g": g, "falloff": 0.4,
        "bounds": { "min": [-6, 0, -6], "max": [6, 6, 6] } })
}

fn smoke(g: f64) -> Value {
    json!({ "kind": "procedural", "pattern": "cloud", "resolution": 16, "seed": 3, "sigma_t": [3, 4, 5], "albedo": 0.8, "g": g,
        "transform": { "scale": 2.5, "translation": [-0.3, 0.2, 0] } })
}

#[test]
fn an_emissive_panel_agrees_with_the_path_tracer_in_vacuum_and_fog() {
    let none = json!([]);
    agrees(
        "panel",
        gpu::scene(&scene(&panel(), &none, &none)),
        64,
        8192,
    );
    for g in [0.0, 0.8, -0.8] {
        let scene = scene(&panel(), &none, &json!([fog(g)]));
        agrees(
            &format!("panel, fog of g {g}"),
            gpu::scene(&scene),
            64,
            8192,
        );
    }
}

#[test]
fn an_emissive_panel_agrees_with_the_path_tracer_in_a_grid() {
    let none = json!([]);
    let inside = scene(&panel(), &none, &json!([smoke(0.5)]));
    agrees("panel in smoke", gpu::scene(&inside), 16, 1024);
    let both = scene(&panel(), &none, &json!([fog(-0.5), smoke(0.0)]));
    agrees("panel in smoke and fog", gpu::scene(&both), 16, 1024);
}

/// A map with a bright spot low in the sky, dim below.
fn map() -> EnvironmentMap {
    let (width, height) = (16, 8);
    let pixel = |i: u32| {
        let (x, y) = (i % width, i / width);
        let spot = if (x, y) == (11, 2) { 30.0 } else { 0.0 };
        [
            0.5 + spot,
            0.4 + 0.05 * y as f32 + spot,
            0.3 + 0.02 * x as f32,
        ]
    };
    let pixels = (0..width * height).map(pixel).collect();
    EnvironmentMap {
        width,
        height,
        pixels: Arc::new(pixels),
    }
}

fn sky_over(geometry: &Value, media: &Value) -> Scene {
    let sky = json!([{ "kind": "environment", "radiance": [1, 2, 3] }]);
    gpu::scene(&scene(geometry, &sky, media))
}

fn map_over(geometry: &Value, media: &Value) -> Scene {
    let mut scene = sky_over(geometry, media);
    scene.environment = Some(Environment {
        radiance: [1.0, 0.9, 0.8],
        map: Some(map()),
        rotation: 0.6,
    });
    scene
}

/// Each is kernels of its own, whose building takes longer than the pictures.
#[test]
fn a_constant_sky_over_a_shaded_floor_in_fog_agrees_with_the_path_tracer() {
    let scene = sky_over(&json!([floor(), panel()[2]]), &json!([fog(0.8)]));
    agrees("sky, fog over a floor", scene, 16, 1024);
}

#[test]
fn an_environment_map_over_a_shaded_floor_in_smoke_agrees_with_the_path_tracer() {
    let scene = map_over(&json!([floor(), panel()[2]]), &json!([smoke(-0.8)]));
    agrees("map, smoke over a floor", scene, 16, 1024);
}

#[test]
fn skies_agree_with_the_path_tracer_in_smoke_and_fog() {
    let media = json!([smoke(0.6), fog(-0.6)]);
    agrees("sky, smoke in fog", sky_over(&json!([]), &media), 16, 1024);
    agrees("map, smoke in fog", map_over(&json!([]), &media), 16, 1024);
}

#[test]
fn shadows_that_are_off_let_the_sky_in() {
    let sky = json!([{ "kind": "environment", "radiance": 2 }]);
    let lid = json!([floor(), { "kind": "box", "min": [-50, 4, -50], "max": [50, 5, 50] }]);
    let mut scene = gpu::scene(&scene(&lid, &sky, &json!([])));
    scene.render.stop = StopRule::Samples(4);
    let green = |scene: Scene| gpu::mean_rgb(&still(scene))[1];
    assert!(green(scene.clone()) < 0.2, "below a lid");
    scene.render.shadows.mode = ShadowMode::Off;
    assert!((green(scene) - 1.0).abs() < 5e-4);
}
