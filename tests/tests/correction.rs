//! The corrected picture against the published images of two independent path tracers, with real samples.

#![allow(clippy::print_stdout, reason = "tests print what they measure")]

use std::sync::Arc;
use std::time::Instant;

use tyndall_metrics::{Image, relative_rmse_trim, relative_rmse_trim_debiased};
use tyndall_render::{RenderOutcome, Renderer, Still, View};
use tyndall_scene::{CorrectionMode, Light, Scene, ShadowMode, StopRule, Technique};
use tyndall_tests::{gpu, published};

/// Samples a pixel.
const LADDER: [u32; 3] = [1, 4, 16];

/// As on the page: mapped shadows, interleaved strata.
fn interactive(scene: &mut Scene) {
    scene.render.technique = Technique::SingleScattering;
    scene.render.single_scattering.steps = 64;
    scene.render.single_scattering.interleave = 4;
    scene.render.single_scattering.equiangular = true;
    scene.render.shadows.mode = ShadowMode::Mapped;
    scene.render.shadows.resolution = 2048;
}

/// The correction alone: a black picture is brought toward the traced one.
fn black(scene: &mut Scene) {
    scene.render.technique = Technique::Reference;
}

/// Errors of one rung, relative to the truth's mean.
struct Rung {
    traced: f64,
    base: f64,
    corrected: f64,
    /// What the correction says of itself, over the whole picture.
    expected: f64,
    /// The same of the picture as it is, its worst pixels included.
    whole: f64,
    /// Expected by found, of each whole block of 32×32 pixels, in rising order.
    blocks: Vec<f64>,
}

/// Side of the blocks that expected errors are judged over. Unit: pixel.
const SIDE: usize = 32;

/// Ratios of expected to found errors over blocks; the truth's own variance is taken off the found ones.
fn block_ratios(still: &Still, truth: &Image) -> Vec<f64> {
    let width = still.frame.width as usize;
    let expected = still.square_error.as_ref().expect("it was corrected");
    let variance = truth.variance().expect("the published images have one");
    let mean = |v: &[f32; 3]| v.iter().map(|v| f64::from(*v)).sum::<f64>() / 3.0;
    let mut ratios = Vec::new();
    for top in (0..=still.frame.height as usize - SIDE).step_by(SIDE) {
        for left in (0..=width - SIDE).step_by(SIDE) {
            let (mut told, mut found) = (0.0, 0.0);
            for index in
                (top..top + SIDE).flat_map(|y| (left..left + SIDE).map(move |x| y * width + x))
            {
                let [r, g, b, _] = still.radiance[index];
                let off: [f32; 3] = std::array::from_fn(|c| [r, g, b][c] - truth.rgb()[index][c]);
                told += f64::from(expected[index]);
                found += mean(&off.map(|d| d * d)) - mean(&variance[index]);
            }
            ratios.push((told / found.max(1e-12)).sqrt());
        }
    }
    ratios.sort_by(f64::total_cmp);
    ratios
}

fn error(radiance: &[[f32; 4]], still: &Still, truth: &Image) -> f64 {
    let (width, height) = (still.frame.width, still.frame.height);
    let image = Image::from_rgba(width, height, radiance).expect("a still has its pixels");
    relative_rmse_trim_debiased(&image, truth).expect("pictures of one size")
}

fn climb(name: &str, label: &str, settings: fn(&mut Scene)) -> Option<Vec<Rung>> {
    let truth = published::find(name, "full")?;
    let mut renderer = gpu::renderer();
    let mut rungs = Vec::new();
    for samples in LADDER {
        let mut scene = truth.scene.clone();
        settings(&mut scene);
        scene.render.correction = CorrectionMode::Always;
        scene.render.stop = StopRule::Samples(samples);
        let started = Instant::now();
        let still = gpu::render(&mut renderer, scene);
        let seconds = started.elapsed().as_secs_f64();
        let traced = still.traced.as_ref().expect("samples were traced");
        let nothing = vec![[0.0; 4]; traced.len()];
        let rung = Rung {
            traced: error(traced, &still, &truth.image),
            base: error(
                still.base.as_ref().unwrap_or(&nothing),
                &still,
                &truth.image,
            ),
            corrected: error(&still.radiance, &still, &truth.image),
            expected: f64::from(still.frame.stats.estimated_error.expect("an estimate")),
            whole: tyndall_metrics::relative_rmse_debiased(&gpu::image(&still), &truth.image)
                .expect("pictures of one size"),
            blocks: block_ratios(&still, &truth.image),
        };
        let blocks = &rung.blocks;
        println!(
            "{name} {label} n {samples}: traced {:.4}, base {:.4}, corrected {:.4}; expected {:.4}, found {:.4}, blocks {:.2} {:.2} {:.2}; {seconds:.2} s",
            rung.traced,
            rung.base,
            rung.corrected,
            rung.expected,
            rung.whole,
            blocks[0],
            blocks[blocks.len() / 2],
            blocks[blocks.len() - 1]
        );
        rungs.push(rung);
    }
    Some(rungs)
}

fn gains(name: &str) {
    for (label, settings) in [
        ("single scattering", interactive as fn(&mut Scene)),
        ("black", black),
    ] {
        let Some(rungs) = climb(name, label, settings) else {
            return;
        };
        for rung in &rungs {
            assert!(rung.expected >= 0.5 * rung.corrected, "optimistic");
            let best = rung.traced.min(rung.base);
            assert!(
                rung.corrected.powi(2) <= 1.05 * best.powi(2),
                "{} against {best}",
                rung.corrected
            );
        }
        for pair in rungs.windows(2) {
            // One sample a pixel leaves the finest band alone, which is sometimes luck.
            assert!(
                pair[1].corrected <= 1.25 * pair[0].corrected,
                "more samples, more error"
            );
        }
    }
}

#[test]
fn light_shafts_gain() {
    gains("light_shafts");
}

#[test]
fn fog_box_gains() {
    gains("fog_box");
}

#[test]
fn a_smoke_plume_gains() {
    gains("smoke_plume");
}

/// A scene whose camera walks sideways, small enough to be traced often.
fn walk(scene: &Scene, step: u32) -> Arc<Scene> {
    let mut scene = scene.clone();
    let side = 0.02 * f64::from(step);
    scene.camera.position.x += side;
    scene.camera.target.x += side;
    Arc::new(scene)
}

/// Renders one frame of a view and waits for it.
fn frame(renderer: &mut Renderer, view: &mut View) {
    let outcome = renderer.render(view, 0).expect("a frame");
    assert_eq!(outcome, RenderOutcome::Submitted);
    renderer.wait().expect("the device works");
    assert!(view.take_finished().is_some(), "the frame arrived");
}

fn walking(name: &str) -> Option<Scene> {
    let mut scene = published::find(name, "full")?.scene;
    (scene.render.width, scene.render.height) = (96, 72);
    interactive(&mut scene);
    scene.render.stop = StopRule::Samples(64);
    Some(scene)
}

fn error_of(radiance: &[[f32; 4]], truth: &Image) -> f64 {
    let image = Image::from_rgba(truth.width(), truth.height(), radiance).expect("a picture");
    relative_rmse_trim_debiased(&image, truth).expect("pictures of one size")
}

/// Errors of the last picture of a walk of `steps`, each of one frame.
fn walked(scene: &Scene, mode: CorrectionMode, steps: u32, truth: &Image) -> f64 {
    let mut renderer = gpu::renderer();
    let mut scene = scene.clone();
    scene.render.correction = mode;
    let size = (scene.render.width, scene.render.height);
    let mut view = renderer
        .create_view(walk(&scene, 0), size.0, size.1)
        .expect("a view");
    for step in 0..=steps {
        renderer
            .update_view(&mut view, walk(&scene, step))
            .expect("a camera");
        frame(&mut renderer, &mut view);
    }
    error_of(&renderer.read_radiance(&view).expect("a picture"), truth)
}

fn truth_after(scene: &Scene, steps: u32) -> Image {
    let mut scene = Scene::clone(&walk(scene, steps));
    scene.render.technique = Technique::Reference;
    scene.render.stop = StopRule::Samples(512);
    scene.render.seed = 77;
    let still = gpu::render(&mut gpu::renderer(), scene);
    let image = gpu::image(&still);
    image
        .with_variance(still.variance.expect("the reference knows it"))
        .expect("a variance of its size")
}

fn moves(name: &str) {
    let Some(scene) = walking(name) else { return };
    let steps = 8;
    let truth = truth_after(&scene, steps);
    let uncorrected = walked(&scene, CorrectionMode::Off, steps, &truth);
    let first = walked(&scene, CorrectionMode::Always, 0, &truth_after(&scene, 0));
    let carried = walked(&scene, CorrectionMode::Always, steps, &truth);
    println!(
        "{name}: uncorrected {uncorrected:.4}, corrected first frame {first:.4}, after {steps} steps {carried:.4}"
    );
    assert!(first < 0.5 * uncorrected, "{first} of {uncorrected}");
    assert!(carried < 0.9 * first, "{carried} of {first}");
}

#[test]
fn a_walk_through_light_shafts_gathers_samples() {
    moves("light_shafts");
}

#[test]
fn a_walk_past_a_smoke_plume_gathers_samples() {
    moves("smoke_plume");
}

#[test]
fn a_light_that_goes_out_leaves_no_ghost() {
    let Some(mut scene) = walking("light_shafts") else {
        return;
    };
    scene.render.correction = CorrectionMode::Always;
    let mut renderer = gpu::renderer();
    let mut view = renderer
        .create_view(walk(&scene, 0), 96, 72)
        .expect("a view");
    for step in 0..4 {
        renderer
            .update_view(&mut view, walk(&scene, step))
            .expect("a camera");
        frame(&mut renderer, &mut view);
    }
    let mean = |renderer: &Renderer, view: &View| {
        let picture = renderer.read_radiance(view).expect("a picture");
        picture.iter().map(|p| f64::from(p[0])).sum::<f64>() / picture.len() as f64
    };
    let lit = mean(&renderer, &view);
    for light in &mut scene.lights {
        match light {
            Light::Point(point) => point.intensity = [0.0; 3],
            Light::Spot(spot) => spot.intensity = [0.0; 3],
            Light::Directional(sun) => sun.irradiance = [0.0; 3],
        }
    }
    scene.environment = None;
    renderer
        .update_view(&mut view, walk(&scene, 4))
        .expect("a dark scene");
    frame(&mut renderer, &mut view);
    let dark = mean(&renderer, &view);
    assert!(lit > 0.0, "lit: {lit}");
    assert!(dark <= 1e-6 * lit, "dark: {dark} of {lit}");
}

#[test]
fn a_picture_that_came_to_rest_is_free_of_its_history() {
    let Some(mut scene) = walking("light_shafts") else {
        return;
    };
    scene.render.correction = CorrectionMode::Always;
    scene.render.stop = StopRule::Samples(256);
    let mut renderer = gpu::renderer();
    let mut view = renderer
        .create_view(walk(&scene, 0), 96, 72)
        .expect("a view");
    for step in 0..6 {
        renderer
            .update_view(&mut view, walk(&scene, step))
            .expect("a camera");
        frame(&mut renderer, &mut view);
    }
    let moved = renderer.render_still(&mut view, |_| {}).expect("a still");
    let mut fresh = renderer
        .create_view(walk(&scene, 5), 96, 72)
        .expect("a view");
    let still = renderer.render_still(&mut fresh, |_| {}).expect("a still");
    // What was carried has faded: the corrected pictures differ by their noise, like any two.
    assert_eq!(moved.frame.samples, still.frame.samples);
    let apart = relative_rmse_trim(&gpu::image(&moved), &gpu::image(&still)).expect("two pictures");
    let errors = [&moved, &still].map(|s| s.frame.stats.estimated_error.expect("an estimate"));
    let expected = f64::from(errors[0].hypot(errors[1]));
    println!("apart {apart:.4}, expected {expected:.4} of {errors:?}");
    assert!(apart < 1.3 * expected, "{apart} of {expected}");
    assert!(errors[0] < 1.1 * errors[1], "{errors:?}");
}

#[test]
fn hostile_pictures_stay_finite() {
    for (width, height) in [(1, 1), (1, 7), (17, 5), (33, 64)] {
        for samples in [1, 5] {
            for (label, media) in [
                (
                    "thin",
                    serde_json::json!([{"kind": "homogeneous", "sigma_s": [1e-9, 1e-9, 1e-9], "sigma_a": [0.0, 0.0, 0.0]}]),
                ),
                (
                    "dense",
                    serde_json::json!([{"kind": "homogeneous", "sigma_s": [100.0, 10.0, 1e4], "sigma_a": [20.0, 5.0, 2e3], "g": 0.99}]),
                ),
                ("none", serde_json::json!([])),
            ] {
                for technique in ["single_scattering", "reference"] {
                    let scene = gpu::scene(&serde_json::json!({
                        "version": 1,
                        "camera": {"position": [0.0, 0.0, 3.0], "target": [0.0, 0.0, 0.0]},
                        "lights": [{"kind": "point", "position": [0.0, 0.1, 0.0], "intensity": [1e9, 1.0, 1e-9]}],
                        "media": media,
                        "render": {"technique": technique, "correction": "always", "width": width, "height": height, "samples": samples}
                    }));
                    let still = gpu::render(&mut gpu::renderer(), scene);
                    let finite = still.radiance.iter().flatten().all(|v| v.is_finite());
                    assert!(finite, "{label} {technique} {width}×{height} {samples}");
                }
            }
        }
    }
}
