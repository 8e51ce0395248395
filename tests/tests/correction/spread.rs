//! A picture at rest whose first sample takes many frames: all of it gains at once, and where the cuts are does not
//! show in the end.

use std::sync::Arc;
use std::time::Duration;

use tyndall_quality::{Image, relative_rmse_trim};
use tyndall_render::{RenderOutcome, Renderer, View};
use tyndall_scene::{CorrectionMode, Scene, StopRule, presets};
use tyndall_tests::gpu;

use super::interactive;

const WIDTH: u32 = 128;
const HEIGHT: u32 = 64;
/// Places of a cell of 8×8 pixels: where a dispatch may take no time, it takes one in eight rows of cells, all of
/// this picture's.
const FRAMES_A_SAMPLE: u32 = 64;

fn hall(samples: u32) -> Arc<Scene> {
    let description = presets::description("fogged_hall").expect("a preset");
    let mut scene = tyndall_scene::build(description, None)
        .expect("valid")
        .scene;
    interactive(&mut scene);
    scene.render.correction = CorrectionMode::Always;
    scene.render.stop = StopRule::Samples(samples);
    Arc::new(scene)
}

/// Renders a frame, if the picture takes one; whether it did.
fn frame(renderer: &mut Renderer, view: &mut View) -> bool {
    let outcome = renderer.render(view, 0).expect("a frame");
    renderer.wait().expect("the device works");
    let taken = view.take_finished();
    let submitted = outcome == RenderOutcome::Submitted;
    assert_eq!(matches!(taken, Some(Ok(_))), submitted, "frames arrive");
    submitted
}

fn radiance(renderer: &Renderer, view: &View) -> Vec<[f32; 4]> {
    renderer.read_radiance(view).expect("a picture")
}

/// The upper and the lower half of a picture.
fn halves(pixels: &[[f32; 4]]) -> [Image; 2] {
    let (upper, lower) = pixels.split_at(pixels.len() / 2);
    [upper, lower].map(|half| Image::from_rgba(WIDTH, HEIGHT / 2, half).expect("a picture"))
}

#[test]
fn the_first_part_of_a_sample_corrects_the_lower_half_as_the_upper() {
    let mut renderer = gpu::renderer();
    renderer.set_in_parts(false);
    let mut truth = renderer
        .create_view(hall(64), WIDTH, HEIGHT)
        .expect("a view");
    renderer.render_still(&mut truth, |_| {}).expect("a still");
    let truth = halves(&radiance(&renderer, &truth));
    let mut view = renderer
        .create_view(hall(u32::MAX), WIDTH, HEIGHT)
        .expect("a view");
    view.set_slice_budget(Duration::ZERO);
    let mut errors = Vec::new();
    for frames in [1, FRAMES_A_SAMPLE / 4] {
        for _ in 0..frames {
            assert!(frame(&mut renderer, &mut view), "not nearly finished");
        }
        let found = halves(&radiance(&renderer, &view));
        let error = |half: usize| relative_rmse_trim(&found[half], &truth[half]).expect("a size");
        errors.push([error(0), error(1)]);
    }
    println!("error of the halves at first, and after a quarter of a sample: {errors:.4?}");
    assert_eq!(view.samples(), 0, "the sample is not whole");
    for half in [0, 1] {
        let (first, then) = (errors[0][half], errors[1][half]);
        assert!(then < 0.8 * first, "half {half}: {first}, then {then}");
    }
}

#[test]
fn the_cutting_of_a_corrected_picture_changes_no_bit() {
    let mut renderer = gpu::renderer();
    renderer.set_in_parts(false);
    let mut finished = Vec::new();
    for budget in [
        Duration::from_mins(1),
        Duration::from_millis(1),
        Duration::ZERO,
    ] {
        let mut view = renderer.create_view(hall(2), 64, 40).expect("a view");
        view.set_slice_budget(budget);
        let mut frames = 0;
        while !view.is_converged() && frames < 1000 {
            frame(&mut renderer, &mut view);
            frames += 1;
        }
        assert!(view.is_converged(), "{budget:?}: not after {frames} frames");
        println!("{budget:?}: {frames} frames");
        let bits: Vec<[u32; 4]> = radiance(&renderer, &view)
            .iter()
            .map(|pixel| pixel.map(f32::to_bits))
            .collect();
        finished.push((budget, frames, bits));
    }
    let (_, few, whole) = &finished[0];
    assert!(finished[2].1 > 10 * few, "it is cut into many parts");
    for (budget, _, bits) in &finished[1..] {
        assert!(bits == whole, "a budget of {budget:?} changes bits");
    }
}
