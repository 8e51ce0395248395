//! Chromatic coefficients against grey ones, and media that overlap against their sum.

use std::f64::consts::PI;

use serde_json::{Value, json};
use tyndall_tests::estimate::{self, Estimate};

/// JSON of three channels' coefficients, or of one of them thrice.
type Coefficients<'a> = &'a dyn Fn([f64; 3]) -> Value;

fn room(media: &Value, lights: &Value, samples: u32, seed: u32) -> Estimate {
    Estimate::of_pixels(&estimate::render(&json!({
        "version": 1,
        "camera": { "position": [0, 1, 6], "target": [0, 1, 0], "vertical_fov_degrees": 40 },
        "geometry": [{ "kind": "quad", "corner": [-6, 0, 6], "edge_u": [12, 0, 0], "edge_v": [0, 0, -12],
            "material": { "base_color": 0.6 } }],
        "lights": lights, "media": media,
        "render": { "technique": "reference", "width": 12, "height": 12, "samples": samples, "seed": seed },
    })))
}

fn lamp() -> Value {
    json!([{ "kind": "point", "position": [0.5, 2, -0.5], "intensity": 10, "radius": 0.05 },
        { "kind": "environment", "radiance": 0.3 }])
}

fn sun() -> Value {
    json!([{ "kind": "directional", "direction": [0.3, -1, -0.2], "irradiance": 3 }])
}

/// Each channel of a chromatic scene against the grey scene with its coefficients.
fn assert_channels(
    name: &str,
    lights: &Value,
    samples: u32,
    medium: &dyn Fn(Coefficients<'_>) -> Value,
) {
    let coloured = room(&medium(&|v| json!(v)), lights, samples, 1);
    for c in 0..3 {
        let grey = room(&medium(&|v| json!(v[c])), lights, samples, 2 + c as u32);
        coloured.assert_equals(&format!("{name} channel {c}"), &grey, &[(c, 1)]);
    }
}

#[test]
fn each_channel_of_chromatic_media_is_a_grey_medium() {
    assert_channels("box", &lamp(), 128, &|rgb| {
        json!([{ "kind": "homogeneous", "sigma_s": rgb([0.1, 0.5, 1.5]), "sigma_a": rgb([0.3, 0.05, 0.1]),
            "g": 0.4, "bounds": { "min": [-2, 0.1, -2], "max": [2, 3, 2] } }])
    });
    assert_channels("fog and ball", &lamp(), 128, &|rgb| {
        json!([{ "kind": "height_fog", "sigma_s": rgb([0.2, 0.4, 0.1]), "sigma_a": rgb([0.0, 0.1, 0.4]), "falloff": 0.7,
                "bounds": { "min": [-6, 0, -6], "max": [6, 9, 6] } },
            { "kind": "sphere", "sigma_s": rgb([3.0, 1.0, 0.2]), "sigma_a": rgb([0.2, 0.0, 0.5]), "g": -0.5,
                "center": [0, 1.2, 0], "radius": 1 }])
    });
    assert_channels("box in the sun", &sun(), 128, &|rgb| {
        json!([{ "kind": "homogeneous", "sigma_s": rgb([0.2, 0.5, 1.0]), "sigma_a": rgb([0.0, 0.1, 0.3]),
            "bounds": { "min": [-2, 0.1, -2], "max": [2, 3, 2] } }])
    });
}

#[test]
fn extinction_that_differs_a_hundredfold_between_channels_is_still_three_grey_media() {
    // The clear channel sees the whole box, the dense one its rim: no distance serves both by chance.
    let medium = |rgb: &dyn Fn([f64; 3]) -> Value| {
        json!([{ "kind": "homogeneous", "sigma_s": rgb([0.05, 0.5, 5.0]), "sigma_a": rgb([0.01, 0.1, 1.0]),
            "g": 0.3, "bounds": { "min": [-3, 0.1, -3], "max": [3, 3, 3] } }])
    };
    assert_channels("hundredfold, sun", &sun(), 256, &medium);
    assert_channels("hundredfold, lamp", &lamp(), 256, &medium);
}

#[test]
fn two_media_of_half_the_density_are_one() {
    let cases: [(&str, Value); 3] = [
        (
            "box",
            json!({ "kind": "homogeneous", "sigma_t": 0.8, "albedo": 0.9, "g": 0.5,
            "bounds": { "min": [-2, 0.1, -2], "max": [2, 3, 2] } }),
        ),
        (
            "fog",
            json!({ "kind": "height_fog", "sigma_t": 0.6, "albedo": 0.9, "g": -0.4, "falloff": 0.5,
                "bounds": { "min": [-6, 0, -6], "max": [6, 9, 6] } }),
        ),
        (
            "ball",
            json!({ "kind": "sphere", "sigma_t": 3.0, "albedo": 0.9, "g": 0.7, "center": [0, 1.2, 0], "radius": 1 }),
        ),
    ];
    for (name, medium) in cases {
        let mut half = medium.clone();
        half["density_scale"] = json!(0.5);
        let one = room(&json!([medium]), &lamp(), 256, 11);
        let two = room(&json!([half, half]), &lamp(), 256, 12);
        one.assert_equals(&format!("two halves of a {name}"), &two, &[(1, 1)]);
    }
}

#[test]
fn sunlight_scattered_once_has_its_closed_form_in_channels_a_thousandfold_apart() {
    // Along a level ray, h below the top of a wide slab under a vertical sun:
    // L = σ_s·E/(4π)·e^{−σh}·(1 − e^{−σd})/σ.
    let (h, d) = (0.1, 8.0);
    let sigma: [f64; 3] = [0.01, 0.3, 10.0];
    let still = estimate::render(&json!({
        "version": 1,
        "camera": { "position": [0, -h, 0], "target": [0, -h, -1], "vertical_fov_degrees": 0.1 },
        "geometry": [{ "kind": "quad", "corner": [-90, -90, -d], "edge_u": [180, 0, 0], "edge_v": [0, 90, 0],
            "material": { "base_color": 0 } }],
        "lights": [{ "kind": "directional", "direction": [0, -1, 0], "irradiance": 2 }],
        "media": [{ "kind": "homogeneous", "sigma_t": sigma, "albedo": 0.8,
            "bounds": { "min": [-90, -90, -90], "max": [90, 0, 90] } }],
        "render": { "technique": "reference", "width": 16, "height": 16, "samples": 128,
            "reference": { "max_scatterings": 1 } },
    }));
    let found = Estimate::of_pixels(&still);
    for (c, sigma) in sigma.into_iter().enumerate() {
        let expected = 0.8 * 2.0 / (4.0 * PI) * (-sigma * h).exp() * -(-sigma * d).exp_m1();
        found.assert_channel(
            &format!("thousandfold, channel {c}"),
            c,
            expected,
            1e-4 * expected,
        );
        assert!(
            found.error[c] < 0.02 * expected,
            "channel {c} is noise: {:?}",
            found.error
        );
    }
}
