//! What is carried from picture to picture.

use std::sync::Arc;
use std::time::Duration;

use tyndall_quality::{
    Image, PIXELS_PER_DEGREE, hdr_flip, relative_rmse_trim, relative_rmse_trim_debiased,
};
use tyndall_render::{RenderOutcome, Renderer, View};
use tyndall_scene::{CorrectionMode, Light, Scene, StopRule, Technique, presets};
use tyndall_tests::{gpu, published};

use super::interactive;

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
    assert!(
        matches!(view.take_finished(), Some(Ok(_))),
        "the frame arrived"
    );
}

fn walking(name: &str) -> Option<Scene> {
    let mut scene = published::find(name, "full")?.scene;
    (scene.render.width, scene.render.height) = (96, 72);
    interactive(&mut scene);
    // One a frame, however fast or busy this machine is.
    scene.render.stop = StopRule::Samples(1);
    Some(scene)
}

/// The pictures of a walk, one frame a step: of `scene` at each of `steps`.
fn walked(scene: &Scene, mode: CorrectionMode, steps: &[Arc<Scene>]) -> Vec<Image> {
    let mut renderer = gpu::renderer();
    let size = (scene.render.width, scene.render.height);
    let at = |step: &Arc<Scene>| {
        let mut scene = Scene::clone(step);
        scene.render.correction = mode;
        Arc::new(scene)
    };
    let mut view = renderer
        .create_view(at(&steps[0]), size.0, size.1)
        .expect("a view");
    // At least a whole sample a frame, however busy this machine is.
    view.set_slice_budget(Duration::from_mins(1));
    let mut pictures = Vec::new();
    for step in steps {
        renderer
            .update_view(&mut view, at(step))
            .expect("a change that is rendered");
        frame(&mut renderer, &mut view);
        let radiance = renderer.read_radiance(&view).expect("a picture");
        pictures.push(Image::from_rgba(size.0, size.1, &radiance).expect("a picture"));
    }
    pictures
}

fn truth_of(scene: &Scene) -> Image {
    truth_with(scene, 512)
}

fn truth_with(scene: &Scene, samples: u32) -> Image {
    let mut scene = scene.clone();
    scene.render.technique = Technique::Reference;
    scene.render.correction = CorrectionMode::Off;
    scene.render.stop = StopRule::Samples(samples);
    scene.render.seed = 77;
    let still = gpu::render(&mut gpu::renderer(), scene);
    let image = gpu::image(&still);
    image
        .with_variance(still.variance.expect("the reference knows it"))
        .expect("a variance of its size")
}

fn error_of(picture: &Image, truth: &Image) -> f64 {
    relative_rmse_trim_debiased(picture, truth).expect("pictures of one size")
}

/// By how much the errors of two pictures that follow one another differ, relative to the truth's mean:
/// what flickers. The pixels of which it is greatest, one in a thousand, are left out.
fn flicker(pictures: &[Image], truths: &[Image; 2]) -> f64 {
    let [before, after] = [pictures.len() - 2, pictures.len() - 1].map(|i| pictures[i].rgb());
    let mut squares: Vec<f64> = (0..after.len())
        .map(|i| {
            let change = |c: usize| {
                let error = after[i][c] - truths[1].rgb()[i][c];
                let last = before[i][c] - truths[0].rgb()[i][c];
                f64::from(error - last).powi(2)
            };
            (change(0) + change(1) + change(2)) / 3.0
        })
        .collect();
    squares.sort_by(f64::total_cmp);
    squares.truncate(squares.len() - squares.len() / 1000);
    let mean = truths[1].rgb().iter().flatten().map(|v| f64::from(*v));
    let mean = mean.sum::<f64>() / (3 * after.len()) as f64;
    (squares.iter().sum::<f64>() / squares.len() as f64).sqrt() / mean
}

/// What a sequence of changes, one a frame, does to the picture.
struct Sequence {
    uncorrected: f64,
    /// Of the first frame and the last.
    corrected: [f64; 2],
    /// Uncorrected, corrected.
    flicker: [f64; 2],
}

fn sequence(name: &str, steps: &[Arc<Scene>]) -> Sequence {
    let scene = &steps[0];
    let last = steps.len() - 1;
    let truths = [&steps[last - 1], &steps[last]].map(|step| truth_of(step));
    let first_truth = truth_of(scene);
    let plain = walked(scene, CorrectionMode::Off, steps);
    let corrected = walked(scene, CorrectionMode::Always, steps);
    let told = Sequence {
        uncorrected: error_of(&plain[last], &truths[1]),
        corrected: [
            error_of(&corrected[0], &first_truth),
            error_of(&corrected[last], &truths[1]),
        ],
        flicker: [flicker(&plain, &truths), flicker(&corrected, &truths)],
    };
    let flip = |picture: &Image, truth: &Image| {
        let flip = hdr_flip(picture, truth, PIXELS_PER_DEGREE).expect("pictures of one size");
        flip.map.mean()
    };
    println!(
        "{name}: error uncorrected {:.4}, corrected first frame {:.4}, after {last} steps {:.4}; change of the error from frame to frame {:.4} uncorrected, {:.4} corrected; FLIP of the last two frames {:.4} {:.4} uncorrected, {:.4} {:.4} corrected",
        told.uncorrected,
        told.corrected[0],
        told.corrected[1],
        told.flicker[0],
        told.flicker[1],
        flip(&plain[last - 1], &truths[0]),
        flip(&plain[last], &truths[1]),
        flip(&corrected[last - 1], &truths[0]),
        flip(&corrected[last], &truths[1]),
    );
    told
}

fn moves(name: &str) {
    let Some(scene) = walking(name) else { return };
    let steps: Vec<Arc<Scene>> = (0..=8).map(|step| walk(&scene, step)).collect();
    let told = sequence(name, &steps);
    let [first, carried] = told.corrected;
    assert!(first < 0.5 * told.uncorrected, "{first}");
    assert!(carried < 0.95 * first, "{carried} of {first}");
    let [uncorrected, corrected] = told.flicker;
    assert!(corrected < uncorrected, "{corrected} of {uncorrected}");
}

#[test]
fn a_walk_through_light_shafts_gathers_samples() {
    moves("light_shafts");
}

#[test]
fn a_walk_past_a_smoke_plume_gathers_samples() {
    moves("smoke_plume");
}

/// A medium that thickens by a twentieth of its first density every frame.
#[test]
fn a_medium_that_thickens_gathers_samples() {
    let Some(scene) = walking("light_shafts") else {
        return;
    };
    let thicker = |step: i32| {
        let mut scene = scene.clone();
        for medium in &mut scene.media {
            let more = 1.0 + 0.05 * step as f32;
            medium.sigma_s = medium.sigma_s.map(|v| v * more);
            medium.sigma_a = medium.sigma_a.map(|v| v * more);
        }
        Arc::new(scene)
    };
    let steps: Vec<Arc<Scene>> = (0..=12).map(thicker).collect();
    let told = sequence("light_shafts, thickening", &steps);
    for corrected in told.corrected {
        assert!(corrected < 0.5 * told.uncorrected, "{corrected}");
    }
    let [first, last] = told.corrected;
    assert!(last < 0.7 * first, "{last} of {first}");
}

/// Samples so few that most pixels know only what was carried to them: one of 8×8 pixels a frame while the
/// camera turns, one place of all such cells a frame once it rests.
#[test]
fn a_few_samples_of_a_turning_camera_leave_no_specks() {
    const LAST: u32 = 10;
    let description = presets::description("fogged_hall").expect("a preset");
    let mut scene = tyndall_scene::build(description, None)
        .expect("a scene")
        .scene;
    let (width, height) = (120, 75);
    let frames_a_sample = 8 * 8;
    (scene.render.width, scene.render.height) = (width, height);
    scene.render.stop = StopRule::Samples(1);
    let turned = |step: u32, mode: CorrectionMode| {
        let mut scene = scene.clone();
        scene.render.correction = mode;
        let camera = &mut scene.camera;
        let ahead = camera.target - camera.position;
        let (sin, cos) = (-0.04 * f64::from(step)).sin_cos();
        camera.target.x = camera.position.x + cos * ahead.x + sin * ahead.z;
        camera.target.z = camera.position.z - sin * ahead.x + cos * ahead.z;
        Arc::new(scene)
    };
    let truth = truth_with(&turned(LAST, CorrectionMode::Off), 128);
    let mut errors = Vec::new();
    for (mode, frames) in [
        (CorrectionMode::Off, &[0][..]),
        (
            CorrectionMode::Always,
            // The last one turning was the first.
            &[0, frames_a_sample / 2 - 1, frames_a_sample / 2 - 1],
        ),
    ] {
        let mut renderer = gpu::renderer();
        let mut view = renderer
            .create_view(turned(0, mode), width, height)
            .expect("a view");
        view.set_slice_budget(Duration::ZERO);
        for step in 0..=LAST {
            renderer
                .update_view(&mut view, turned(step, mode))
                .expect("a camera");
            frame(&mut renderer, &mut view);
        }
        for more in frames {
            for _ in 0..*more {
                frame(&mut renderer, &mut view);
            }
            let radiance = renderer.read_radiance(&view).expect("a picture");
            let picture = Image::from_rgba(width, height, &radiance).expect("a picture");
            errors.push(error_of(&picture, &truth));
        }
    }
    println!(
        "fogged hall: error uncorrected, turning, half and nearly all of a sample: {errors:.4?}"
    );
    assert!(errors[1] < 0.7 * errors[0], "{errors:?}");
    assert!(errors[2] < errors[1], "{errors:?}");
    assert!(errors[3] < errors[2], "{errors:?}");
}

/// What changed at once is in the next picture as if nothing had been carried.
#[test]
fn a_sudden_change_leaves_no_ghost() {
    let Some(scene) = walking("light_shafts") else {
        return;
    };
    let mut thin = scene.clone();
    for medium in &mut thin.media {
        medium.sigma_s = medium.sigma_s.map(|v| 0.2 * v);
        medium.sigma_a = medium.sigma_a.map(|v| 0.2 * v);
    }
    let mut red = scene.clone();
    for light in &mut red.lights {
        if let Light::Directional(sun) = light {
            sun.irradiance = [1.0, 0.1, 0.0].map(|v| v * sun.irradiance[0]);
            // Through other slats, too.
            sun.direction.z += 0.2;
            sun.direction = sun.direction.normalize_or(sun.direction);
        }
    }
    for (name, after) in [("thin", thin), ("red", red)] {
        let truth = truth_of(&after);
        let before: Vec<Arc<Scene>> = (0..4).map(|step| walk(&scene, step)).collect();
        let mut steps = before;
        steps.push(walk(&scene, 0));
        steps.push(Arc::new(after));
        let pictures = walked(&scene, CorrectionMode::Always, &steps);
        let fresh = walked(&steps[5], CorrectionMode::Always, &steps[5..]);
        let told = [&pictures[5], &fresh[0]].map(|picture| error_of(picture, &truth));
        println!(
            "{name}: error {:.4} right after the change, {:.4} without a past",
            told[0], told[1]
        );
        assert!(told[0] < 1.2 * told[1], "{name}: {told:?}");
    }
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
