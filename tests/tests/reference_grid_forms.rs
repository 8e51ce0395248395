//! Null-collision tracking through grids, where grids are something that is known without them: a box,
//! nothing at all, a straight ramp.
//!
//! Bounds: 4 standard errors with the variances of both sides, 6.3e-5 a comparison.

#![allow(clippy::print_stdout, reason = "helper functions of tests")]

use serde_json::{Value, json};
use tyndall_tests::estimate::{self, Estimate};
use tyndall_tests::gpu;
use tyndall_tests::grid_file::{Folder, folder};

fn render(scene: &Value, folder: Option<&Folder>) -> Estimate {
    let description =
        tyndall_scene::SceneDescription::from_json(&scene.to_string()).expect("the scene parses");
    let built =
        tyndall_scene::build(description, folder.map(Folder::path)).expect("the scene is valid");
    let still = estimate::with_renderer(|renderer| gpu::render(renderer, built.scene));
    assert_eq!(still.truncated, 0, "truncated paths");
    Estimate::of_pixels(&still)
}

/// A medium that fills [−1, 1]³ with density 1, of a file or closed.
fn filled(of_a_file: bool, coefficients: &Value) -> Value {
    let mut medium = coefficients.clone();
    if of_a_file {
        medium["kind"] = json!("grid");
        medium["path"] = json!("grid.npy");
        medium["transform"] = json!({ "scale": 2, "translation": [-1, -1, -1] });
    } else {
        medium["kind"] = json!("homogeneous");
        medium["bounds"] = json!({ "min": [-1, -1, -1], "max": [1, 1, 1] });
    }
    medium
}

fn scene(media: &Value, lights: &Value, samples: u32, seed: u32) -> Value {
    json!({
        "version": 1,
        "camera": { "position": [0.3, 0.4, 4], "target": [0, 0, 0], "vertical_fov_degrees": 40 },
        "lights": lights, "media": media,
        "render": { "technique": "reference", "width": 12, "height": 12, "samples": samples, "seed": seed },
    })
}

#[test]
fn a_grid_of_ones_is_a_homogeneous_box() {
    let ones = folder("ones", 9, |_| 1.0);
    let lights = json!([{ "kind": "point", "position": [0.5, 1.6, 0.4], "intensity": 3 },
        { "kind": "environment", "radiance": 0.2 }]);
    for (name, coefficients) in [
        ("grey", json!({ "sigma_t": 1.5, "albedo": 0.9, "g": 0.5 })),
        (
            "chromatic",
            json!({ "sigma_s": [0.2, 1, 2], "sigma_a": [0.5, 0.1, 0], "g": -0.4 }),
        ),
        (
            "glowing",
            json!({ "sigma_s": [1, 1, 1], "sigma_a": 0.5, "emission": [0.5, 1, 2] }),
        ),
        (
            "glowing without extinction",
            json!({ "sigma_s": 0, "sigma_a": 0, "emission": 1 }),
        ),
    ] {
        let grid = render(
            &scene(&json!([filled(true, &coefficients)]), &lights, 256, 1),
            Some(&ones),
        );
        let closed = render(
            &scene(&json!([filled(false, &coefficients)]), &lights, 256, 2),
            None,
        );
        grid.assert_equals(name, &closed, &[(0, 0), (1, 1), (2, 2)]);
    }
    // A light inside: near it, equiangular distances and collisions share the work.
    let inside = json!([{ "kind": "point", "position": [0.2, 0.1, -0.3], "intensity": 1 }]);
    let coefficients = json!({ "sigma_t": 2, "albedo": 0.8, "g": 0.3 });
    let grid = render(
        &scene(&json!([filled(true, &coefficients)]), &inside, 512, 3),
        Some(&ones),
    );
    let closed = render(
        &scene(&json!([filled(false, &coefficients)]), &inside, 512, 4),
        None,
    );
    grid.assert_equals("light inside", &closed, &[(1, 1)]);
    // Beside the same medium in closed form: both are met in one flight.
    let half = json!({ "sigma_t": 1, "albedo": 0.8, "g": 0.3 });
    let mixed = json!([filled(true, &half), filled(false, &half)]);
    let mixed = render(&scene(&mixed, &inside, 512, 5), Some(&ones));
    mixed.assert_equals("half a grid and half a box", &closed, &[(1, 1)]);
}

#[test]
fn a_ramp_lets_through_what_its_mean_does() {
    // Density from 0 to 1 along one axis: through all of it, half; whichever way it is looked along.
    let samples = 17;
    let lights = json!([{ "kind": "environment", "radiance": 1 }]);
    for (axis, stride) in [(0, 1), (1, samples), (2, samples * samples)] {
        let ramp = folder(&format!("ramp{axis}"), samples, |i| {
            (i / stride % samples) as f32 / (samples - 1) as f32
        });
        // The array's last axis is x.
        let from = ["x", "y", "z"][axis];
        let mut position = [0.01, 0.02, 0.03];
        position[axis] = 4.0;
        let mut target = [0.01, 0.02, 0.03];
        target[axis] = 0.0;
        let coefficients = json!({ "sigma_s": 0, "sigma_a": [0.3, 1, 3] });
        let mut scene = scene(
            &json!([filled(true, &coefficients)]),
            &lights,
            2048,
            6 + axis as u32,
        );
        scene["camera"] = json!({ "position": position, "target": target, "up": [0.3, 0.9, 0.2], "vertical_fov_degrees": 0.1 });
        let found = render(&scene, Some(&ramp));
        for (c, sigma) in [0.3, 1.0, 3.0_f64].into_iter().enumerate() {
            // Values have 16 bits.
            found.assert_channel(&format!("ramp along {from}"), c, (-sigma).exp(), 1e-4);
        }
    }
}

fn cloud(coefficients: &Value) -> Value {
    let mut medium = coefficients.clone();
    medium["kind"] = json!("procedural");
    medium["pattern"] = json!("cloud");
    medium["resolution"] = json!(24);
    medium["transform"] = json!({ "scale": 2, "translation": [0, -0.6, 0] });
    medium
}

#[test]
fn a_white_or_balanced_cloud_under_a_white_sky_is_invisible() {
    let sky = json!([{ "kind": "environment", "radiance": 1 }]);
    for (name, coefficients) in [
        (
            "white cloud",
            json!({ "sigma_t": 8, "albedo": 1, "g": 0.8 }),
        ),
        (
            "white cloud in colour",
            json!({ "sigma_t": [2, 8, 4], "albedo": 1, "g": 0.3 }),
        ),
        (
            "cloud in equilibrium",
            json!({ "sigma_s": 4, "sigma_a": 2, "emission": 2, "g": 0.3 }),
        ),
        (
            "cloud in equilibrium and colour",
            json!({ "sigma_s": [4, 2, 1], "sigma_a": [0.2, 2, 4], "emission": [0.2, 2, 4] }),
        ),
    ] {
        let found = render(&scene(&json!([cloud(&coefficients)]), &sky, 128, 7), None);
        for channel in 0..3 {
            found.assert_channel(name, channel, 1.0, 1e-5);
        }
    }
}

#[test]
fn each_channel_of_a_chromatic_cloud_is_a_grey_cloud() {
    let lights = json!([{ "kind": "directional", "direction": [0.3, -1, -0.2], "irradiance": 3 }]);
    let (s, a) = ([2.0, 6.0, 12.0], [0.5, 0.0, 2.0]);
    let coloured = json!({ "sigma_s": s, "sigma_a": a, "g": 0.6 });
    let coloured = render(&scene(&json!([cloud(&coloured)]), &lights, 256, 8), None);
    for c in 0..3 {
        let grey = json!({ "sigma_s": s[c], "sigma_a": a[c], "g": 0.6 });
        let grey = render(
            &scene(&json!([cloud(&grey)]), &lights, 256, 9 + c as u32),
            None,
        );
        coloured.assert_equals(&format!("cloud channel {c}"), &grey, &[(c, 1)]);
    }
}
