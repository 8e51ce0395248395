//! Nothing is lost and nothing is made: constant pictures, sums, pure attenuation.

use serde_json::json;
use tyndall_scene::{ScreenSpaceFilter, Technique};
use tyndall_tests::gpu;

use super::{differ, every_filter, fog, narrow, panels, render, with_filter};

#[test]
fn a_constant_picture_stays_constant_under_every_filter() {
    let wall = panels(&[([-2.0, -2.0, 0.0], 4.0, 1.0)]);
    for (sigma_s, sigma_a) in [(0.02, 0.0), (0.3, 0.05), (3.0, 0.0)] {
        let scene = narrow(&wall, &fog(sigma_s, sigma_a, 0.3));
        let expected = f64::exp(-10.0 * sigma_a);
        for (name, scene) in every_filter(&scene) {
            // The widest kernels take the gathering filter minutes.
            if name == "gather" && sigma_s > 0.1 {
                continue;
            }
            let still = render(scene);
            let worst = still
                .radiance
                .iter()
                .map(|p| (f64::from(p[0]) / expected - 1.0).abs());
            let worst = worst.fold(0.0, f64::max);
            assert!(
                worst < 2e-3,
                "{name}, σ_s {sigma_s}, σ_a {sigma_a}: {worst:.1e}"
            );
        }
    }
}

#[test]
fn what_only_absorbs_attenuates_by_beer_and_lambert() {
    let wall = panels(&[([-2.0, -2.0, 0.0], 4.0, 3.0)]);
    let scene = narrow(&wall, &fog(0.0, 0.17, 0.0));
    let still = render(scene);
    for (index, pixel) in still.radiance.iter().enumerate() {
        // The middle of the pixel on the wall, which is 1 m high.
        let place = |i: usize| (i as f64 + 0.5) / 64.0 - 0.5;
        let (x, y) = (place(index % 64), place(index / 64));
        let expected = 3.0 * f64::exp(-0.17 * (100.0 + x * x + y * y).sqrt());
        assert!(
            gpu::relative_error(pixel[0], expected) < 2e-6,
            "{} for {expected}",
            pixel[0]
        );
    }
}

#[test]
fn the_splat_pyramid_loses_no_light() {
    // A bright square in the middle: what it spreads stays inside the picture.
    let square = panels(&[([-0.05, -0.05, 0.0], 0.1, 5.0)]);
    for (sigma_s, g) in [(0.001, 0.0), (0.005, 0.5), (0.02, 0.8)] {
        let clear = render(narrow(&square, &json!([])));
        let foggy = render(narrow(&square, &fog(sigma_s, 0.0, g)));
        let ratio = gpu::mean_rgb(&foggy)[0] / gpu::mean_rgb(&clear)[0];
        assert!((ratio - 1.0).abs() < 1e-4, "σ_s {sigma_s}, g {g}: {ratio}");
        assert!(differ(&foggy, &clear) > 1e-3, "something is spread");
    }
}

#[test]
fn fog_that_thins_out_infinitely_slowly_is_homogeneous() {
    let square = panels(&[([-0.3, -0.1, 0.0], 0.2, 5.0), ([0.1, 0.0, -3.0], 0.2, 2.0)]);
    let thins = json!([{ "kind": "height_fog", "sigma_s": 0.05, "sigma_a": 0.01, "g": 0.4,
        "falloff": 1e-9, "up": [0.6, 0.8, 0.0] }]);
    for filter in [ScreenSpaceFilter::Splat, ScreenSpaceFilter::Hierarchical] {
        let even = render(with_filter(&narrow(&square, &fog(0.05, 0.01, 0.4)), filter));
        let thinning = render(with_filter(&narrow(&square, &thins), filter));
        let difference = differ(&thinning, &even);
        assert!(difference < 2e-4, "{filter:?}: {difference:.1e}");
    }
}

#[test]
fn fog_turned_over_with_the_scene_looks_the_same() {
    let fogs = |up: f64| {
        json!([{ "kind": "height_fog", "sigma_s": 0.08, "sigma_a": 0.0, "g": 0.2,
            "falloff": 1.5, "up": [0.0, up, 0.0], "origin": [0.0, 0.1 * up, 0.0] }])
    };
    let squares = |up: f64| {
        let low = |y: f64, side: f64| if up > 0.0 { y } else { -y - side };
        panels(&[
            ([-0.3, low(-0.4, 0.2), 0.0], 0.2, 5.0),
            ([0.1, low(0.2, 0.1), -3.0], 0.1, 2.0),
        ])
    };
    let upright = render(narrow(&squares(1.0), &fogs(1.0)));
    let turned = render(narrow(&squares(-1.0), &fogs(-1.0)));
    for (index, pixel) in upright.radiance.iter().enumerate() {
        let mirrored = turned.radiance[(63 - index / 64) * 64 + index % 64];
        assert!(
            (pixel[0] - mirrored[0]).abs() < 1e-4 * pixel[0].max(0.1),
            "pixel {index}"
        );
    }
}

#[test]
fn hostile_depths_and_sizes_stay_finite() {
    let wall = panels(&[([-2.0, -2.0, 0.0], 4.0, 1e6), ([-0.2, -0.2, 3.0], 0.1, 0.0)]);
    for media in [
        fog(1e6, 1e6, 0.999),
        fog(1e-12, 0.0, -0.999),
        json!([{ "kind": "height_fog", "sigma_s": 1e5, "sigma_a": 1.0, "falloff": 1e3, "up": [0, 0, 1] }]),
        json!([{ "kind": "sphere", "sigma_s": 10.0, "sigma_a": 0.0, "center": [0, 0, 5], "radius": 1e-3 }]),
    ] {
        for size in [[1, 1], [7, 3], [33, 1]] {
            for (_, mut scene) in every_filter(&narrow(&wall, &media)) {
                scene.render.technique = Technique::ScreenSpace;
                [scene.render.width, scene.render.height] = size;
                scene.render.screen_space.separation = true;
                render(scene);
            }
        }
    }
}
