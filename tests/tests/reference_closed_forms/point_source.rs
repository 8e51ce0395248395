//! Fluence about an isotropic point source in an infinite medium: the radiance that six cameras see,
//! integrated over all directions.

use std::f64::consts::PI;

use glam::DVec3;
use serde_json::json;
use tyndall_tests::estimate::{self, Estimate};

const SIZE: u32 = 16;

/// Solid angle of the part [0, x] × [0, y] of a plane at distance 1.
fn corner_angle(x: f64, y: f64) -> f64 {
    (x * y / (1.0 + x * x + y * y).sqrt()).atan()
}

fn pixel_angle(pixel: usize) -> f64 {
    let edge = |i: usize| 2.0 * i as f64 / f64::from(SIZE) - 1.0;
    let (i, j) = (pixel % SIZE as usize, pixel / SIZE as usize);
    let (x0, x1, y0, y1) = (edge(i), edge(i + 1), edge(j), edge(j + 1));
    corner_angle(x1, y1) - corner_angle(x0, y1) - corner_angle(x1, y0) + corner_angle(x0, y0)
}

/// 4πr²φ at distance r of a source of 1 W, scattered light only.
fn scattered_fluence(r: f64, albedo: f64, g: f64, samples: u32, seed: u32) -> Estimate {
    let toward = DVec3::new(1.0, 2.0, 2.0) / 3.0;
    let up = DVec3::new(2.0, 1.0, -2.0) / 3.0;
    let face = |direction: DVec3, up: DVec3, seed: u32| {
        let position = -r * toward;
        let still = estimate::render(&json!({
            "version": 1,
            "camera": { "position": position, "target": position + direction, "up": up,
                "vertical_fov_degrees": 90 },
            "lights": [{ "kind": "point", "position": [0, 0, 0], "intensity": 1.0 / (4.0 * PI),
                "radius": 1e-4 }],
            "media": [{ "kind": "homogeneous", "sigma_t": 1, "albedo": albedo, "g": g }],
            "render": { "technique": "reference", "width": SIZE, "height": SIZE,
                "samples": samples, "seed": seed },
        }));
        Estimate::of_weighted_pixels(&still, pixel_angle)
    };
    // The four faces beside the axis see the same.
    let front = face(toward, up, 3 * seed);
    let back = face(-toward, up, 3 * seed + 1);
    let side = face(up, toward, 3 * seed + 2);
    front
        .plus(back)
        .plus(side.scaled(4.0))
        .scaled(4.0 * PI * r * r)
}

#[test]
fn fluence_about_a_point_source_is_what_photons_deposit() {
    // algorithms §7.5, bins [r, r + 0.1]: the function is straight enough that the middle is the mean.
    // Its own noise: some 2e5 paths a bin for albedo 0.9. Forward scattering is left to
    // `glowing_shell.rs`: rays that happen to pass a point have a variance that no number of samples
    // settles.
    let table = [
        (0.9, 0.0, 0.9, 1.782),
        (0.9, 0.0, 1.9, 1.876),
        (0.9, 0.0, 4.9, 0.932),
    ];
    for (seed, (albedo, g, bin, expected)) in table.into_iter().enumerate() {
        let r: f64 = bin + 0.05;
        let found = scattered_fluence(r, albedo, g, 384, seed as u32);
        let name = format!("fluence albedo {albedo} g {g} r {r}");
        found.assert_near(&name, expected - (-r).exp(), 5e-3 * expected);
    }
}
