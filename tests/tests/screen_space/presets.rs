//! The filters against exact kernels on presets, and in motion.

use tyndall_render::Still;
use tyndall_scene::{CorrectionMode, Scene, ScreenSpaceFilter, StopRule, Technique, presets};
use tyndall_tests::gpu;

use super::{differ, render, with_filter};

fn preset(name: &str) -> Scene {
    let description = presets::description(name).expect("a preset");
    let mut scene = tyndall_scene::build(description, None)
        .expect("valid")
        .scene;
    scene.render.technique = Technique::ScreenSpace;
    scene.render.correction = CorrectionMode::Off;
    scene.render.stop = StopRule::Samples(1);
    [scene.render.width, scene.render.height] = [96, 54];
    scene.render.screen_space.in_scatter = false;
    scene
}

#[test]
fn the_default_filter_is_within_seven_percent_of_exact_kernels_on_presets() {
    for name in ["street_night", "light_shafts", "smoke_plume"] {
        let scene = preset(name);
        let exact = render(with_filter(&scene, ScreenSpaceFilter::Gather));
        let splat = differ(&render(scene.clone()), &exact);
        let levels = differ(
            &render(with_filter(&scene, ScreenSpaceFilter::Hierarchical)),
            &exact,
        );
        println!("{name}: splat {splat:.4}, hierarchical {levels:.4}");
        assert!(splat < 0.07, "{name}: splat {splat}");
        assert!(levels < 0.20, "{name}: hierarchical {levels}");
    }
}

/// Pictures of a pan by a quarter of a pixel a frame.
fn pan(scene: &Scene) -> Vec<Still> {
    let camera = &scene.camera;
    let ahead = camera.target - camera.position;
    let right = ahead.cross(camera.up.as_dvec3()).normalize_or_zero() * ahead.length();
    (0..4)
        .map(|frame| {
            let mut moved = scene.clone();
            moved.camera.target += right * (0.25 * f64::from(frame) / 54.0);
            render(moved)
        })
        .collect()
}

#[test]
fn a_slow_pan_flickers_no_more_than_exact_kernels_do() {
    let scene = preset("street_night");
    // Lamps of a pixel's size come and go with the sampling; nobody sees by how much they are too bright.
    let dimmed = |still: &Still| {
        let mut still = still.clone();
        let most = 4.0 * gpu::mean_rgb(&still)[0] as f32;
        for value in still.radiance.iter_mut().flatten() {
            *value = value.min(most);
        }
        still
    };
    let change = |stills: &[Still]| {
        let stills: Vec<_> = stills.iter().map(dimmed).collect();
        let pairs = stills.windows(2).map(|pair| differ(&pair[1], &pair[0]));
        pairs.sum::<f64>() / 3.0
    };
    let exact = change(&pan(&with_filter(&scene, ScreenSpaceFilter::Gather)));
    let splat = change(&pan(&scene));
    println!("change from frame to frame: exact {exact:.4}, splat {splat:.4}");
    assert!(splat < 1.05 * exact, "{splat} for {exact}");
}
