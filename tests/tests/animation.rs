//! Scenes that move: what a time is drawn as, and what is drawn again for it.

#![allow(
    clippy::unwrap_used,
    reason = "helpers of tests, too, fail by unwrapping"
)]

use std::sync::Arc;

use serde_json::{Value, json};
use tyndall_render::{RenderOutcome, Renderer, View};
use tyndall_scene::{Scene, Technique, presets};
use tyndall_tests::gpu;

/// A plate over a floor in fog under a lamp on the left, and a still lamp on the right.
fn moving(plate: &Value, lamp: &Value) -> Value {
    let mesh = json!({
        "kind": "mesh",
        "positions": [[-0.4, 0, -0.4], [-0.4, 0, 0.4], [0.4, 0, 0.4], [0.4, 0, -0.4]],
        "indices": [[0, 1, 2], [0, 2, 3]],
    });
    let light = json!({
        "kind": "spot", "position": [-2, 3, 0], "direction": [0, -1, 0],
        "intensity": 20, "outer_angle_degrees": 25,
    });
    json!({
        "version": 1,
        "camera": {"position": [0, 2, 7], "target": [0, 1, 0]},
        "geometry": [
            merged(&mesh, plate),
            {"kind": "quad", "corner": [-5, 0, 5], "edge_u": [10, 0, 0], "edge_v": [0, 0, -10]},
        ],
        "lights": [
            merged(&light, lamp),
            {"kind": "spot", "position": [2, 3, 0], "direction": [0, -1, 0],
             "intensity": 20, "outer_angle_degrees": 25},
        ],
        "media": [{"kind": "homogeneous", "sigma_t": 0.1, "albedo": 0.9,
            "bounds": {"min": [-4, 0, -4], "max": [4, 4, 4]}}],
        "render": {"technique": "single_scattering", "width": 96, "height": 64, "samples": 2,
            "shadows": {"resolution": 256}},
    })
}

fn merged(base: &Value, more: &Value) -> Value {
    let mut base = base.clone();
    let members = more.as_object().unwrap().clone();
    base.as_object_mut().unwrap().extend(members);
    base
}

fn at(x: f64, degrees: f64) -> Value {
    json!({"translation": [x, 1, 0], "rotation_degrees": [0, degrees, 0]})
}

/// The plate slides along x.
fn sliding() -> Value {
    json!({"keyframes": [
        {"time_seconds": 0, "transform": at(-2.0, 0.0)},
        {"time_seconds": 2, "transform": at(-1.6, 40.0)},
        {"time_seconds": 3, "transform": at(0.0, 40.0)},
        {"time_seconds": 4, "transform": at(0.0, 80.0)},
    ]})
}

/// The left lamp turns between 4 and 6 s.
fn turning() -> Value {
    json!({"keyframes": [
        {"time_seconds": 4, "position": [-2, 3, 0], "direction": [0, -1, 0]},
        {"time_seconds": 6, "position": [-2, 3, 0], "direction": [-1, -1, 0]},
    ]})
}

fn view(renderer: &mut Renderer, scene: &Scene) -> View {
    renderer
        .create_view(Arc::new(scene.clone()), 96, 64)
        .unwrap()
}

/// Shows the scene at a time; returns how many shadow layers its first frame rendered.
fn layers(renderer: &mut Renderer, view: &mut View, scene: &Scene, seconds: f64) -> u32 {
    let scene = Arc::new(scene.at(seconds).unwrap());
    renderer.update_view(view, scene).unwrap();
    assert_eq!(renderer.render(view, 0).unwrap(), RenderOutcome::Submitted);
    renderer.wait().unwrap();
    view.take_finished().unwrap().unwrap().shadow_layers
}

#[test]
fn a_picture_at_a_time_is_that_of_the_still_scene_bit_for_bit() {
    let mut renderer = gpu::renderer();
    for technique in [Technique::SingleScattering, Technique::Reference] {
        let mut scene = gpu::scene(&moving(&sliding(), &json!({})));
        scene.render.technique = technique;
        let mut still = gpu::scene(&moving(&json!({"transform": at(-1.6, 40.0)}), &json!({})));
        still.render.technique = technique;
        let mut moved = view(&mut renderer, &scene);
        renderer.render_still(&mut moved, |_| {}).unwrap();
        let update = Arc::new(scene.at(2.0).unwrap());
        renderer.update_view(&mut moved, update).unwrap();
        let moved = renderer.render_still(&mut moved, |_| {}).unwrap();
        let expected = gpu::render(&mut renderer, still);
        assert_eq!(moved.frame.samples, expected.frame.samples);
        assert!(moved.radiance == expected.radiance, "{}", technique.name());
        let before = gpu::render(&mut renderer, scene);
        assert!(
            before.radiance != expected.radiance,
            "the plate's move shows"
        );
    }
}

#[test]
fn only_shadow_maps_that_see_a_motion_are_rendered_again() {
    let mut renderer = gpu::renderer();
    let scene = gpu::scene(&moving(&sliding(), &turning()));
    let mut view = view(&mut renderer, &scene);
    // Both lamps at first.
    assert_eq!(layers(&mut renderer, &mut view, &scene, 0.0), 2);
    // The plate under the left one.
    assert_eq!(layers(&mut renderer, &mut view, &scene, 1.0), 1);
    // It leaves: where it was is what changes the map.
    assert_eq!(layers(&mut renderer, &mut view, &scene, 3.0), 1);
    // It turns between the lamps, in nobody's light.
    assert_eq!(layers(&mut renderer, &mut view, &scene, 3.5), 0);
    assert_eq!(layers(&mut renderer, &mut view, &scene, 4.0), 0);
    // Now the left lamp turns, the right one stands.
    assert_eq!(layers(&mut renderer, &mut view, &scene, 5.0), 1);
    assert_eq!(layers(&mut renderer, &mut view, &scene, 6.0), 1);
    // At the end nothing moves: the picture goes on as it is, and so do the maps.
    let samples = view.samples();
    assert_eq!(layers(&mut renderer, &mut view, &scene, 9.0), 0);
    assert_eq!(view.samples(), samples + 1);
    assert_eq!(renderer.uploaded_geometries(), 1);
}

#[test]
fn a_sun_stands_still_while_casters_move() {
    let mut renderer = gpu::renderer();
    let mut json = moving(&sliding(), &json!({}));
    json["lights"] = json!([{"kind": "directional", "direction": [1, -2, 0.5], "irradiance": 3}]);
    let scene = gpu::scene(&json);
    let mut view = view(&mut renderer, &scene);
    assert_eq!(layers(&mut renderer, &mut view, &scene, 0.0), 1);
    assert_eq!(layers(&mut renderer, &mut view, &scene, 1.0), 1);
    let moved = renderer.render_still(&mut view, |_| {}).unwrap();
    // The same placement reached another way: had the map been fitted anew, texels would differ.
    let direct = gpu::render(&mut renderer, scene.at(1.0).unwrap());
    assert!(moved.radiance == direct.radiance);
    let facts = |seconds| tyndall_scene::facts(&scene.at(seconds).unwrap());
    assert_eq!(facts(0.0).swept_bounds, facts(3.3).swept_bounds);
}

#[test]
fn the_swinging_lamp_leaves_its_still_lamp_alone() {
    let mut renderer = gpu::renderer();
    let description = presets::description("swinging_lamp").unwrap();
    let mut scene = tyndall_scene::build(description, None).unwrap().scene;
    scene.render.shadows.resolution = 128;
    let mut view = view(&mut renderer, &scene);
    assert_eq!(layers(&mut renderer, &mut view, &scene, 0.0), 3);
    for step in 1..12 {
        // The lamp, and the fan under its own; never the shelf.
        let seconds = 0.53 * f64::from(step);
        assert_eq!(layers(&mut renderer, &mut view, &scene, seconds), 2);
    }
    assert_eq!(renderer.uploaded_geometries(), 1);
}

#[test]
fn another_geometry_is_uploaded_and_another_placement_is_not() {
    let mut renderer = gpu::renderer();
    let scene = gpu::scene(&moving(&sliding(), &json!({})));
    let mut view = view(&mut renderer, &scene);
    for step in 0..4 {
        layers(&mut renderer, &mut view, &scene, 0.7 * f64::from(step));
    }
    assert_eq!(renderer.uploaded_geometries(), 1);
    let other = gpu::scene(&moving(&sliding(), &json!({})));
    layers(&mut renderer, &mut view, &other, 0.0);
    assert_eq!(renderer.uploaded_geometries(), 2);
}
