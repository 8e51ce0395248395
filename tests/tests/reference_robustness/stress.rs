//! Extremes (algorithms §7.8): every picture is finite, not negative, and every path whole, which
//! `estimate::render` asserts of each.

use std::sync::Arc;
use std::time::Instant;

use serde_json::{Value, json};
use tyndall_tests::{estimate, gpu};

/// Everything 1e6 m away from the world's origin if `offset` says so.
fn scene(
    offset: f64,
    media: &Value,
    lights: &Value,
    geometry: &Value,
    (width, height): (u32, u32),
) -> Value {
    json!({
        "version": 1,
        "camera": { "position": [offset, offset, offset + 4.0], "target": [offset, offset, offset], "vertical_fov_degrees": 60 },
        "geometry": geometry, "lights": lights, "media": media,
        "render": { "technique": "reference", "width": width, "height": height, "samples": 4 },
    })
}

fn lamp(at: [f64; 3]) -> Value {
    json!([{ "kind": "point", "position": at, "intensity": 10, "radius": 1e-4 }])
}

fn floor(offset: f64) -> Value {
    json!([{ "kind": "quad", "corner": [offset - 5.0, offset - 1.0, offset + 5.0], "edge_u": [10, 0, 0], "edge_v": [0, 0, -10],
        "material": { "base_color": 0.7, "roughness": 0.3 } }])
}

fn mean(scene: &Value) -> f64 {
    let still = estimate::render(scene);
    let sum: f64 = still.radiance.iter().map(|p| f64::from(p[1])).sum();
    sum / still.radiance.len() as f64
}

const SIZE: (u32, u32) = (12, 9);

#[test]
fn every_depth_and_every_phase_function_is_finite() {
    for tau in [0.0, 1e-6, 1e-3, 1.0, 1e2, 1e4] {
        for g in [0.0, 0.5, -0.5, 0.99, -0.99, 0.999] {
            let media = json!([
                { "kind": "homogeneous", "sigma_t": 0.5 * tau, "albedo": 0.9, "g": g,
                    "bounds": { "min": [-1, -1, -1], "max": [1, 1, 1] } },
                { "kind": "height_fog", "sigma_t": 0.2 * tau, "albedo": 0.9, "g": g, "falloff": 2 },
                { "kind": "sphere", "sigma_t": tau, "albedo": 0.9, "g": g, "center": [0, 0.5, 0], "radius": 0.7 }]);
            let found = mean(&scene(
                0.0,
                &media,
                &lamp([0.3, 1.5, 0.2]),
                &floor(0.0),
                SIZE,
            ));
            assert!(found > 0.0 || tau > 10.0, "tau {tau} g {g}: dark");
        }
    }
}

#[test]
fn a_million_metres_from_the_origin_the_picture_is_the_same() {
    let pictures = [0.0, 1e6].map(|o| {
        let media = json!([
            { "kind": "homogeneous", "sigma_t": 0.5, "albedo": 0.9, "bounds": { "min": [o - 1.0, o - 1.0, o - 1.0], "max": [o + 1.0, o + 1.0, o + 1.0] } },
            { "kind": "height_fog", "sigma_t": 0.1, "albedo": 0.9, "falloff": 1, "origin": [o, o, o] },
            { "kind": "sphere", "sigma_t": 2, "albedo": 0.9, "center": [o, o + 0.5, o], "radius": 0.7 }]);
        let still = estimate::render(&scene(o, &media, &lamp([o + 0.3, o + 1.5, o + 0.2]), &floor(o), SIZE));
        still.radiance
    });
    // Positions are subtracted in f64 before they are rounded: only binary fractions differ.
    for (near, far) in pictures[0].iter().zip(&pictures[1]) {
        assert!(
            (near[1] - far[1]).abs() <= 2e-3 * near[1].max(0.01),
            "{near:?} and {far:?}"
        );
    }
}

#[test]
fn lights_on_the_ray_in_the_camera_and_on_surfaces_are_finite() {
    let media = json!([{ "kind": "homogeneous", "sigma_t": 0.3, "albedo": 0.95, "g": 0.9 }]);
    for at in [
        [0.0, 0.0, 0.0],
        [0.0, 0.0, 4.0],
        [0.0, -1.0, 0.0],
        [0.0, 0.0, 5.0],
        [0.0, 0.0, 4.0 - 1e-7],
    ] {
        mean(&scene(0.0, &media, &lamp(at), &floor(0.0), (1, 1)));
        mean(&scene(0.0, &media, &lamp(at), &floor(0.0), SIZE));
    }
    // A camera in an emitter, and on its surface.
    let ball = |z: f64| json!([{ "kind": "box", "min": [-0.5, -0.5, z - 0.5], "max": [0.5, 0.5, z + 0.5], "material": { "base_color": 0.5, "emission": 2 } }]);
    for z in [4.0, 4.5, 3.5] {
        mean(&scene(0.0, &media, &json!([]), &ball(z), SIZE));
    }
}

#[test]
fn media_of_nothing_are_nothing() {
    for medium in [
        json!({ "kind": "homogeneous", "sigma_s": 0, "sigma_a": 0 }),
        json!({ "kind": "height_fog", "sigma_t": 1, "albedo": 1, "falloff": 1, "density_scale": 0 }),
        json!({ "kind": "sphere", "sigma_s": 0, "sigma_a": 0, "center": [0, 0, 0], "radius": 1 }),
        json!({ "kind": "sphere", "sigma_s": 5, "sigma_a": 5, "center": [0, 0, 0], "radius": 1e-6 }),
        json!({ "kind": "homogeneous", "sigma_s": 5, "sigma_a": 5, "bounds": { "min": [0, 0, 0], "max": [0, 0, 0] } }),
    ] {
        // A zero extent may be refused, which is an answer too.
        let description = scene(
            0.0,
            &json!([medium]),
            &lamp([0.3, 1.5, 0.2]),
            &floor(0.0),
            SIZE,
        );
        let parsed = tyndall_scene::SceneDescription::from_json(&description.to_string());
        if parsed
            .ok()
            .and_then(|d| tyndall_scene::build(d, None).ok())
            .is_none()
        {
            println!("refused: {medium}");
            continue;
        }
        let with = estimate::render(&description);
        let without = estimate::render(&scene(
            0.0,
            &json!([]),
            &lamp([0.3, 1.5, 0.2]),
            &floor(0.0),
            SIZE,
        ));
        for (a, b) in with.radiance.iter().zip(&without.radiance) {
            assert!(
                (a[1] - b[1]).abs() <= 1e-4 * b[1].max(1e-3),
                "{medium}: {a:?} for {b:?}"
            );
        }
    }
}

#[test]
fn odd_and_tiny_pictures_are_whole() {
    let media = json!([{ "kind": "homogeneous", "sigma_t": 0.3, "albedo": 0.9 }]);
    for size in [(1, 1), (1, 7), (9, 1), (17, 3), (8, 8), (65, 2)] {
        let still = estimate::render(&scene(
            0.0,
            &media,
            &lamp([0.3, 1.5, 0.2]),
            &floor(0.0),
            size,
        ));
        assert_eq!(still.radiance.len(), (size.0 * size.1) as usize);
        assert!(
            still.radiance.iter().all(|p| p[1] > 0.0),
            "{size:?}: every pixel is lit"
        );
    }
}

#[test]
fn triangles_without_area_do_no_harm() {
    let media = json!([{ "kind": "homogeneous", "sigma_t": 0.3, "albedo": 0.9 }]);
    let sliver = json!({ "kind": "mesh",
        "positions": [[-1, 0, 0], [1, 0, 0], [0, 0, 0], [0, 1, 0], [0, 1, 0], [1e-9, 1, 0], [0.5, 0.5, 0], [0.5, 0.5, 0], [0.5, 0.5, 0],
            [-2, -0.5, 0], [2, -0.5, 0], [2, -0.499_999_9, 0]],
        "indices": [[0, 1, 2], [3, 4, 5], [6, 7, 8], [9, 10, 11]],
        "material": { "base_color": 0.5, "emission": 3 } });
    let mut geometry = floor(0.0);
    geometry.as_array_mut().expect("a list").push(sliver);
    mean(&scene(0.0, &media, &lamp([0.3, 1.5, 0.2]), &geometry, SIZE));
}

#[test]
fn extreme_densities_side_by_side_are_finite() {
    let media = json!([
        { "kind": "sphere", "sigma_t": 1e6, "albedo": 0.5, "center": [-1, 0, 0], "radius": 0.5 },
        { "kind": "sphere", "sigma_t": [1e-6, 1, 1e4], "albedo": [1, 0.5, 0.01], "g": 0.99, "center": [1, 0, 0], "radius": 0.5 },
        { "kind": "height_fog", "sigma_t": 1e-5, "albedo": 0.9, "falloff": 10, "g": -0.99 }]);
    let lights = json!([
        { "kind": "spot", "position": [0, 3, 0], "direction": [0, -1, 0], "intensity": [1e-6, 1, 1e6], "outer_angle_degrees": 0.1 },
        { "kind": "environment", "radiance": [1e-6, 1, 1e4] }]);
    mean(&scene(0.0, &media, &lights, &floor(0.0), SIZE));
}

#[test]
fn fog_far_below_the_camera_scatters_where_it_is() {
    // 400 scale heights down: the sunlit fog is as bright as just above it.
    let fog = json!([{ "kind": "height_fog", "sigma_t": 1, "albedo": 0.5, "falloff": 2 }]);
    let sun = json!([{ "kind": "directional", "direction": [0, -1, 0], "irradiance": 1 }]);
    let seen = |height: f64| {
        mean(&json!({
            "version": 1,
            "camera": { "position": [0, height, 0], "target": [0, 0, 0], "up": [0, 0, 1], "vertical_fov_degrees": 1 },
            "geometry": [{ "kind": "quad", "corner": [-9, -5, 9], "edge_u": [18, 0, 0], "edge_v": [0, 0, -18], "material": { "base_color": 0 } }],
            "lights": sun, "media": fog,
            "render": { "technique": "reference", "width": 16, "height": 16, "samples": 64 },
        }))
    };
    let (near, far) = (seen(10.0), seen(200.0));
    assert!(
        (near / far - 1.0).abs() < 0.02,
        "{near} from 10 m, {far} from 200 m"
    );
}

#[test]
fn fog_without_edge_or_absorption_makes_no_dispatch_long() {
    let scene = gpu::scene(&json!({
        "version": 1,
        "camera": { "position": [0, 0, 0], "target": [0, 0, -1] },
        "lights": [{ "kind": "point", "position": [0.5, 0.2, -3], "intensity": 1 }],
        "media": [{ "kind": "homogeneous", "sigma_s": 0.5, "sigma_a": 0 }],
        "render": { "technique": "reference", "width": 64, "height": 48, "time_seconds": 6 },
    }));
    estimate::with_renderer(|renderer| {
        let mut view = renderer
            .create_view(Arc::new(scene), 64, 48)
            .expect("renders");
        // Software drivers compile in the first dispatch.
        renderer.render(&mut view, 0).expect("renders");
        renderer.wait().expect("a device that answers");
        assert!(matches!(view.take_finished(), Some(Ok(_))));
        let started = Instant::now();
        let mut longest = 0.0_f64;
        // The paths never end by themselves: each dispatch follows a share of their segments.
        while started.elapsed().as_secs() < 3 {
            renderer.render(&mut view, 0).expect("renders");
            renderer.wait().expect("a device that answers");
            let Some(frame) = view.take_finished() else {
                continue;
            };
            let frame = frame.expect("the frame can be read");
            let pass = frame
                .pass_times
                .iter()
                .find(|time| time.name == "reference");
            let seconds = pass.map_or(frame.render_micros as f32, |time| time.micros);
            longest = longest.max(f64::from(seconds) * 1e-6);
            assert!(frame.stats.unfinished > 0, "every path is endless");
        }
        println!("longest dispatch {longest:.3} s");
        assert!(longest < 1.0, "{longest} s");
        let still = renderer
            .render_still(&mut view, |_| {})
            .expect("the time is up");
        assert!(
            started.elapsed().as_secs() < 20,
            "it ends soon after its time"
        );
        assert!(still.truncated > 0, "and says that light is missing");
    });
}
