//! Extremes (algorithms §2 and §7.8): every picture is finite and not negative, which `gpu::render`
//! asserts of each, plain, interleaved, at half resolution, equiangular and with traced shadows.

use serde_json::{Value, json};
use tyndall_scene::{Scene, ShadowMode};
use tyndall_tests::{estimate, gpu};

fn scene(camera: [f64; 3], media: &Value, lights: &Value, geometry: &Value) -> Scene {
    gpu::scene(&json!({
        "version": 1,
        "camera": { "position": camera, "target": [camera[0], camera[1], camera[2] - 1.0], "vertical_fov_degrees": 60 },
        "geometry": geometry, "lights": lights, "media": media,
        "render": { "width": 23, "height": 17, "samples": 3, "single_scattering": { "steps": 32 } },
    }))
}

/// Renders it in every way; returns the mean of the first.
fn mean(scene: &Scene) -> f64 {
    let mut ways = Vec::new();
    for (interleave, equiangular, half) in [
        (1, false, false),
        (4, false, false),
        (2, true, true),
        (1, true, false),
    ] {
        for mode in [ShadowMode::Mapped, ShadowMode::Traced] {
            let mut way = scene.clone();
            way.render.single_scattering.interleave = interleave;
            way.render.single_scattering.equiangular = equiangular;
            way.render.single_scattering.half_resolution = half;
            way.render.shadows.mode = mode;
            way.render.shadows.resolution = 64;
            ways.push(estimate::with_renderer(|renderer| {
                gpu::mean_rgb(&gpu::render(renderer, way))[1]
            }));
        }
    }
    ways[0]
}

fn floor() -> Value {
    json!([{ "kind": "quad", "corner": [-5, -1, 5], "edge_u": [10, 0, 0], "edge_v": [0, 0, -10],
        "material": { "base_color": 0.7 } }])
}

fn fog(sigma_t: f64, g: f64) -> Value {
    json!([{ "kind": "homogeneous", "sigma_t": sigma_t, "albedo": 0.9, "g": g }])
}

#[test]
fn every_depth_and_every_phase_function_is_finite() {
    let lamp = json!([{ "kind": "point", "position": [0.3, 1, -2], "intensity": 5 }]);
    for sigma_t in [1e-6, 1e-2, 1.0, 1e4] {
        for g in [0.0, 0.99, -0.99] {
            let found = mean(&scene([0.0, 0.0, 2.0], &fog(sigma_t, g), &lamp, &floor()));
            assert!(found > 0.0 || sigma_t > 10.0, "sigma {sigma_t} g {g}: dark");
        }
    }
}

#[test]
fn a_light_on_the_ray_in_the_camera_and_outside_of_the_medium_is_finite() {
    let bounded = json!([{ "kind": "homogeneous", "sigma_t": 0.5, "albedo": 0.9, "bounds": { "min": [-1, -1, -3], "max": [1, 1, -1] } }]);
    for position in [
        [0.0, 0.0, -2.0],
        [0.0, 0.0, 2.0],
        [0.0, 0.0, 1.9],
        [0.0, 40.0, 0.0],
    ] {
        for kind in ["point", "spot"] {
            let lamp = if kind == "point" {
                json!([{ "kind": "point", "position": position, "intensity": 5 }])
            } else {
                json!([{ "kind": "spot", "position": position, "direction": [0, 0, -1], "intensity": 5,
                    "inner_angle_degrees": 10, "outer_angle_degrees": 30 }])
            };
            for media in [&bounded, &fog(0.5, 0.3)] {
                mean(&scene([0.0, 0.0, 2.0], media, &lamp, &floor()));
            }
        }
    }
}

#[test]
fn a_grazing_sun_is_finite() {
    for direction in [
        [1.0, -1e-6, 0.0],
        [1.0, 0.0, 0.0],
        [0.0, 0.0, -1.0],
        [0.0, -1.0, 0.0],
    ] {
        let sun = json!([{ "kind": "directional", "direction": direction, "irradiance": 3 }]);
        let media = json!([{ "kind": "height_fog", "sigma_t": 0.3, "albedo": 0.9, "falloff": 0.5,
            "bounds": { "min": [-50, -1, -50], "max": [50, 20, 50] } }]);
        mean(&scene([0.0, 0.0, 2.0], &media, &sun, &floor()));
    }
}

#[test]
fn a_centimetre_in_ten_kilometres_is_finite() {
    let speck = json!([
        { "kind": "quad", "corner": [-5000, -1, 5000], "edge_u": [10000, 0, 0], "edge_v": [0, 0, -10000], "material": { "base_color": 0.7 } },
        { "kind": "box", "min": [0, 0, -2], "max": [0.01, 0.01, -1.99], "material": { "base_color": 0.5 } }]);
    let lights = json!([
        { "kind": "point", "position": [0, 0.02, -1.9], "intensity": 5 },
        { "kind": "directional", "direction": [0.3, -1, 0.1], "irradiance": 3 }]);
    let media = json!([{ "kind": "homogeneous", "sigma_t": 1e-4, "albedo": 0.9, "g": 0.8,
        "bounds": { "min": [-5000, -1, -5000], "max": [5000, 1000, 5000] } }]);
    let found = mean(&scene([0.0, 0.0, 2.0], &media, &lights, &speck));
    assert!(found > 0.0);
}
