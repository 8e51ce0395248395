//! What the filter leaves out, and that the picture stays the same.

use std::sync::Arc;

use serde_json::json;
use tyndall_render::PassId;
use tyndall_scene::{Scene, StopRule};
use tyndall_tests::estimate;
use tyndall_tests::pass_times::least_millis;

use super::{differ, fog, narrow, panels, render};

const FILTER: PassId = PassId("screen_space");

fn runs(scene: &Scene, pass: PassId) -> bool {
    estimate::with_renderer(|renderer| {
        let view = renderer
            .create_view(
                Arc::new(scene.clone()),
                scene.render.width,
                scene.render.height,
            )
            .expect("rendered");
        view.plan().runs(pass)
    })
}

/// Least times of passes over a few frames. Unit: ms.
fn millis<const N: usize>(scene: &Scene, passes: [&'static str; N]) -> [f64; N] {
    let mut scene = scene.clone();
    scene.render.stop = StopRule::Samples(8);
    estimate::with_renderer(|renderer| {
        let (width, height) = (scene.render.width, scene.render.height);
        let mut view = renderer
            .create_view(Arc::new(scene), width, height)
            .expect("rendered");
        least_millis(renderer, &mut view, 7, passes)
    })
}

#[test]
fn only_media_that_scatter_are_filtered() {
    let wall = panels(&[([-2.0, -2.0, 0.0], 4.0, 1.0)]);
    assert!(runs(&narrow(&wall, &fog(0.1, 0.0, 0.0)), FILTER));
    assert!(!runs(&narrow(&wall, &fog(0.0, 0.1, 0.0)), FILTER));
    assert!(!runs(&narrow(&wall, &json!([])), FILTER));
    assert!(!runs(&narrow(&json!([]), &fog(0.1, 0.0, 0.0)), FILTER));
}

#[test]
fn levels_beyond_the_widest_spread_are_not_made() {
    let squares = panels(&[([-0.2, -0.1, 0.0], 0.3, 5.0)]);
    let mut thin = narrow(&squares, &fog(1e-7, 0.0, 0.0));
    let mut thick = narrow(&squares, &fog(1.0, 0.0, 0.0));
    for scene in [&mut thin, &mut thick] {
        [scene.render.width, scene.render.height] = [640, 360];
    }
    let [few] = millis(&thin, ["screen_space"]);
    let [all] = millis(&thick, ["screen_space"]);
    println!(
        "filter at 640×360: {few:.2} ms where nothing is spread by a pixel, {all:.2} ms over all levels"
    );
    let clear = render(narrow(&squares, &json!([])));
    let foggy = render(narrow(&squares, &fog(1e-7, 0.0, 0.0)));
    let difference = differ(&foggy, &clear);
    assert!(difference < 1e-5, "{difference}");
}

#[test]
fn the_filter_costs_little_beside_what_every_picture_costs() {
    let squares = panels(&[
        ([-0.2, -0.1, 0.0], 0.3, 5.0),
        ([-2.0, -2.0, -5.0], 4.0, 0.1),
    ]);
    let mut scene = narrow(&squares, &fog(2e-3, 0.0, 0.0));
    [scene.render.width, scene.render.height] = [640, 360];
    let [filter, film, tonemap] = millis(&scene, ["screen_space", "film", "tonemap"]);
    let ratio = filter / (film + tonemap);
    println!(
        "640×360: filter {filter:.2} ms, film {film:.2} ms, tonemap {tonemap:.2} ms: {ratio:.2}"
    );
    assert!(filter > 0.0 && film > 0.0 && tonemap > 0.0);
    assert!(ratio < 1.5, "{ratio}");
}
