//! Lights that cannot add enough to a ray to be seen are left out of it: the picture stays within the
//! stated share of the full one, and what that saves.

use std::sync::Arc;

use serde_json::{Value, json};
use tyndall_quality::relative_rmse;
use tyndall_render::{Renderer, Still};
use tyndall_scene::{Scene, StopRule};
use tyndall_tests::gpu;
use tyndall_tests::pass_times::least_millis;

/// Samples of a picture.
const FRAMES: u32 = 6;

/// Picture, and the least time of its march: what else runs on the machine only adds. Unit: ms.
fn shot(renderer: &mut Renderer, scene: &Scene) -> (Still, f64) {
    let mut scene = scene.clone();
    scene.render.stop = StopRule::Samples(FRAMES);
    let (width, height) = (scene.render.width, scene.render.height);
    let mut view = renderer
        .create_view(Arc::new(scene), width, height)
        .expect("rendered");
    let [least] = least_millis(renderer, &mut view, FRAMES - 1, ["single_scattering"]);
    let still = renderer.render_still(&mut view, |_| {}).expect("rendered");
    (still, least)
}

/// A corridor of fog along −z with `lights` lamps under its ceiling, two every 6 m.
fn corridor(lights: usize, fog: &Value, interleave: u32) -> Scene {
    let lamp = |i: usize| {
        let (side, row) = ((i % 2) as f64 * 2.0 - 1.0, (i / 2) as f64);
        // In no order of distance.
        let row = (row * 13.0) % (lights as f64 / 2.0).max(1.0);
        json!({ "kind": "point", "position": [1.5 * side, 2.6, -2.0 - 6.0 * row], "intensity": [6, 5, 4],
            "radius": 0.05, "casts_shadows": false })
    };
    let lamps: Vec<Value> = (0..lights).map(lamp).collect();
    let length = 3.0 * lights as f64 + 20.0;
    gpu::scene(&json!({
        "version": 1,
        "camera": { "position": [0.2, 1.7, 2], "target": [0, 1.6, -10], "vertical_fov_degrees": 60 },
        "geometry": [
            { "kind": "quad", "corner": [-2, 0, 6], "edge_u": [4, 0, 0], "edge_v": [0, 0, -length],
                "material": { "base_color": 0.5 } },
            { "kind": "quad", "corner": [-2, 0, 6], "edge_u": [0, 0, -length], "edge_v": [0, 3, 0],
                "material": { "base_color": 0.5 } },
            { "kind": "quad", "corner": [2, 0, 6], "edge_u": [0, 3, 0], "edge_v": [0, 0, -length],
                "material": { "base_color": 0.5 } }],
        "lights": lamps, "media": [fog],
        "render": { "width": 128, "height": 72, "samples": 1,
            // As many strata a pixel, however many share them.
            "single_scattering": { "steps": 32 * interleave * interleave, "interleave": interleave } },
    }))
}

/// What leaving out the weak lights does.
struct Found {
    /// Relative RMSE against the picture with all of them, and a pixel's greatest relative difference.
    error: f64,
    greatest: f64,
    /// Share of the full march's time.
    ratio: f64,
}

fn compare(name: &str, scene: &Scene) -> Found {
    let mut renderer = gpu::renderer();
    renderer.set_unskipped(true);
    let (full, full_millis) = shot(&mut renderer, scene);
    renderer.set_unskipped(false);
    let (culled, millis) = shot(&mut renderer, scene);
    let mut greatest = 0.0_f64;
    for (a, b) in culled.radiance.iter().zip(&full.radiance) {
        for c in 0..3 {
            greatest = greatest.max(f64::from((a[c] - b[c]).abs() / b[c].max(1e-9)));
        }
    }
    let error = relative_rmse(&gpu::image(&culled), &gpu::image(&full)).expect("same size");
    let ratio = millis / full_millis;
    println!(
        "{name}: march {millis:.2} of {full_millis:.2} ms = {ratio:.2}, relRMSE {error:.1e}, greatest relative difference {greatest:.1e}"
    );
    Found {
        error,
        greatest,
        ratio,
    }
}

#[test]
fn weak_lights_of_a_long_corridor_are_left_out_and_the_picture_stays() {
    let open = json!({ "kind": "homogeneous", "sigma_t": 0.15, "albedo": 0.9, "g": 0.6 });
    let bounded = json!({ "kind": "homogeneous", "sigma_t": 0.15, "albedo": 0.9, "g": 0.6,
        "bounds": { "min": [-2, 0, -220], "max": [2, 3, 6] } });
    for (name, fog, interleave) in [
        ("open", &open, 1),
        ("bounded", &bounded, 1),
        ("open, 2×2", &open, 2),
    ] {
        let scene = corridor(64, fog, interleave);
        let found = compare(&format!("64 lights, {name}"), &scene);
        // The bound is of what a light adds, not of what its strata happen to see of it.
        assert!(found.error < 1e-3, "{name}: {}", found.error);
        assert!(found.greatest < 3e-3, "{name}: {}", found.greatest);
        assert!(found.ratio < 0.9, "{name}: {}", found.ratio);
    }
}

#[test]
fn looking_for_weak_lights_costs_little_where_there_are_none() {
    // Thin fog and few lamps: little is left out.
    let fog = json!({ "kind": "homogeneous", "sigma_t": 0.005, "albedo": 0.9, "g": 0.6 });
    let found = compare("16 lights", &corridor(16, &fog, 1));
    assert!(found.error < 1e-3, "{}", found.error);
    // The machines that run this are shared: the ratio is noisy.
    assert!(found.ratio < 1.5, "{}", found.ratio);
}
