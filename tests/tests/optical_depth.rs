//! Closed-form optical depths on a device against quadrature in f64.

#![allow(clippy::print_stdout, reason = "tests print what they measure")]

use glam::DVec3;
use serde_json::json;
use tyndall_render::{Device, probe};
use tyndall_shaders::types::Medium;
use tyndall_tests::gpu;

/// Optical depths of the scene's media on the device.
fn optical_depths(device: &Device, media: &[Medium], segments: &[[f32; 4]]) -> Vec<[f32; 4]> {
    gpu::probe_vec4(
        device,
        "probe_optical_depth",
        media.len() as u32,
        &[
            ("media", bytemuck::cast_slice(media)),
            ("inputs", bytemuck::cast_slice(segments)),
        ],
        segments.len() / 2,
    )
}

fn fog_scene(media: &serde_json::Value) -> tyndall_scene::Scene {
    gpu::scene(&json!({
        "version": 1,
        "camera": { "position": [0, 0, 0], "target": [0, 0, -1] },
        "media": media,
    }))
}

/// Midpoint quadrature of a density along a segment.
fn quadrature(density: impl Fn(DVec3) -> f64, origin: DVec3, direction: DVec3, length: f64) -> f64 {
    let n = 40_000;
    let step = length / f64::from(n);
    (0..n)
        .map(|i| density(origin + direction * ((f64::from(i) + 0.5) * step)) * step)
        .sum()
}

fn compare_with_quadrature(
    media: &serde_json::Value,
    density: impl Fn(DVec3) -> f64,
    sigma_t: DVec3,
    tolerance: f64,
) {
    let device = gpu::device();
    let values = probe::medium_values(&fog_scene(media));
    let segments = gpu::random_segments(60, 3.0);
    let inputs: Vec<[f32; 4]> = segments
        .iter()
        .flat_map(|(o, d, l)| {
            let (o, d) = (o.as_vec3(), d.as_vec3());
            [[o.x, o.y, o.z, *l as f32], [d.x, d.y, d.z, 0.0]]
        })
        .collect();
    let found = optical_depths(&device, &values, &inputs);
    for ((origin, direction, length), tau) in segments.iter().zip(&found) {
        let integral = quadrature(&density, *origin, *direction, *length);
        for c in 0..3 {
            let expected = sigma_t[c] * integral;
            let error = (f64::from(tau[c]) - expected).abs();
            assert!(
                error <= tolerance * expected.max(1e-3),
                "{origin} {direction} {length}: {} for {expected}",
                tau[c]
            );
        }
    }
}

#[test]
fn optical_depth_of_a_bounded_homogeneous_medium_matches_quadrature() {
    let media = json!([{ "kind": "homogeneous", "sigma_s": [0.2, 0.3, 0.4], "sigma_a": 0.1,
        "bounds": { "min": [-1, -2, -1], "max": [2, 1, 1.5] } }]);
    let inside = |p: DVec3| {
        f64::from(u8::from(
            p.cmpge(DVec3::new(-1.0, -2.0, -1.0)).all() && p.cmple(DVec3::new(2.0, 1.0, 1.5)).all(),
        ))
    };
    compare_with_quadrature(&media, inside, DVec3::new(0.3, 0.4, 0.5), 2e-3);
}

#[test]
fn optical_depth_of_height_fog_matches_quadrature() {
    let media = json!([{ "kind": "height_fog", "sigma_t": [0.5, 0.6, 0.7], "albedo": 0.9, "falloff": 0.7,
        "up": [0.6, 0.8, 0.0], "origin": [0.3, -0.5, 0.1] }]);
    let up = DVec3::new(0.6, 0.8, 0.0);
    let density = |p: DVec3| (-0.7 * (p - DVec3::new(0.3, -0.5, 0.1)).dot(up)).exp();
    compare_with_quadrature(&media, density, DVec3::new(0.5, 0.6, 0.7), 1e-4);
}

#[test]
fn optical_depth_of_a_sphere_matches_quadrature() {
    let media = json!([{ "kind": "sphere", "sigma_t": 2.0, "albedo": 0.5, "center": [0.5, 0.2, -0.3], "radius": 2.5 }]);
    let density =
        |p: DVec3| (1.0 - (p - DVec3::new(0.5, 0.2, -0.3)).length_squared() / 6.25).max(0.0);
    compare_with_quadrature(&media, density, DVec3::splat(2.0), 1e-4);
}

#[test]
fn optical_depths_of_overlapping_media_add_up() {
    let media = json!([
        { "kind": "homogeneous", "sigma_s": 0.1, "sigma_a": 0.0 },
        { "kind": "sphere", "sigma_t": 1.0, "albedo": 0.5, "center": [0, 0, 0], "radius": 2.0 },
    ]);
    let density = |p: DVec3| 0.1 + (1.0 - p.length_squared() / 4.0).max(0.0);
    compare_with_quadrature(&media, density, DVec3::ONE, 1e-4);
}

#[test]
fn a_horizontal_ray_through_height_fog_is_exact_where_the_textbook_form_divides_by_zero() {
    let device = gpu::device();
    let values = probe::medium_values(&fog_scene(&json!([
        { "kind": "height_fog", "sigma_t": 1.0, "albedo": 1.0, "falloff": 0.5, "origin": [0, 0, 0] }
    ])));
    for tilt in [0.0_f32, 1e-7, 1e-6, -1e-6] {
        let input = [[0.0_f32, 1.0, 0.0, 4.0], [1.0, tilt, 0.0, 0.0]];
        let tau = optical_depths(&device, &values, &input)[0][0];
        assert!(
            gpu::relative_error(tau, 4.0 * (-0.5_f64).exp()) < 3e-5,
            "tilt {tilt}: {tau}"
        );
    }
}

#[test]
fn a_ray_down_into_thick_fog_from_far_above_stays_finite() {
    let device = gpu::device();
    let values = probe::medium_values(&fog_scene(&json!([
        { "kind": "height_fog", "sigma_t": 10.0, "albedo": 1.0, "falloff": 5.0, "origin": [0, 0, 0] }
    ])));
    let input = [
        [0.0_f32, 0.0, 0.0, 1e7],
        [0.0, -1.0, 0.0, 0.0],
        [0.0, 1e6, 0.0, 1e7],
        [0.0, 1.0, 0.0, 0.0],
    ];
    let tau = optical_depths(&device, &values, &input);
    assert!(
        tau[0][0].is_finite() && tau[0][0] > 1e4,
        "down: {}",
        tau[0][0]
    );
    assert!((0.0..1e-6).contains(&tau[1][0]), "up: {}", tau[1][0]);
}

#[test]
fn density_integrals_on_the_device_are_those_on_the_cpu() {
    let device = gpu::device();
    let mut worst = 0.0_f64;
    for falloff in [0.0, 1e-6, 1e-3, 0.3, 5.0, 100.0, 1e3] {
        let scene = fog_scene(
            &json!([{ "kind": "height_fog", "sigma_s": 1.0, "sigma_a": 0.0,
            "falloff": falloff, "up": [0.6, 0.8, 0.0], "origin": [0.3, -0.5, 0.1] }]),
        );
        let values = probe::medium_values(&scene);
        let up = DVec3::new(0.6, 0.8, 0.0);
        let mut segments = Vec::new();
        for tilt in [0.0, 1e-7, -1e-7, 1e-3, -0.02, 0.5, -0.5, 1.0, -1.0] {
            for height in [-0.5, 0.0, 0.7, 3.0] {
                let across = DVec3::new(-0.8, 0.6, 0.0) * f64::sqrt(1.0 - tilt * tilt);
                let direction = (across + up * tilt).as_vec3();
                let scale = 1.0 / f64::max(1.0, falloff);
                let origin = (up * (height * scale)).as_vec3();
                segments.push((origin, direction, (6.0 * scale) as f32));
            }
        }
        let inputs: Vec<[f32; 4]> = segments
            .iter()
            .flat_map(|(o, d, l)| [[o.x, o.y, o.z, *l], [d.x, d.y, d.z, 0.0]])
            .collect();
        let found = optical_depths(&device, &values, &inputs);
        for ((origin, direction, length), tau) in segments.iter().zip(&found) {
            // The device's unit vectors are rounded: their length counts on the CPU as well.
            let own = direction.as_dvec3();
            let stretch = own.length();
            let shape = &scene.media[0].shape;
            let length = f64::from(*length) * stretch;
            let integral = shape.density_integral(origin.as_dvec3(), own / stretch, length);
            let expected = integral.expect("fog has a closed form") / stretch;
            let lowest = (origin.as_dvec3() - DVec3::new(0.3, -0.5, 0.1)).dot(up);
            let lowest = lowest.min(lowest + own.dot(up) * length);
            // Rounding the exponent of e^x in f32 costs |x| times the rounding of 1.
            let exponent = (falloff * lowest).abs().max(1.0);
            let error = gpu::relative_error(tau[0], expected) / exponent;
            worst = worst.max(error);
            assert!(
                error < 1e-6,
                "falloff {falloff}, {origin} {direction}: {} for {expected}",
                tau[0]
            );
        }
    }
    println!("largest relative error, in units of the exponent: {worst:.1e}");
}
