//! Glowing media, alone and behind what absorbs, against closed forms.

use serde_json::{Value, json};
use tyndall_tests::estimate::{self, Estimate};

/// Looks through 2 m of the media.
fn seen(media: &Value, samples: u32) -> Estimate {
    Estimate::of_pixels(&estimate::render(&json!({
        "version": 1,
        "camera": { "position": [0, 0, 5], "target": [0, 0, 0], "vertical_fov_degrees": 0.1 },
        "media": media,
        "render": { "technique": "reference", "width": 16, "height": 16, "samples": samples },
    })))
}

fn slab(sigma_a: &Value, emission: &Value) -> Value {
    json!({ "kind": "homogeneous", "sigma_s": 0, "sigma_a": sigma_a, "emission": emission,
        "bounds": { "min": [-50, -50, -1], "max": [50, 50, 1] } })
}

/// ∫₀² e^{−σt} dt.
fn through(sigma: f64) -> f64 {
    if sigma == 0.0 {
        2.0
    } else {
        -(-2.0 * sigma).exp_m1() / sigma
    }
}

#[test]
fn a_glowing_slab_shines_as_its_closed_form() {
    for sigma in [0.0, 1e-8, 1e-3, 1.0, 20.0, 1e4] {
        let found = seen(&json!([slab(&json!(sigma), &json!(3.0))]), 4);
        let expected = 3.0 * through(sigma);
        // One point of one medium has no noise.
        found.assert_near(&format!("glow sigma {sigma}"), expected, 2e-6 * expected);
    }
}

#[test]
fn what_glows_behind_an_absorber_is_dimmed_however_little_it_absorbs_itself() {
    for own in [0.0, 1e-12, 1e-7, 1e-3, 0.5] {
        let media = json!([
            slab(&json!(own), &json!(1.0)),
            slab(&json!(2.0), &json!(0.0))
        ]);
        let expected = through(2.0 + own);
        seen(&media, 64).assert_near(&format!("glow {own} in an absorber"), expected, 1e-5);
    }
}

#[test]
fn chromatic_glow_has_its_closed_form_in_every_channel() {
    let sigma = [0.02, 0.5, 8.0];
    let found = seen(&json!([slab(&json!(sigma), &json!([1.0, 2.0, 3.0]))]), 256);
    for (c, sigma) in sigma.into_iter().enumerate() {
        let expected = [1.0, 2.0, 3.0][c] * through(sigma);
        found.assert_channel(&format!("chromatic glow {c}"), c, expected, 1e-5 * expected);
    }
}

#[test]
fn a_glowing_ball_shines_as_its_column() {
    // Through the middle ∫(1 − u²) du = 4/3 of the radius; no absorption.
    let ball = json!({ "kind": "sphere", "sigma_s": 0, "sigma_a": 0, "emission": 2, "center": [0, 0, 0], "radius": 1 });
    seen(&json!([ball]), 4).assert_near("glowing ball", 8.0 / 3.0, 1e-4);
}
