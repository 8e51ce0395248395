//! A picture at rest whose first sample takes many frames: all of it gains at once, and where the cuts are does not
//! show in the end.

use std::sync::Arc;
use std::time::Duration;

use serde_json::json;
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

/// Fog of which single scattering shows a part only, all over the picture.
fn fog(seed: u32) -> Arc<Scene> {
    Arc::new(gpu::scene(&json!({
        "version": 1,
        "camera": { "position": [0, 0, 3], "target": [0, 0, 0], "vertical_fov_degrees": 30 },
        "lights": [{ "kind": "environment", "radiance": 1 }],
        "media": [{ "kind": "homogeneous", "sigma_t": 1, "albedo": 0.95,
            "bounds": { "min": [-3, -3, -1], "max": [3, 3, 1] } }],
        "render": { "technique": "single_scattering", "correction": "always",
            "width": WIDTH, "height": HEIGHT, "samples": 1024,
            "seed": seed },
    })))
}

/// Root of the mean squared difference of two pictures' halves, the upper one first.
fn differences(a: &[[f32; 4]], b: &[[f32; 4]]) -> [f32; 2] {
    let square = |(a, b): (&[f32; 4], &[f32; 4])| (a[0] - b[0]).powi(2);
    let squares: Vec<f32> = a.iter().zip(b).map(square).collect();
    let (upper, lower) = squares.split_at(squares.len() / 2);
    [upper, lower].map(|half| (half.iter().sum::<f32>() / half.len() as f32).sqrt())
}

#[test]
fn the_first_part_of_a_sample_corrects_the_lower_half_as_the_upper() {
    let mut renderer = gpu::renderer();
    renderer.set_in_parts(false);
    let mut view = renderer.create_view(fog(1), WIDTH, HEIGHT).expect("a view");
    view.set_slice_budget(Duration::ZERO);
    frame(&mut renderer, &mut view);
    // Now it is known what a sample takes, and another picture begins with few.
    renderer
        .update_view(&mut view, fog(2))
        .expect("another seed");
    frame(&mut renderer, &mut view);
    let first = radiance(&renderer, &view);
    for _ in 1..FRAMES_A_SAMPLE / 4 {
        frame(&mut renderer, &mut view);
    }
    assert_eq!(view.samples(), 0, "the sample is not whole");
    let then = radiance(&renderer, &view);
    let [upper, lower] = differences(&first, &then);
    println!(
        "a quarter of a sample changes the upper half by {upper:.5}, the lower one by {lower:.5}"
    );
    assert!(upper > 0.001, "{upper}");
    assert!(lower > 0.5 * upper, "{lower} for {upper}");
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
        let mut view = renderer.create_view(hall(2), 96, 64).expect("a view");
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
