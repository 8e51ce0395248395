//! Same seed, same bits: again, in other slices, in two goes.

use std::sync::Arc;
use std::time::Duration;

use serde_json::json;
use tyndall_render::{Still, View};
use tyndall_scene::{Scene, StopRule};
use tyndall_tests::{estimate, gpu};

/// Media, surfaces, lights of all kinds.
fn scene(seed: u64, samples: u32) -> Scene {
    gpu::scene(&json!({
        "version": 1,
        "camera": { "position": [0, 1, 5], "target": [0, 0.8, 0], "vertical_fov_degrees": 45 },
        "geometry": [
            { "kind": "quad", "corner": [-4, 0, 4], "edge_u": [8, 0, 0], "edge_v": [0, 0, -8],
                "material": { "base_color": [0.7, 0.5, 0.3], "roughness": 0.4 } },
            { "kind": "box", "min": [-1.5, 1.8, -0.5], "max": [-0.5, 2, 0.5],
                "material": { "base_color": 0, "emission": [4, 5, 6] } }],
        "lights": [
            { "kind": "point", "position": [1, 2, 0], "intensity": 3 },
            { "kind": "environment", "radiance": 0.2 }],
        "media": [
            { "kind": "height_fog", "sigma_t": [0.1, 0.2, 0.3], "albedo": 0.9, "g": 0.5, "falloff": 0.5 },
            { "kind": "sphere", "sigma_t": 2, "albedo": 0.8, "center": [0.5, 0.7, 0], "radius": 0.7 }],
        "render": { "technique": "reference", "width": 37, "height": 23, "samples": samples, "seed": seed },
    }))
}

fn bits(still: &Still) -> Vec<[u32; 4]> {
    still.radiance.iter().map(|p| p.map(f32::to_bits)).collect()
}

fn view(scene: Scene) -> View {
    let (width, height) = (scene.render.width, scene.render.height);
    estimate::with_renderer(|renderer| renderer.create_view(Arc::new(scene), width, height))
        .expect("the scene is rendered")
}

fn finish(view: &mut View) -> Still {
    estimate::with_renderer(|renderer| renderer.render_still(view, |_| {}))
        .expect("the picture is rendered")
}

#[test]
fn the_same_seed_gives_the_same_bits_and_another_gives_others() {
    let first = finish(&mut view(scene(3, 16)));
    let again = finish(&mut view(scene(3, 16)));
    let other = finish(&mut view(scene(4, 16)));
    assert_eq!(bits(&first), bits(&again));
    assert_eq!(first.variance, again.variance);
    let differing = bits(&first)
        .iter()
        .zip(bits(&other))
        .filter(|(a, b)| **a != *b)
        .count();
    assert!(differing > 37 * 23 * 9 / 10, "{differing} pixels differ");
}

#[test]
fn a_seed_above_32_bits_counts() {
    let low = finish(&mut view(scene(5, 4)));
    let high = finish(&mut view(scene(5 + (1 << 33), 4)));
    assert_ne!(bits(&low), bits(&high));
}

#[test]
fn the_cutting_into_slices_changes_no_bit() {
    let whole = finish(&mut view(scene(3, 16)));
    for micros in [1, 500, 10_000_000] {
        let mut cut = view(scene(3, 16));
        cut.set_slice_budget(Duration::from_micros(micros));
        let still = finish(&mut cut);
        assert_eq!(bits(&still), bits(&whole), "budget of {micros} µs");
        assert_eq!(still.variance, whole.variance, "budget of {micros} µs");
    }
}

#[test]
fn eight_samples_and_eight_more_are_sixteen() {
    let whole = finish(&mut view(scene(3, 16)));
    let mut resumed = view(scene(3, 8));
    let half = finish(&mut resumed);
    assert_ne!(bits(&half), bits(&whole));
    let mut more = resumed.scene().as_ref().clone();
    more.render.stop = StopRule::Samples(16);
    estimate::with_renderer(|renderer| renderer.update_view(&mut resumed, Arc::new(more)))
        .expect("the scene is rendered");
    let still = finish(&mut resumed);
    assert_eq!(still.frame.samples, 16);
    assert_eq!(bits(&still), bits(&whole));
    assert_eq!(still.variance, whole.variance);
}

#[test]
fn every_pixel_gets_every_sample() {
    let still = finish(&mut view(scene(3, 5)));
    let counts = still.samples_per_pixel.expect("the reference counts them");
    assert!(counts.iter().all(|n| *n == 5.0));
}

/// Paths of hundreds of segments: more than a dispatch's share.
fn thick(samples: u32) -> Scene {
    gpu::scene(&json!({
        "version": 1,
        "camera": { "position": [0, 0, 3], "target": [0, 0, 0], "vertical_fov_degrees": 30 },
        "lights": [{ "kind": "environment", "radiance": 1 }],
        "media": [{ "kind": "homogeneous", "sigma_t": 40, "albedo": 1,
            "bounds": { "min": [-1, -1, -1], "max": [1, 1, 1] } }],
        "render": { "technique": "reference", "width": 40, "height": 24, "samples": samples, "seed": 1 },
    }))
}

#[test]
fn paths_that_wait_for_the_next_dispatch_change_no_bit() {
    let whole = finish(&mut view(thick(8)));
    let mut cut = view(thick(8));
    cut.set_slice_budget(Duration::from_micros(200));
    let mut waited = 0;
    let mut frames = 0;
    while !cut.is_converged() && frames < 100 {
        let frame = estimate::with_renderer(|renderer| {
            renderer.render(&mut cut, 0).expect("renders");
            renderer.wait().expect("a device that answers");
            let frame = cut.take_finished();
            frame.map(|frame| frame.expect("the frame can be read"))
        });
        waited += frame.map_or(0, |frame| frame.stats.unfinished);
        frames += 1;
    }
    assert!(waited > 0, "no path was longer than its dispatch's share");
    // Whatever is left, and the picture itself.
    let mut scene = cut.scene().as_ref().clone();
    scene.camera.exposure_ev += 1.0;
    estimate::with_renderer(|renderer| renderer.update_view(&mut cut, Arc::new(scene)))
        .expect("the scene is rendered");
    let still = finish(&mut cut);
    let counts = still.samples_per_pixel.as_ref().expect("it counts them");
    assert!(counts.iter().all(|n| *n == 8.0));
    assert_eq!(bits(&still), bits(&whole), "after {frames} frames");
    assert_eq!(still.variance, whole.variance);
}
