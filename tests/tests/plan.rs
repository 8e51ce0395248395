//! The plan is pure: snapshots of what runs and what is skipped, with reasons.

use serde_json::{Value, json};
use tyndall_render::{PlanLimits, plan};
use tyndall_scene::{ShadowMode, Technique, facts, presets};
use tyndall_tests::gpu;

fn planned(scene: &tyndall_scene::Scene) -> String {
    plan(&facts(scene), &scene.render, &PlanLimits::default())
        .expect("rendered")
        .to_string()
}

fn box_scene(lights: &Value, media: &Value) -> tyndall_scene::Scene {
    gpu::scene(&json!({
        "version": 1, "camera": { "position": [0, 0, 5], "target": [0, 0, 0] },
        "geometry": [{ "kind": "box", "min": [-1, -1, -1], "max": [1, 1, 1] }],
        "lights": lights, "media": media,
    }))
}

#[test]
fn presets() {
    for preset in presets::names() {
        let scene = tyndall_scene::build(presets::description(preset.name).unwrap(), None)
            .unwrap()
            .scene;
        insta::assert_snapshot!(format!("preset_{}", preset.name), planned(&scene));
    }
}

#[test]
fn work_that_a_scene_does_not_need_is_skipped() {
    let sun = json!([{ "kind": "directional", "direction": [0, -1, 0], "irradiance": 1 }]);
    let lamp = json!([{ "kind": "point", "position": [2, 2, 2], "intensity": 1 }]);
    let fog = json!([{ "kind": "homogeneous", "sigma_s": 0.1, "sigma_a": 0.0 }]);
    let smoke = json!([{ "kind": "homogeneous", "sigma_s": 0.0, "sigma_a": 0.1 }]);
    let forward = json!([{ "kind": "homogeneous", "sigma_s": 0.1, "sigma_a": 0.0, "g": 0.8 }]);
    let none = json!([]);
    for (name, lights, media) in [
        ("no_media", &sun, &none),
        ("no_lights", &none, &fog),
        ("absorption_only", &lamp, &smoke),
        ("isotropic", &lamp, &fog),
        ("anisotropic", &lamp, &forward),
    ] {
        insta::assert_snapshot!(name, planned(&box_scene(lights, media)));
    }
    let mut traced = box_scene(&lamp, &fog);
    traced.render.shadows.mode = ShadowMode::Traced;
    insta::assert_snapshot!("traced", planned(&traced));
    traced.render.shadows.mode = ShadowMode::Off;
    insta::assert_snapshot!("shadows_off", planned(&traced));
    let mut filtered = box_scene(&lamp, &fog);
    filtered.render.technique = Technique::ScreenSpace;
    insta::assert_snapshot!("screen_space", planned(&filtered));
    let mut absorbing = box_scene(&lamp, &smoke);
    absorbing.render.technique = Technique::ScreenSpace;
    insta::assert_snapshot!("screen_space_absorption_only", planned(&absorbing));
    let empty = gpu::scene(&json!({
        "version": 1, "camera": { "position": [0, 0, 5], "target": [0, 0, 0] }, "lights": lamp, "media": fog,
    }));
    insta::assert_snapshot!("no_surfaces", planned(&empty));
}

#[test]
fn equal_inputs_give_equal_plans() {
    let scene = tyndall_scene::build(presets::description("fogged_hall").unwrap(), None)
        .unwrap()
        .scene;
    let (facts, limits) = (facts(&scene), PlanLimits::default());
    assert_eq!(
        plan(&facts, &scene.render, &limits),
        plan(&facts, &scene.render, &limits)
    );
}

#[test]
fn a_driver_with_a_loop_cap_gets_fewer_steps_and_a_reason() {
    let mut scene = box_scene(
        &json!([{ "kind": "point", "position": [2, 2, 2], "intensity": 1 }]),
        &json!([{ "kind": "homogeneous", "sigma_s": 0.1, "sigma_a": 0.0 }]),
    );
    scene.render.single_scattering.steps = 4096;
    scene.render.shadows.mode = ShadowMode::Traced;
    let limits = PlanLimits {
        loop_cap: Some(65_535),
        ..PlanLimits::default()
    };
    let text = plan(&facts(&scene), &scene.render, &limits)
        .expect("rendered")
        .to_string();
    assert!(text.contains("4096 were asked for"), "{text}");
    assert!(!planned(&scene).contains("were asked for"));
}

#[test]
fn strata_beside_density_grids_are_explained() {
    let sun = json!({ "kind": "directional", "direction": [0, -1, 0], "irradiance": 1 });
    let lamp = json!({ "kind": "point", "position": [2, 2, 2], "intensity": 1 });
    let cloud = json!([{ "kind": "procedural", "pattern": "cloud", "resolution": 16, "seed": 3, "sigma_t": 1, "albedo": 0.8 }]);
    let reason = |lights: Value, steps: u32| {
        let mut scene = box_scene(&lights, &cloud);
        scene.render.single_scattering.equiangular = true;
        scene.render.single_scattering.steps = steps;
        planned(&scene)
    };
    let one = reason(json!([sun, lamp]), 32);
    assert!(one.contains("half of them equiangular"), "{one}");
    let two = reason(json!([lamp, lamp]), 32);
    assert!(two.contains("none equiangular"), "{two}");
    let coarse = reason(json!([sun]), 4);
    assert!(coarse.contains("one a voxel would take up to"), "{coarse}");
    let fine = reason(json!([sun]), 512);
    assert!(fine.contains("no more than one a voxel"), "{fine}");
}

#[test]
fn many_lights_are_looked_through_for_weak_ones() {
    let fog = json!([{ "kind": "homogeneous", "sigma_s": 0.1, "sigma_a": 0.0 }]);
    let lamp = json!({ "kind": "point", "position": [2, 2, 2], "intensity": 1 });
    let planned = |lights: usize| planned(&box_scene(&json!(vec![lamp.clone(); lights]), &fog));
    assert!(
        planned(16).contains("are left out of it"),
        "{}",
        planned(16)
    );
    assert!(!planned(15).contains("are left out of it"));
}
