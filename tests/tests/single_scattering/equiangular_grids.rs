//! Equiangular strata beside density grids: both kinds of strata summed up in order, against the even
//! ones alone.
//!
//! Measured: relRMSE of one sample of 32 strata 0.87 for 9.6, in 1.1 of the time; without the worst 0.1 %
//! of the pixels, which are those at the lamp, 0.046 for 0.016, since half as many strata are left there.

use std::sync::Arc;

use serde_json::{Value, json};
use tyndall_quality::{Image, relative_rmse, relative_rmse_trim};
use tyndall_scene::{Scene, StopRule};
use tyndall_tests::pass_times::least_millis;
use tyndall_tests::{estimate::with_renderer, gpu};

const SIDE: usize = 40;
/// Pictures of one sample, each with its own seed.
const SEEDS: u32 = 16;

/// A cloud about the origin, seen from 6 m.
fn cloud(lights: &Value, steps: u32, equiangular: bool, interleave: u32) -> Scene {
    gpu::scene(&json!({
        "version": 1,
        "camera": { "position": [0, 0.4, 6], "target": [0, 0.4, 0], "vertical_fov_degrees": 26 },
        "geometry": [], "lights": lights,
        "media": [{ "kind": "procedural", "pattern": "cloud", "resolution": 16, "seed": 3, "sigma_t": [1.2, 1.6, 2],
            "albedo": 0.8, "g": 0.4, "transform": { "scale": 2.5, "translation": [-0.3, 0.2, 0] } }],
        "render": { "width": SIDE, "height": SIDE, "samples": 1,
            "single_scattering": { "steps": steps, "equiangular": equiangular, "interleave": interleave } },
    }))
}

fn lamp() -> Value {
    json!({ "kind": "point", "position": [0.1, 0.5, 0.1], "intensity": 5, "radius": 0.01 })
}

/// One sample of every pixel, at its centre whatever the seed.
fn picture(scene: &Scene) -> Image {
    with_renderer(|renderer| gpu::image(&gpu::render(renderer, scene.clone())))
}

/// The march's least time over some frames: what else runs on the machine only adds. Unit: ms.
fn march_millis(scene: &Scene) -> f64 {
    let mut scene = scene.clone();
    scene.render.stop = StopRule::Samples(16);
    let side = SIDE as u32;
    with_renderer(|renderer| {
        let mut view = renderer
            .create_view(Arc::new(scene), side, side)
            .expect("rendered");
        let [least] = least_millis(renderer, &mut view, 15, ["single_scattering"]);
        least
    })
}

/// Mean of green, and its standard error, over pictures with seeds of their own; their mean relRMSE against
/// `truth`; the march's least time.
struct Found {
    mean: f64,
    error: f64,
    relative_rmse: f64,
    /// Without the worst 0.1 % of the pixels.
    trimmed: f64,
    millis: f64,
}

fn measure(mut scene: Scene, truth: &Image) -> Found {
    let (mut means, mut errors, mut trimmed) = (Vec::new(), 0.0, 0.0);
    for seed in 0..SEEDS {
        scene.render.seed = u64::from(seed) + 11;
        let picture = picture(&scene);
        errors += relative_rmse(&picture, truth).expect("same size") / f64::from(SEEDS);
        trimmed += relative_rmse_trim(&picture, truth).expect("same size") / f64::from(SEEDS);
        means.push(mean(&picture));
    }
    let n = f64::from(SEEDS);
    let mean = means.iter().sum::<f64>() / n;
    let squares: f64 = means.iter().map(|m| (m - mean).powi(2)).sum();
    Found {
        mean,
        error: (squares / (n * (n - 1.0))).sqrt(),
        relative_rmse: errors,
        trimmed,
        millis: march_millis(&scene),
    }
}

fn mean(picture: &Image) -> f64 {
    let green = picture.rgb().iter().map(|p| f64::from(p[1]));
    green.sum::<f64>() / (SIDE * SIDE) as f64
}

#[test]
fn equiangular_strata_in_a_grid_are_unbiased_and_err_less() {
    let sun = json!({ "kind": "directional", "direction": [0.3, -1, 0.2], "irradiance": 0.4 });
    for (name, lights, ways) in [
        ("lamp", json!([lamp()]), &[(32, 1), (32, 2)][..]),
        ("lamp and sun", json!([sun, lamp()]), &[(32, 1)]),
    ] {
        let truth = picture(&cloud(&lights, 4096, false, 1));
        let expected = mean(&truth);
        for &(steps, interleave) in ways {
            let even = measure(cloud(&lights, steps, false, interleave), &truth);
            let both = measure(cloud(&lights, steps, true, interleave), &truth);
            println!(
                "{name}, {steps} strata, {interleave}×{interleave}: relRMSE (trimmed) even {:.4} ({:.4}) in {:.2} ms, half \
                 equiangular {:.4} ({:.4}) in {:.2} ms; mean {:.5} and {:.5} ± {:.5} of {expected:.5}",
                even.relative_rmse,
                even.trimmed,
                even.millis,
                both.relative_rmse,
                both.trimmed,
                both.millis,
                even.mean,
                both.mean,
                both.error
            );
            // Four standard errors, and what the trapezoids of fewer points leave.
            let off = (both.mean - expected).abs();
            assert!(
                off < 4.0 * both.error + 0.005 * expected,
                "{name}, {steps}, {interleave}: {off}"
            );
            // Measured: a tenth, a sixth interleaved.
            assert!(
                both.relative_rmse < 0.5 * even.relative_rmse,
                "{name}, {steps}, {interleave}: {} for {}",
                both.relative_rmse,
                even.relative_rmse
            );
        }
    }
}
