//! Pictures on a device against closed forms and against themselves where physics says they are equal.

#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "helper functions of tests"
)]

use std::sync::Arc;

use serde_json::{Value, json};
use tyndall_quality::relative_rmse_trim;
use tyndall_render::{RenderError, RenderOutcome};
use tyndall_scene::{ShadowMode, StopRule, Technique, presets};
use tyndall_tests::gpu;

/// A wall of reflectance `albedo` 4 m before the camera, 60 m wide.
fn wall(distance: f64, albedo: f64) -> Value {
    json!({ "kind": "quad", "corner": [-30, -30, -distance], "edge_u": [60, 0, 0], "edge_v": [0, 60, 0],
        "material": { "base_color": albedo } })
}

fn one_pixel(media: &Value, lights: &Value, geometry: &Value, steps: u32) -> Value {
    json!({
        "version": 1,
        "camera": { "position": [0, 0, 0], "target": [0, 0, -1], "vertical_fov_degrees": 0.1 },
        "geometry": geometry, "lights": lights, "media": media,
        "render": { "width": 1, "height": 1, "samples": 1,
            "single_scattering": { "steps": steps, "jitter": false }, "shadows": { "mode": "off" } },
    })
}

#[test]
fn airlight_matches_the_closed_form_table() {
    // algorithms §7.1: (σt, albedo, δ, D, t1, g) and the radiance for a light of 1 W.
    let table = [
        (1.0, 1.0, 2.0, 1.0, 10.0, 0.0, 7.108_784_325_62e-4),
        (1.0, 1.0, 2.0, 1.0, 10.0, 0.9, 2.942_340_85e-4),
        (1.0, 1.0, 2.0, 1.0, 10.0, -0.5, 3.455_585_86e-4),
        (0.1, 1.0, 5.0, 0.5, 20.0, 0.5, 2.868_530_51e-3),
        (1e-6, 1.0, 5.0, 0.5, 20.0, 0.0, 3.810_415_98e-8),
        (10.0, 0.8, 1.0, 0.01, 3.0, 0.0, 5.915_595_63e-4),
        (1.0, 1.0, -1.0, 1.0, 10.0, 0.0, 2.815_300_80e-4),
    ];
    let mut renderer = gpu::renderer();
    for (sigma_t, albedo, along, across, end, g, expected) in table {
        let intensity = 1.0 / (4.0 * std::f64::consts::PI);
        let scene = gpu::scene(&one_pixel(
            &json!([{ "kind": "homogeneous", "sigma_t": sigma_t, "albedo": albedo, "g": g }]),
            &json!([{ "kind": "point", "position": [0, across, -along], "intensity": intensity, "radius": 1e-4 }]),
            &json!([wall(end, 0.0)]),
            4096,
        ));
        let found = f64::from(gpu::render(&mut renderer, scene).radiance[0][0]);
        let error = (found - expected).abs() / expected;
        assert!(
            error < 1e-3,
            "σt {sigma_t} δ {along} D {across} g {g}: {found:e} for {expected:e}"
        );
    }
}

#[test]
fn a_lit_wall_in_fog_is_attenuated_along_both_legs() {
    let sigma_t: [f64; 3] = [0.1, 0.2, 0.4];
    let scene = gpu::scene(&one_pixel(
        &json!([{ "kind": "homogeneous", "sigma_s": 0.0, "sigma_a": sigma_t }]),
        &json!([{ "kind": "point", "position": [0, 0, 0], "intensity": 8.0 }]),
        &json!([wall(4.0, 0.5)]),
        1,
    ));
    let still = gpu::render(&mut gpu::renderer(), scene);
    for (c, sigma) in sigma_t.iter().enumerate() {
        let expected = 0.5 / std::f64::consts::PI * 8.0 / 16.0 * (-2.0 * 4.0 * sigma).exp();
        let found = f64::from(still.radiance[0][c]);
        assert!(
            (found / expected - 1.0).abs() < 2e-3,
            "channel {c}: {found} for {expected}"
        );
    }
    let transmittance = sigma_t.iter().map(|s| (-4.0 * s).exp()).sum::<f64>() / 3.0;
    assert!((f64::from(still.frame.stats.mean_transmittance) - transmittance).abs() < 1e-3);
}

#[test]
fn the_march_converges_at_second_order_without_jitter() {
    let mut renderer = gpu::renderer();
    let mut radiance = |steps: u32| {
        let scene = gpu::scene(&one_pixel(
            &json!([{ "kind": "homogeneous", "sigma_t": 0.3, "albedo": 0.8, "g": 0.3 }]),
            &json!([{ "kind": "point", "position": [1, 2, -4], "intensity": 5.0 }]),
            &json!([wall(10.0, 0.0)]),
            steps,
        ));
        f64::from(gpu::render(&mut renderer, scene).radiance[0][0])
    };
    let truth = radiance(4096);
    let errors: Vec<f64> = [8, 16, 32]
        .iter()
        .map(|n| (radiance(*n) - truth).abs())
        .collect();
    let slope = (errors[0] / errors[2]).log2() / 2.0;
    assert!(
        (1.7..2.5).contains(&slope),
        "slope {slope}, errors {errors:?}"
    );
}

fn small_preset(name: &str, width: u32, height: u32, samples: u32) -> tyndall_scene::Scene {
    let mut scene = tyndall_scene::build(presets::description(name).unwrap(), None)
        .unwrap()
        .scene;
    (scene.render.width, scene.render.height) = (width, height);
    scene.render.stop = StopRule::Samples(samples);
    scene
}

#[test]
fn every_preset_renders_a_finite_picture_with_contrast() {
    let mut renderer = gpu::renderer();
    for preset in presets::names() {
        let still = gpu::render(&mut renderer, small_preset(preset.name, 96, 64, 4));
        let values: Vec<f64> = still
            .frame
            .rgba
            .chunks_exact(4)
            .map(|p| f64::from(p[1]))
            .collect();
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        let deviation =
            (values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / values.len() as f64).sqrt();
        assert!(
            (20.0..235.0).contains(&mean),
            "{}: mean {mean} of 255",
            preset.name
        );
        assert!(
            deviation > 8.0,
            "{}: deviation {deviation} of 255",
            preset.name
        );
    }
}

#[test]
fn the_same_seed_gives_the_same_bits() {
    let mut renderer = gpu::renderer();
    let first = gpu::render(&mut renderer, small_preset("fogged_hall", 64, 48, 3));
    let second = gpu::render(&mut renderer, small_preset("fogged_hall", 64, 48, 3));
    assert_eq!(first.radiance, second.radiance);
    let mut other = small_preset("fogged_hall", 64, 48, 3);
    other.render.seed = 1;
    assert_ne!(gpu::render(&mut renderer, other).radiance, first.radiance);
}

#[test]
fn shadow_maps_agree_with_traced_shadows() {
    let mut renderer = gpu::renderer();
    for preset in presets::names() {
        let mut scene = small_preset(preset.name, 128, 80, 16);
        if scene.render.technique == Technique::Reference {
            // Paths look at no shadow map.
            continue;
        }
        scene.render.shadows.resolution = 2048;
        let mapped = gpu::render(&mut renderer, scene.clone());
        scene.render.shadows.mode = ShadowMode::Traced;
        let traced = gpu::render(&mut renderer, scene);
        let (a, b) = (gpu::mean_rgb(&mapped), gpu::mean_rgb(&traced));
        let error = relative_rmse_trim(&gpu::image(&mapped), &gpu::image(&traced)).unwrap();
        println!(
            "{}: relRMSE_trim {error:.4}, means {a:?} {b:?}",
            preset.name
        );
        assert!(
            (a[1] / b[1] - 1.0).abs() < 0.02,
            "{}: means {a:?} {b:?}",
            preset.name
        );
        assert!(error < 0.1, "{}: relRMSE_trim {error}", preset.name);
    }
}

#[test]
fn a_scene_a_thousand_kilometres_away_looks_the_same() {
    // Coordinates are camera-relative: only the description's own numbers are rounded.
    let at = |offset: f64| {
        gpu::scene(&json!({
            "version": 1,
            "camera": { "position": [offset, 1.5, offset + 6.0], "target": [offset, 1, offset] },
            "geometry": [
                { "kind": "box", "min": [-1, 0, -1], "max": [1, 1, 1], "transform": { "translation": [offset, 0, offset] } },
                { "kind": "quad", "corner": [-8, 0, 8], "edge_u": [16, 0, 0], "edge_v": [0, 0, -16],
                    "transform": { "translation": [offset, 0, offset] } },
            ],
            "lights": [{ "kind": "point", "position": [offset + 2.0, 3, offset + 1.0], "intensity": 30 }],
            "media": [{ "kind": "homogeneous", "sigma_s": 0.05, "sigma_a": 0.01,
                "bounds": { "min": [offset - 8.0, 0, offset - 8.0], "max": [offset + 8.0, 5, offset + 8.0] } }],
            "render": { "width": 80, "height": 60, "samples": 4 },
        }))
    };
    let mut renderer = gpu::renderer();
    for mode in [ShadowMode::Mapped, ShadowMode::Traced] {
        let mut near = at(0.0);
        let mut far = at(1e6);
        near.render.shadows.mode = mode;
        far.render.shadows.mode = mode;
        let near = gpu::render(&mut renderer, near);
        let far = gpu::render(&mut renderer, far);
        let error = relative_rmse_trim(&gpu::image(&far), &gpu::image(&near)).unwrap();
        assert!(error < 1e-3, "{mode:?}: relRMSE_trim {error}");
    }
}

#[test]
fn extremes_stay_finite_and_non_negative() {
    let mut renderer = gpu::renderer();
    let lights = [
        json!({ "kind": "point", "position": [0, 0, 0], "intensity": 10 }),
        json!({ "kind": "point", "position": [0, 0, -2], "intensity": 10, "radius": 1e-4 }),
        json!({ "kind": "point", "position": [1e5, 0, -2], "intensity": 1e12 }),
        json!({ "kind": "spot", "position": [0, 1, -2], "direction": [0, -1, 0], "intensity": 10,
            "inner_angle_degrees": 0, "outer_angle_degrees": 1 }),
        json!({ "kind": "directional", "direction": [1, 0, 0], "irradiance": 5 }),
    ];
    for sigma in [0.0, 1e-6, 1.0, 1e4] {
        for g in [-0.99, 0.0, 0.99] {
            for light in &lights {
                let scene = gpu::scene(&json!({
                    "version": 1,
                    "camera": { "position": [0, 0, 0], "target": [0, 0, -1] },
                    "geometry": [wall(5.0, 0.5)],
                    "lights": [light],
                    "media": [
                        { "kind": "homogeneous", "sigma_s": sigma, "sigma_a": sigma, "g": g,
                            "bounds": { "min": [-3, -3, -4], "max": [3, 3, 3] } },
                        { "kind": "sphere", "sigma_s": sigma, "sigma_a": 0, "g": g, "center": [0, 0, -2], "radius": 1 },
                    ],
                    "render": { "width": 7, "height": 5, "samples": 3, "shadows": { "resolution": 64 } },
                }));
                let still = gpu::render(&mut renderer, scene);
                for pixel in &still.radiance {
                    assert!(
                        pixel.iter().all(|v| v.is_finite() && *v >= 0.0),
                        "σ {sigma} g {g} {light}: {pixel:?}"
                    );
                }
            }
        }
    }
}

#[test]
fn a_converged_view_renders_nothing_and_exposure_only_redisplays() {
    let mut renderer = gpu::renderer();
    let scene = small_preset("cornell_fog", 48, 32, 2);
    let mut view = renderer
        .create_view(Arc::new(scene.clone()), 48, 32)
        .unwrap();
    let first = renderer.render_still(&mut view, |_| {}).unwrap();
    assert_eq!(
        renderer.render(&mut view, 0).unwrap(),
        RenderOutcome::Converged
    );
    let mut brighter = scene.clone();
    brighter.camera.exposure_ev += 1.0;
    renderer.update_view(&mut view, Arc::new(brighter)).unwrap();
    let second = renderer.render_still(&mut view, |_| {}).unwrap();
    assert_eq!(
        second.frame.samples, first.frame.samples,
        "the mean is kept"
    );
    assert_eq!(second.radiance, first.radiance);
    assert_ne!(
        second.frame.rgba, first.frame.rgba,
        "the picture is brighter"
    );
    let passes: Vec<_> = second
        .frame
        .pass_times
        .iter()
        .map(|time| time.name)
        .collect();
    assert!(passes.iter().all(|name| *name == "tonemap"), "{passes:?}");
    assert_eq!(
        renderer.render(&mut view, 0).unwrap(),
        RenderOutcome::Converged
    );
}

#[test]
fn a_moving_camera_does_not_render_shadow_maps_again() {
    let mut renderer = gpu::renderer();
    let scene = small_preset("cornell_fog", 48, 32, 1);
    let mut view = renderer
        .create_view(Arc::new(scene.clone()), 48, 32)
        .unwrap();
    let has_shadow_pass = |still: &tyndall_render::Still| {
        still
            .frame
            .pass_times
            .iter()
            .any(|t| t.name == "shadow_maps")
    };
    let first = renderer.render_still(&mut view, |_| {}).unwrap();
    if first.frame.pass_times.is_empty() {
        println!("SKIPPED: the device has no timestamps");
        return;
    }
    assert!(has_shadow_pass(&first));
    let mut moved = scene;
    moved.camera.position.x += 0.01;
    renderer
        .update_view(&mut view, Arc::new(moved.clone()))
        .unwrap();
    assert!(!has_shadow_pass(
        &renderer.render_still(&mut view, |_| {}).unwrap()
    ));
    if let Some(tyndall_scene::Light::Spot(light)) = moved.lights.first_mut() {
        light.position.x += 0.01;
    } else if let Some(tyndall_scene::Light::Point(light)) = moved.lights.first_mut() {
        light.position.x += 0.01;
    } else {
        panic!("the preset has a light with a position");
    }
    renderer.update_view(&mut view, Arc::new(moved)).unwrap();
    assert!(has_shadow_pass(
        &renderer.render_still(&mut view, |_| {}).unwrap()
    ));
}

#[test]
fn what_is_not_rendered_yet_is_refused_by_name() {
    let mut renderer = gpu::renderer();
    let cases = [
        (json!({ "technique": "instant_vpl" }), "render.technique"),
        (json!({ "relative_error": 0.01 }), "render.relative_error"),
    ];
    for (render, named) in cases {
        let scene = gpu::scene(&json!({
            "version": 1, "camera": { "position": [0, 0, 0], "target": [0, 0, -1] },
            "render": render,
        }));
        let error = renderer.create_view(Arc::new(scene), 8, 8).unwrap_err();
        assert!(matches!(error, RenderError::NotRenderedYet(_)), "{error}");
        assert!(error.to_string().contains(named), "{error}");
    }
}

#[test]
fn impossible_sizes_are_errors() {
    let mut renderer = gpu::renderer();
    let scene = Arc::new(small_preset("cornell_fog", 8, 8, 1));
    for (width, height) in [(0, 8), (8, 0), (u32::MAX, 1), (60_000, 60_000)] {
        let error = renderer
            .create_view(Arc::clone(&scene), width, height)
            .unwrap_err();
        assert!(
            matches!(error, RenderError::Size { .. }),
            "{width}×{height}: {error}"
        );
    }
    for (width, height) in [(1, 1), (3, 7), (17, 1)] {
        let mut view = renderer
            .create_view(Arc::clone(&scene), width, height)
            .unwrap();
        renderer.render_still(&mut view, |_| {}).unwrap();
    }
}

#[test]
fn a_refused_update_leaves_the_view_as_it_was() {
    let mut renderer = gpu::renderer();
    let mut scene = small_preset("cornell_fog", 48, 32, 2);
    scene
        .lights
        .push(tyndall_scene::Light::Point(tyndall_scene::PointLight {
            name: String::new(),
            position: scene.camera.position,
            intensity: [0.1; 3],
            radius: 0.01,
            casts_shadows: true,
        }));
    let mut view = renderer
        .create_view(Arc::new(scene.clone()), 48, 32)
        .unwrap();
    let before = renderer.render_still(&mut view, |_| {}).unwrap();
    let mut too_large = scene.clone();
    too_large.render.shadows.resolution = 8192;
    let error = renderer
        .update_view(&mut view, Arc::new(too_large))
        .unwrap_err();
    assert!(matches!(error, RenderError::TooLarge { .. }), "{error}");
    scene.render.seed = 5;
    renderer
        .update_view(&mut view, Arc::new(scene.clone()))
        .unwrap();
    renderer.render_still(&mut view, |_| {}).unwrap();
    scene.render.seed = 0;
    renderer.update_view(&mut view, Arc::new(scene)).unwrap();
    let after = renderer.render_still(&mut view, |_| {}).unwrap();
    assert_eq!(before.radiance, after.radiance);
}
