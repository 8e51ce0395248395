//! Density grids through the path tracer: a white furnace, and transmittance against quadrature.

#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "helper functions of tests"
)]

use glam::DVec3;
use serde_json::{Value, json};
use tyndall_scene::{MediumShape, Scene};
use tyndall_tests::gpu;

/// A plume of 1 m in front of the camera, in a sky of radiance 1.
fn plume(sigma_t: f64, albedo: f64, g: f64, fov: f64, size: u32, samples: u32) -> Scene {
    let render: Value =
        json!({ "technique": "reference", "width": size, "height": size, "samples": samples });
    gpu::scene(&json!({
        "version": 1,
        "camera": { "position": [0.1, 0.5, 2.0], "target": [0, 0.5, 0], "vertical_fov_degrees": fov },
        "lights": [{ "kind": "environment", "radiance": 1.0 }],
        "media": [{ "kind": "procedural", "pattern": "smoke_plume", "resolution": 32,
            "sigma_t": sigma_t, "albedo": albedo, "g": g }],
        "render": render,
    }))
}

/// False alarm: 5 standard errors in 256 pixels, one in 7,000 a case.
#[test]
fn a_white_plume_is_invisible_in_a_white_sky() {
    for (sigma_t, g) in [(5.0, 0.0), (40.0, 0.9), (40.0, -0.5)] {
        let still = gpu::render(&mut gpu::renderer(), plume(sigma_t, 1.0, g, 40.0, 16, 32));
        let variance = still.variance.as_ref().unwrap();
        for (pixel, variance) in still.radiance.iter().zip(variance) {
            let bound = 5.0 * variance[1].sqrt() + 1e-4;
            assert!((pixel[1] - 1.0).abs() <= bound, "{sigma_t} {g}: {pixel:?}");
        }
    }
}

/// Nothing but absorption: the mean over the samples is the mean of e^−τ over the pixel, which is so
/// small here that the ray through its middle stands for it.
#[test]
fn transmittance_of_a_grid_is_that_of_quadrature() {
    for sigma_t in [1.0, 8.0] {
        let scene = plume(sigma_t, 0.0, 0.0, 0.1, 4, 4096);
        let MediumShape::Grid {
            grid,
            world_from_lattice,
        } = &scene.media[0].shape
        else {
            panic!("a procedural medium is a grid");
        };
        let lattice_from_world = world_from_lattice.inverse();
        let origin = DVec3::new(0.1, 0.5, 2.0);
        let direction = (DVec3::new(0.0, 0.5, 0.0) - origin).normalize_or(DVec3::NEG_Z);
        let steps = 100_000;
        let tau: f64 = (0..steps)
            .map(|i| {
                let t = 4.0 * (f64::from(i) + 0.5) / f64::from(steps);
                sigma_t * grid.sample(lattice_from_world.transform_point3(origin + direction * t))
            })
            .sum::<f64>()
            * 4.0
            / f64::from(steps);
        let still = gpu::render(&mut gpu::renderer(), scene.clone());
        let n = still.radiance.len() as f64;
        let mean = still.radiance.iter().map(|p| f64::from(p[1])).sum::<f64>() / n;
        let variance = still.variance.as_ref().unwrap();
        let error = variance.iter().map(|v| f64::from(v[1])).sum::<f64>().sqrt() / n;
        println!(
            "sigma_t {sigma_t}: {mean:.5} ± {error:.5}, quadrature {:.5}",
            (-tau).exp()
        );
        assert!((mean - (-tau).exp()).abs() < 4.0 * error + 2e-4);
    }
}
