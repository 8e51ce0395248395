//! Equilibrium: where everything around shines with radiance 1 and nothing is lost, everything does.
//!
//! Not without noise: every segment of a path adds what it sees through the media, so a sample is 1 in
//! the mean only.

use serde_json::{Value, json};
use tyndall_tests::estimate::{self, Estimate};

/// Standard errors that a single pixel may be off.
const PIXEL_SIGMAS: f64 = 5.5;

fn scene(media: &Value, geometry: &Value, sky: f64, samples: u32) -> Value {
    json!({
        "version": 1,
        "camera": { "position": [0.3, 0.4, 4], "target": [0, 0, 0], "vertical_fov_degrees": 50 },
        "geometry": geometry,
        "lights": [{ "kind": "environment", "radiance": sky }],
        "media": media,
        "render": { "technique": "reference", "width": 4, "height": 3, "samples": samples },
    })
}

/// Every pixel 1 within its noise and rounding, and so their mean.
fn assert_one(name: &str, scene: &Value) {
    let still = estimate::render(scene);
    let variance = still.variance.as_ref().expect("the reference knows it");
    for (pixel, variance) in still.radiance.iter().zip(variance) {
        for c in 0..3 {
            let bound = 2e-5 + PIXEL_SIGMAS * f64::from(variance[c]).sqrt();
            let off = f64::from(pixel[c]) - 1.0;
            assert!(
                off.abs() <= bound,
                "{name}: a pixel is off by {off}, {bound} allowed"
            );
        }
    }
    for channel in 0..3 {
        Estimate::of_pixels(&still).assert_channel(name, channel, 1.0, 1e-5);
    }
}

#[test]
fn a_white_medium_of_two_lobes_under_a_white_sky_is_invisible() {
    let phase =
        json!({ "kind": "two_lobes", "g_forward": 0.8, "g_backward": -0.3, "forward_share": 0.7 });
    let fog = json!({ "kind": "height_fog", "sigma_t": 1.5, "albedo": 1, "phase": phase, "falloff": 1.5,
        "bounds": { "min": [-2, -1, -2], "max": [2, 2, 2] } });
    // A plain lobe beside it.
    let ball = json!({ "kind": "sphere", "sigma_t": 6, "albedo": 1, "g": 0.5, "center": [0.2, 0, 0], "radius": 1.2 });
    let both = json!([fog, ball]);
    assert_one("two lobes", &scene(&both, &json!([]), 1.0, 512));
}

#[test]
fn a_white_medium_under_a_white_sky_is_invisible() {
    for g in [-0.99, -0.5, 0.0, 0.5, 0.9, 0.99] {
        let bounds = json!({ "min": [-1, -1, -1], "max": [1, 1, 1] });
        let cube =
            json!({ "kind": "homogeneous", "sigma_t": 3, "albedo": 1, "g": g, "bounds": bounds });
        let fog = json!({ "kind": "height_fog", "sigma_t": 1.5, "albedo": 1, "g": g, "falloff": 1.5,
            "bounds": { "min": [-2, -1, -2], "max": [2, 2, 2] } });
        let ball = json!({ "kind": "sphere", "sigma_t": 6, "albedo": 1, "g": g, "center": [0.2, 0, 0], "radius": 1.2 });
        let none = json!([]);
        assert_one(
            &format!("cube g {g}"),
            &scene(&json!([cube]), &none, 1.0, 512),
        );
        assert_one(
            &format!("fog g {g}"),
            &scene(&json!([fog]), &none, 1.0, 512),
        );
        assert_one(
            &format!("ball g {g}"),
            &scene(&json!([ball]), &none, 1.0, 512),
        );
        assert_one(
            &format!("all three g {g}"),
            &scene(&json!([cube, fog, ball]), &none, 1.0, 512),
        );
    }
}

#[test]
fn white_media_of_any_colour_of_extinction_are_invisible() {
    let cube = json!({ "kind": "homogeneous", "sigma_t": [0.3, 1, 3], "albedo": 1, "g": 0.5,
        "bounds": { "min": [-1, -1, -1], "max": [1, 1, 1] } });
    let ball = json!({ "kind": "sphere", "sigma_t": [4, 1, 0.1], "albedo": 1, "g": -0.3, "center": [0.2, 0, 0], "radius": 1.2 });
    let none = json!([]);
    assert_one("chromatic cube", &scene(&json!([cube]), &none, 1.0, 256));
    assert_one("chromatic ball", &scene(&json!([ball]), &none, 1.0, 256));
    assert_one(
        "chromatic both",
        &scene(&json!([cube, ball]), &none, 1.0, 256),
    );
}

#[test]
fn media_that_absorb_and_glow_alike_are_invisible() {
    // Kirchhoff: emission = σ_a · 1. Free paths, roulette, glow and absorption have to agree.
    let bounds = json!({ "min": [-1, -1, -1], "max": [1, 1, 1] });
    let cube = json!({ "kind": "homogeneous", "sigma_s": 1, "sigma_a": 0.5, "emission": 0.5, "g": 0.5, "bounds": bounds });
    let fog = json!({ "kind": "height_fog", "sigma_s": 0.2, "sigma_a": 1, "emission": 1, "falloff": 1.5,
        "bounds": { "min": [-2, -1, -2], "max": [2, 2, 2] } });
    let ball = json!({ "kind": "sphere", "sigma_s": 2, "sigma_a": 1, "emission": 1, "g": -0.5, "center": [0.2, 0, 0], "radius": 1.2 });
    let colour = json!({ "kind": "sphere", "sigma_s": [2, 1, 0.5], "sigma_a": [0.1, 1, 3], "emission": [0.1, 1, 3],
        "center": [0.2, 0, 0], "radius": 1.2 });
    let none = json!([]);
    for (name, media) in [
        ("glowing cube", json!([cube])),
        ("glowing fog", json!([fog])),
        ("glowing ball", json!([ball])),
        ("glowing three", json!([cube, fog, ball])),
        ("glowing in colour", json!([cube, colour])),
    ] {
        assert_one(name, &scene(&media, &none, 1.0, 256));
    }
}

#[test]
fn a_closed_room_that_shines_and_reflects_is_in_equilibrium() {
    // Walls of reflectance ρ emit 1 − ρ. Emitters found by chance and by choice have to agree.
    let haze = json!({ "kind": "homogeneous", "sigma_t": 0.3, "albedo": 1, "g": 0.6 });
    let ball = json!({ "kind": "sphere", "sigma_t": 3, "albedo": 1, "g": -0.5, "center": [0, 0, 0], "radius": 1.2 });
    for (name, reflectance, media) in [
        ("room of black walls", 0.0, json!([haze, ball])),
        ("room of grey walls", 0.5, json!([haze, ball])),
        ("room without media", 0.7, json!([])),
    ] {
        let room = json!([{ "kind": "box", "min": [-3, -2, -3], "max": [3, 4, 5],
            "material": { "base_color": reflectance, "emission": 1.0 - reflectance } }]);
        assert_one(name, &scene(&media, &room, 0.0, 512));
    }
}

#[test]
fn absorption_only_darkens() {
    let ball = json!({ "kind": "sphere", "sigma_t": 3, "albedo": 0.7, "g": 0.3, "center": [0, 0, 0], "radius": 1.2 });
    let still = estimate::render(&scene(&json!([ball]), &json!([]), 1.0, 512));
    let variance = still.variance.as_ref().expect("the reference knows it");
    for (pixel, variance) in still.radiance.iter().zip(variance) {
        let bound = 1.0 + 1e-5 + PIXEL_SIGMAS * f64::from(variance[1]).sqrt();
        assert!(
            f64::from(pixel[1]) <= bound,
            "brighter than the sky: {pixel:?}"
        );
    }
    assert!(still.radiance[4 + 1][1] < 0.9, "the middle is darker");
}
