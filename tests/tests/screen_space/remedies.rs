//! Each remedy of the hierarchical filter brings it nearer to the exact kernels, on a scene that has what it is
//! for.

use serde_json::{Value, json};
use tyndall_scene::{Scene, ScreenSpaceFilter, SpreadModel};

use super::{differ, narrow, panels, render, with_filter};

/// Fog that lies between 1 m before the far wall and 1 m before the near things: spreads far apart.
fn between() -> Value {
    json!([{ "kind": "homogeneous", "sigma_s": 0.05, "sigma_a": 0.0, "g": 0.995,
        "bounds": { "min": [-9, -9, -19.0], "max": [9, 9, 6.0] } }])
}

/// Errors of the hierarchical filter by its exact kernels: without remedies, then with each of `with` more.
fn errors(scene: &Scene, with: &[fn(&mut Scene)]) -> Vec<f64> {
    let mut scene = scene.clone();
    // That of the exact moments is a third of a radian even in thin fog.
    scene.render.screen_space.spread = SpreadModel::Premoze;
    let exact = render(with_filter(&scene, ScreenSpaceFilter::Gather));
    let mut filtered = with_filter(&scene, ScreenSpaceFilter::Hierarchical);
    let own = &mut filtered.render.screen_space;
    own.luminance_weighting = false;
    own.masking = false;
    own.density_blur = false;
    own.separation = false;
    let mut found = vec![differ(&render(filtered.clone()), &exact)];
    for remedy in with {
        remedy(&mut filtered);
        found.push(differ(&render(filtered.clone()), &exact));
    }
    let splat = differ(
        &render(with_filter(&scene, ScreenSpaceFilter::Splat)),
        &exact,
    );
    println!("hierarchical {found:.6?}, splat {splat:.6}");
    found
}

#[test]
fn masking_and_weighting_keep_near_lamps_out_of_the_distance() {
    // A lantern before most of the fog, a dim wall far behind it.
    let scene = narrow(
        &panels(&[
            ([-0.05, -0.05, 5.0], 0.1, 20.0),
            ([-4.0, -4.0, -20.0], 8.0, 0.05),
        ]),
        &between(),
    );
    let errors = errors(
        &scene,
        &[
            |s| s.render.screen_space.masking = true,
            |s| s.render.screen_space.luminance_weighting = true,
        ],
    );
    assert!(errors[1] < errors[0], "masking");
    assert!(errors[2] < errors[1], "weighting");
}

#[test]
fn blurred_spreads_soften_edges_of_depth() {
    // A dark half before a bright far one.
    let scene = narrow(
        &panels(&[
            ([-2.0, -1.0, 5.0], 2.0, 0.02),
            ([-4.0, -4.0, -20.0], 8.0, 1.0),
        ]),
        &between(),
    );
    let errors = errors(&scene, &[|s| s.render.screen_space.density_blur = true]);
    assert!(errors[1] < errors[0]);
}

#[test]
fn separated_bright_pixels_are_spread_into_dark_surroundings() {
    let scene = narrow(
        &panels(&[
            ([-0.02, -0.02, 4.0], 0.04, 200.0),
            ([-4.0, -4.0, -20.0], 8.0, 0.01),
        ]),
        &between(),
    );
    let errors = errors(
        &scene,
        &[
            |s| {
                let own = &mut s.render.screen_space;
                own.masking = true;
                own.luminance_weighting = true;
                own.density_blur = true;
            },
            |s| s.render.screen_space.separation = true,
        ],
    );
    assert!(errors[2] < errors[1], "separation");
}
