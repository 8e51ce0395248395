//! The fluence that an isotropic source at A causes at B is the one that it causes at A from B,
//! whatever is around.

use std::f64::consts::PI;

use glam::DVec3;
use serde_json::{Value, json};
use tyndall_tests::estimate::{self, Estimate};

const SIZE: u32 = 12;

/// Scattered radiance at `at` over all directions, of a source at `from`.
fn fluence(
    from: DVec3,
    at: DVec3,
    media: &Value,
    geometry: &Value,
    samples: u32,
    seed: u32,
) -> Estimate {
    let axes = [
        (DVec3::X, DVec3::Y),
        (DVec3::NEG_X, DVec3::Y),
        (DVec3::Y, DVec3::Z),
        (DVec3::NEG_Y, DVec3::Z),
        (DVec3::Z, DVec3::Y),
        (DVec3::NEG_Z, DVec3::Y),
    ];
    let mut sum = Estimate {
        mean: [0.0; 3],
        error: [0.0; 3],
    };
    for (face, (direction, up)) in axes.into_iter().enumerate() {
        let still = estimate::render(&json!({
            "version": 1,
            "camera": { "position": at, "target": at + direction, "up": up, "vertical_fov_degrees": 90 },
            "geometry": geometry, "media": media,
            "lights": [{ "kind": "point", "position": from, "intensity": 1.0 / (4.0 * PI), "radius": 1e-3 }],
            "render": { "technique": "reference", "width": SIZE, "height": SIZE, "samples": samples,
                "seed": 10 * seed + face as u32 },
        }));
        let weight = |pixel: usize| {
            let place = |i: usize| 2.0 * (i as f64 + 0.5) / f64::from(SIZE) - 1.0;
            let (x, y) = (place(pixel % SIZE as usize), place(pixel / SIZE as usize));
            (2.0 / f64::from(SIZE)).powi(2) / (1.0 + x * x + y * y).powf(1.5)
        };
        // The midpoint rule's weights, brought to the face's 4π/6.
        let total: f64 = (0..(SIZE * SIZE) as usize).map(weight).sum();
        sum = sum.plus(Estimate::of_weighted_pixels(&still, |i| {
            weight(i) * 4.0 * PI / 6.0 / total
        }));
    }
    sum
}

#[test]
fn fluence_is_the_same_when_source_and_receiver_change_places() {
    // Both stand in clear air: next to a source or a receiver, scattered light is all noise.
    let ball = json!({ "kind": "sphere", "sigma_t": 3, "albedo": 0.95, "g": -0.4, "center": [0.6, 0.1, 0.1], "radius": 0.8 });
    let cube = json!({ "kind": "homogeneous", "sigma_t": 1.5, "albedo": 0.9, "g": 0.7,
        "bounds": { "min": [-1, -0.8, -1], "max": [0.2, 0.7, 1] } });
    let media = json!([ball, cube]);
    let (a, b) = (DVec3::new(-1.6, 0.3, 0.2), DVec3::new(1.7, 0.6, -0.4));
    let floor = json!({ "kind": "quad", "corner": [-4, -1, 4], "edge_u": [8, 0, 0], "edge_v": [0, 0, -8],
        "material": { "base_color": 0.7 } });
    let wall = json!({ "kind": "box", "min": [2.0, -1, -0.6], "max": [2.2, 0.6, 0.8],
        "material": { "base_color": 0.5, "roughness": 0.7, "metallic": 0.5 } });
    for (name, geometry, samples) in [
        ("media alone", json!([]), 256),
        ("media and surfaces", json!([floor, wall]), 256),
    ] {
        let there = fluence(a, b, &media, &geometry, samples, 1);
        let back = fluence(b, a, &media, &geometry, samples, 2);
        there.assert_equals(name, &back, &[(1, 1)]);
        assert!(
            there.error[1] < 0.05 * there.mean[1],
            "{name} is noise: {there:?}"
        );
    }
}
