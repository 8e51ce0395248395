//! What a scene does not need is left out, and the picture is the same; what that saves is printed.

use std::sync::Arc;

use serde_json::{Value, json};
use tyndall_quality::relative_rmse;
use tyndall_render::{PassId, Still};
use tyndall_scene::{Scene, StopRule};
use tyndall_tests::pass_times::least_millis;
use tyndall_tests::{estimate, gpu};

const MARCH: [&str; 4] = ["shadow_maps", "light_volume", "single_scattering", "gather"];

/// Looks along −z into `media` lit by `lights`; a wall 6 m away if asked for.
fn scene(media: &Value, lights: &Value, wall: bool, steps: u32) -> Scene {
    let geometry = if wall {
        json!([{ "kind": "quad", "corner": [-9, -9, -6], "edge_u": [18, 0, 0], "edge_v": [0, 18, 0],
            "material": { "base_color": 0.5 } }])
    } else {
        json!([])
    };
    gpu::scene(&json!({
        "version": 1,
        "camera": { "position": [0, 0, 3], "target": [0, 0, 0], "vertical_fov_degrees": 50 },
        "geometry": geometry, "lights": lights, "media": media,
        "render": { "width": 64, "height": 48, "samples": 1,
            "single_scattering": { "steps": steps, "jitter": false } },
    }))
}

fn render(scene: Scene) -> Still {
    timed(scene).0
}

/// The picture, and the least time of the passes that march over a few frames of it: what else runs on
/// the machine only adds. Unit: ms.
fn timed(scene: Scene) -> (Still, f64) {
    let (width, height) = (scene.render.width, scene.render.height);
    estimate::with_renderer(|renderer| {
        let mut more = scene.clone();
        more.render.stop = StopRule::Samples(6);
        let mut view = renderer
            .create_view(Arc::new(more), width, height)
            .expect("rendered");
        let least = least_millis(renderer, &mut view, 5, MARCH);
        (gpu::render(renderer, scene), least.iter().sum())
    })
}

/// Renders a scene that leaves something out and one that does not, and prints what that saves; gives
/// back by how much the pictures differ.
fn saves(what: &str, left_out: Scene, done: Scene) -> f64 {
    let ((less, less_millis), (all, all_millis)) = (timed(left_out), timed(done));
    let difference = differ(&less, &all);
    println!("{what}: {less_millis:.2} ms for {all_millis:.2} ms, difference {difference:.1e}");
    difference
}

/// Whether the plan says why `what` of a pass is left out.
fn skips(scene: &Scene, pass: PassId, what: &str) -> bool {
    estimate::with_renderer(|renderer| {
        let view = renderer
            .create_view(Arc::new(scene.clone()), 64, 48)
            .expect("rendered");
        let mut skipped = view.plan().skipped.iter();
        skipped.any(|skip| skip.pass == pass && skip.variant == what)
    })
}

fn lamp(casts_shadows: bool) -> Value {
    json!([{ "kind": "point", "position": [0.7, 0.5, -1], "intensity": 4, "radius": 0.01, "casts_shadows": casts_shadows }])
}

fn fog(g: f64) -> Value {
    json!([{ "kind": "homogeneous", "sigma_t": 0.3, "albedo": 0.8, "g": g, "bounds": { "min": [-4, -4, -5], "max": [4, 4, 2] } }])
}

/// Relative difference of two pictures.
fn differ(a: &Still, b: &Still) -> f64 {
    relative_rmse(&gpu::image(a), &gpu::image(b)).expect("same size")
}

#[test]
fn a_gauss_rule_replaces_thousands_of_strata_where_nothing_is_in_shadow() {
    for g in [0.0, 0.5] {
        let nodes = scene(&fog(g), &lamp(true), false, 4096);
        // One shadow caster too many for the rule: a sliver behind the camera.
        let mut strata = nodes.clone();
        let shadowed = gpu::scene(&json!({
            "version": 1,
            "camera": { "position": [0, 0, 3], "target": [0, 0, 0] },
            "geometry": [{ "kind": "quad", "corner": [0, 0, 50], "edge_u": [1e-2, 0, 0], "edge_v": [0, 1e-2, 0],
                "material": { "base_color": 0.5 } }],
        }));
        strata.geometry = shadowed.geometry;
        let difference = saves(
            &format!("32 Gauss nodes for 4096 strata, g {g}"),
            nodes,
            strata,
        );
        assert!(difference < 2e-3, "g {g}: {difference}");
    }
}

#[test]
fn lights_that_cast_no_shadows_need_no_maps_and_no_surfaces_change_that() {
    // Few enough strata that no Gauss rule takes their place.
    let with = scene(&fog(0.2), &lamp(true), true, 32);
    let without = scene(&fog(0.2), &lamp(false), true, 32);
    assert!(!skips(&with, PassId("shadow_maps"), ""));
    assert!(skips(&without, PassId("shadow_maps"), ""));
    // The wall is behind the lamp and shadows nothing that is seen.
    let difference = saves("no shadow maps", without, with);
    assert!(difference < 2e-3, "{difference}");
}

#[test]
fn a_constant_phase_function_is_not_computed() {
    let constant = scene(&fog(0.0), &lamp(true), true, 64);
    let nearly = scene(&fog(1e-6), &lamp(true), true, 64);
    assert!(skips(
        &constant,
        PassId("single_scattering"),
        "phase function"
    ));
    assert!(!skips(
        &nearly,
        PassId("single_scattering"),
        "phase function"
    ));
    let difference = saves("a constant phase function", constant, nearly);
    assert!(difference < 1e-5, "{difference}");
}

#[test]
fn what_only_absorbs_is_not_marched() {
    let media =
        |sigma_s: f64| json!([{ "kind": "homogeneous", "sigma_s": sigma_s, "sigma_a": 0.3 }]);
    let absorbing = scene(&media(0.0), &lamp(true), true, 64);
    let nearly = scene(&media(1e-12), &lamp(true), true, 64);
    assert!(skips(&absorbing, PassId("single_scattering"), ""));
    assert!(!skips(&nearly, PassId("single_scattering"), ""));
    let difference = saves("what only absorbs", absorbing, nearly);
    assert!(difference < 1e-6, "{difference}");
}

#[test]
fn a_spot_is_marched_inside_its_cone_only() {
    // Strata that lie in the cone converge sooner.
    let spot = |steps: u32| {
        let lights = json!([{ "kind": "spot", "position": [0, 3, -1], "direction": [0, -1, 0], "intensity": 40,
            "inner_angle_degrees": 4, "outer_angle_degrees": 6, "casts_shadows": false }]);
        render(scene(&fog(0.3), &lights, true, steps))
    };
    let truth = spot(4096);
    let few = differ(&spot(8), &truth);
    println!("8 strata inside a cone of 6°: {few:.4}");
    // Eight strata over the whole ray of 7 m would mostly miss a cone 0.6 m wide.
    assert!(few < 0.05, "{few}");
}

#[test]
fn without_grids_no_light_volume_is_filled() {
    let plain = scene(&fog(0.0), &lamp(true), true, 16);
    assert!(skips(&plain, PassId("light_volume"), ""));
}
