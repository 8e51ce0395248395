//! How far light is spread in the picture, against the formulas in f64.

use serde_json::json;
use tyndall_render::Still;
use tyndall_scene::{ScreenSpaceFilter, SpreadModel};

use super::{fog, narrow, panels, render, with_filter};

/// Pixels a unit of tan(angle) in the narrow view: its picture is 0.1 high at distance 1.
const PIXELS: f64 = 640.0;

/// Sum, mean and variance along x of a picture less `part` of another one. Unit: px.
fn moments(still: &Still, clear: &Still, part: f64) -> [f64; 3] {
    let mut sums = [0.0; 3];
    for (index, (pixel, other)) in still.radiance.iter().zip(&clear.radiance).enumerate() {
        let value = f64::from(pixel[0]) - part * f64::from(other[0]);
        let x = (index % 64) as f64;
        for (power, sum) in sums.iter_mut().enumerate() {
            *sum += value * x.powi(power as i32);
        }
    }
    let [sum, first, second] = sums;
    let mean = first / sum;
    [sum, mean, second / sum - mean * mean]
}

/// ⟨x²⟩ at path length 1 (Lewis 1950), over the share that is scattered.
fn exact(turning: f64, second: f64, scattering: f64) -> f64 {
    let steps = 20_000;
    let step = 1.0 / f64::from(steps);
    let (mut a1, mut a2) = (0.0, 0.0);
    // dA1/ds = A0 − κA1, dA2/ds = 2A1, by the midpoint rule.
    for i in 0..steps {
        let at = |s: f64| (1.0 - (-second * s).exp()) / 3.0; // allow-one-minus-exp: f64 in a test
        let s = f64::from(i) * step;
        let middle = a1 + 0.5 * step * (at(s) - turning * a1);
        a2 += 2.0 * middle * step;
        a1 += step * (at(s + 0.5 * step) - turning * middle);
    }
    a2 / -(-scattering).exp_m1()
}

#[test]
fn splats_and_gathered_kernels_are_as_wide_as_the_formulas_say() {
    let square = panels(&[([-0.02, -0.02, 0.0], 0.04, 7.0)]);
    let clear = render(narrow(&square, &json!([])));
    let own = moments(&clear, &clear, 0.0)[2];
    for (sigma_s, g) in [
        (2e-5, 0.0),
        (2e-4, 0.5),
        (1e-3, 0.3),
        (4e-3, 0.8),
        (1e-4, 0.999),
    ] {
        for spread in [SpreadModel::Premoze, SpreadModel::ExactMoments] {
            let tau: f64 = 10.0 * sigma_s;
            let relative = match spread {
                SpreadModel::Premoze => tau * (1.0 - g) / 8.0,
                SpreadModel::ExactMoments => exact(tau * (1.0 - g), tau * (1.0 - g * g), tau),
            };
            let wanted = PIXELS * relative.sqrt();
            // Wider than the picture, and minutes of exact kernels.
            if wanted > 20.0 {
                continue;
            }
            for filter in [ScreenSpaceFilter::Splat, ScreenSpaceFilter::Gather] {
                let mut scene = with_filter(&narrow(&square, &fog(sigma_s, 0.0, g)), filter);
                scene.render.screen_space.spread = spread;
                let [sum, _, variance] = moments(&render(scene), &clear, (-tau).exp());
                let width = (variance - own).max(0.0).sqrt();
                println!(
                    "{spread:?} {filter:?} σ_s {sigma_s}, g {g}: {width:.3} px for {wanted:.3}"
                );
                // A picture 64 pixels wide holds this much of a Gaussian.
                // Kernels on the lattice of pixels are narrower than their pixels only by name.
                let told = filter == ScreenSpaceFilter::Splat || wanted > 0.6;
                if wanted < 10.0 && told {
                    assert!((width / wanted - 1.0).abs() < 0.03, "{width} for {wanted}");
                }
                assert!(sum > 0.0);
            }
        }
    }
}

#[test]
fn a_medium_near_the_eye_spreads_more_than_one_near_the_surface() {
    let square = panels(&[([-0.02, -0.02, 0.0], 0.04, 7.0)]);
    let clear = render(narrow(&square, &json!([])));
    let own = moments(&clear, &clear, 0.0)[2];
    let widths: Vec<f64> = [8.0, 4.5, 0.5]
        .into_iter()
        .map(|near: f64| {
            let slab = json!([{ "kind": "homogeneous", "sigma_s": 1e-3, "sigma_a": 0.0,
                "bounds": { "min": [-9, -9, near], "max": [9, 9, near + 1.0] } }]);
            let mut scene = narrow(&square, &slab);
            scene.render.screen_space.spread = SpreadModel::Premoze;
            let variance = moments(&render(scene), &clear, f64::exp(-1e-3))[2] - own;
            // ¾∫κ(t)(1 − t/D)²dt/2 of a slab between t and t + 1.
            let at = |t: f64| (1.0 - t / 10.0).powi(3) * 10.0 / 3.0;
            let wanted = PIXELS * (0.375 * 1e-3 * (at(9.0 - near) - at(10.0 - near))).sqrt();
            let width = variance.max(0.0).sqrt();
            println!("slab from z = {near}: {width:.3} px for {wanted:.3}");
            assert!((width / wanted - 1.0).abs() < 0.03);
            width
        })
        .collect();
    assert!(widths[0] > widths[1] && widths[1] > widths[2]);
}
