//! Distances along a ray: seen from a light, and to collisions.

use glam::{DVec3, Vec3};
use serde_json::json;
use tyndall_render::probe;
use tyndall_tests::chi_squared::{assert_fits, assert_uniform, bin};
use tyndall_tests::gpu;

use super::{AXIS, COUNT, DEVICE, Which, assert_density, sample, with};

#[test]
fn equiangular_distances_are_uniform_in_the_angle_from_the_light() {
    // Where the light is along the ray, how far off it, and the ends: near, far, beside, behind.
    let cases = [
        (2.0, 1.0, 0.0, 10.0),
        (2.0, 1e-3, 0.0, 10.0),
        (5.0, 100.0, 0.0, 10.0),
        (1e4, 3e3, 0.0, 1.0),
        (-3.0, 0.5, 0.0, 20.0),
        (40.0, 0.5, 3.0, 20.0),
        (0.0, 0.2, 0.0, 1e7),
        (4.0, 0.05, 0.0, 1e7),
    ];
    let across = AXIS.any_orthonormal_vector();
    for (seed, (along, off, start, end)) in cases.into_iter().enumerate() {
        let toward = AXIS * along + across * off;
        let parameters = [with(toward, 0.0), with(AXIS, 0.0), [start, end, 0.0, 0.0]];
        // What f32 makes of the geometry is the geometry.
        let (axis, toward) = (AXIS.as_dvec3(), toward.as_dvec3());
        let closest = toward.dot(axis);
        let offset = toward.cross(axis).length();
        let angle = |t: f64| ((t - closest) / offset).atan();
        let (low, high) = (f64::from(start), f64::from(end));
        let (first, last) = (angle(low), angle(high));
        let mut counts = vec![0; 256];
        for [found, _] in sample(Which::Equiangular, 50 + seed as u32, parameters) {
            let t = f64::from(found[0]);
            let slack = 1e-5 * (high - low);
            assert!(
                t >= low - slack && t <= high + slack,
                "{t} outside {low} to {high}"
            );
            let exact = offset / ((last - first) * (offset * offset + (t - closest).powi(2)));
            assert_density("equiangular", found[3], exact, 2e-3);
            let u = ((angle(t) - first) / (last - first)).clamp(0.0, 1.0);
            counts[bin(u, 256)] += 1;
        }
        assert_uniform(&format!("equiangular {along} {off} {start} {end}"), &counts);
    }
}

/// Share of collisions before each of 128 bins' ends, from optical depths in f64, and the test.
fn free_flight(
    name: &str,
    media: &serde_json::Value,
    from: DVec3,
    along: Vec3,
    length: f32,
    depth: &dyn Fn(f64) -> f64,
) {
    let scene = gpu::scene(&json!({
        "version": 1, "camera": { "position": [0, 0, 0], "target": [0, 0, -1] }, "media": media,
    }));
    let values = probe::medium_values(&scene);
    let seed = name.len() as f32;
    let inputs = [with(from.as_vec3(), length), with(along, seed)];
    let buffers: [(&'static str, &[u8]); 2] = [
        ("media", bytemuck::cast_slice(&values)),
        ("inputs", bytemuck::cast_slice(&inputs)),
    ];
    let found = gpu::probe_vec4(&DEVICE, "probe_flight", 1, &buffers, COUNT);
    let through = (-depth(f64::from(length))).exp();
    let bins = 128;
    let mut counts = vec![0; bins + 1];
    let mut expected =
        vec![-(-depth(f64::from(length))).exp_m1() / bins as f64 * COUNT as f64; bins];
    expected.push(through * COUNT as f64);
    for [t, wanted, integral, _] in found {
        if t >= 1e30 {
            counts[bins] += 1;
            continue;
        }
        assert!(t >= 0.0 && t <= length, "{name}: {t} of {length}");
        assert!(
            (integral - wanted).abs() <= 2e-4 * wanted + 2e-6,
            "{name}: the integral to {t} is {integral}, not {wanted}"
        );
        let met = -(-depth(f64::from(t))).exp_m1() / -(-depth(f64::from(length))).exp_m1();
        counts[bin(met.min(1.0), bins)] += 1;
    }
    assert_fits(name, &counts, &expected);
}

#[test]
fn free_flight_in_a_bounded_homogeneous_medium_is_exponential() {
    let media = json!([{ "kind": "homogeneous", "sigma_t": 0.7, "albedo": 0.5,
        "bounds": { "min": [-1, -1, -5], "max": [1, 1, -2] } }]);
    for (name, length) in [("box", 20.0), ("box cut short", 3.0)] {
        let end = f64::from(length).min(5.0);
        free_flight(name, &media, DVec3::ZERO, Vec3::NEG_Z, length, &|t| {
            0.7 * (t.min(end) - 2.0).max(0.0)
        });
    }
}

#[test]
fn free_flight_in_height_fog_follows_its_closed_form_up_down_level_and_from_afar() {
    let (sigma, falloff): (f64, f64) = (0.8, 0.5);
    let media = json!([{ "kind": "height_fog", "sigma_t": sigma, "albedo": 0.5, "falloff": falloff,
        "origin": [0, 0, 0] }]);
    let level = Vec3::new(0.6, 0.0, 0.8);
    for (name, height, along, length) in [
        ("fog up", 1.0, Vec3::new(0.0, 0.6, 0.8), 30.0),
        ("fog down", 6.0, Vec3::new(0.0, -0.6, 0.8), 30.0),
        ("fog level", 1.0, level, 30.0),
        ("fog almost level", 1.0, Vec3::new(0.6, 1e-6, 0.8), 30.0),
        ("fog up without end", -1.0, Vec3::Y, 1e7),
        (
            "fog down from 100 scale heights",
            200.0,
            Vec3::new(0.0, -0.6, 0.8),
            400.0,
        ),
        ("fog down from 1000 scale heights", 2000.0, Vec3::NEG_Y, 1e4),
    ] {
        let climb = f64::from(along.y);
        let depth = |t: f64| {
            let k = falloff * climb * t;
            let mean = if k.abs() < 1e-9 {
                1.0
            } else {
                -(-k).exp_m1() / k
            };
            // e^−bh·(1 − e^−k)/k without overflow where the ray falls far.
            if k < -30.0 {
                sigma * t * (-falloff * height - k).exp() / -k
            } else {
                sigma * t * (-falloff * height).exp() * mean
            }
        };
        free_flight(
            name,
            &media,
            DVec3::new(0.0, height, 0.0),
            along,
            length,
            &depth,
        );
    }
}

#[test]
fn free_flight_in_a_sphere_follows_its_cubic() {
    let media = json!([{ "kind": "sphere", "sigma_t": 3.0, "albedo": 0.5, "center": [0, 0, -6], "radius": 2 }]);
    for (name, from, length) in [
        ("sphere across", DVec3::new(0.5, 0.0, 0.0), 20.0),
        ("sphere at the rim", DVec3::new(1.8, 0.0, 0.0), 20.0),
        ("sphere from inside", DVec3::new(0.2, 0.3, -6.5), 20.0),
        ("sphere cut short", DVec3::new(0.2, 0.3, 0.0), 6.0),
    ] {
        let closest = from.z + 6.0;
        let chord = (4.0 - from.truncate().length_squared()).sqrt();
        // ∫(chord² − u²)/R² du, where u = t − closest.
        let primitive = |u: f64| (chord * chord * u - u * u * u / 3.0) / 4.0;
        let low = (-closest).max(-chord);
        let depth = |t: f64| 3.0 * (primitive((t - closest).clamp(low, chord)) - primitive(low));
        free_flight(name, &media, from, Vec3::NEG_Z, length, &depth);
    }
}
