//! What happens to a picture whose size changes, and to one whose frame is submitted in parts.

use std::sync::Arc;
use std::time::Duration;

use tyndall_quality::{Image, relative_rmse_trim};
use tyndall_render::{RenderOutcome, Renderer, View};
use tyndall_scene::{CorrectionMode, Scene, StopRule, presets};
use tyndall_tests::gpu;

use super::interactive;

const SMALL: (u32, u32) = (96, 54);
const LARGE: (u32, u32) = (192, 108);

/// The fogged hall as the page shows it, one traced sample a frame.
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

fn frame(renderer: &mut Renderer, view: &mut View) {
    let outcome = renderer.render(view, 0).expect("a frame");
    assert_eq!(outcome, RenderOutcome::Submitted);
    while view.is_under_way() {
        renderer.wait_for(view).expect("the device works");
        renderer.go_on(view).expect("the device works");
    }
    renderer.wait().expect("the device works");
    let taken = view.take_finished();
    assert!(matches!(taken, Some(Ok(_))), "the frame arrived");
}

fn picture(renderer: &Renderer, view: &View) -> Image {
    let (width, height) = view.size();
    let radiance = renderer.read_radiance(view).expect("a picture");
    Image::from_rgba(width, height, &radiance).expect("a picture")
}

#[test]
fn a_picture_that_grows_or_shrinks_goes_on_from_what_it_knew() {
    let mut renderer = gpu::renderer();
    let scene = hall(u32::MAX);
    // A picture that grows has few pixels to remember, and its own first samples are all over it.
    for (first, second, most) in [(LARGE, SMALL, 0.9), (SMALL, LARGE, 0.98)] {
        let mut truth = renderer
            .create_view(hall(256), second.0, second.1)
            .expect("a view");
        let truth = gpu::image(&renderer.render_still(&mut truth, |_| {}).expect("a still"));
        let mut found = Vec::new();
        for frames_before in [0, 64] {
            let mut view = renderer
                .create_view(Arc::clone(&scene), first.0, first.1)
                .expect("a view");
            // One of 8×8 pixels a frame, however fast the machine is.
            view.set_slice_budget(Duration::ZERO);
            for _ in 0..frames_before {
                frame(&mut renderer, &mut view);
            }
            renderer
                .resize_view(&mut view, second.0, second.1)
                .expect("another size");
            frame(&mut renderer, &mut view);
            let picture = picture(&renderer, &view);
            found.push(relative_rmse_trim(&picture, &truth).expect("pictures of one size"));
        }
        let [without, with] = [found[0], found[1]];
        println!("{first:?} to {second:?}: first picture {with:.3}, without a past {without:.3}");
        assert!(with < most * without, "{first:?}: {with} for {without}");
    }
}

#[test]
fn a_frame_in_parts_is_the_frame_as_a_whole_and_a_dropped_one_leaves_nothing() {
    let mut renderer = gpu::renderer();
    // Strata enough that a frame of this size takes several parts.
    let scene = {
        let mut scene = Scene::clone(&hall(2));
        scene.render.single_scattering.steps = 512;
        scene.render.single_scattering.interleave = 1;
        scene.render.correction = CorrectionMode::Off;
        Arc::new(scene)
    };
    let aside = {
        let mut scene = Scene::clone(&scene);
        scene.camera.position.x += 0.3;
        Arc::new(scene)
    };
    let mut pictures = Vec::new();
    for in_parts in [false, true] {
        renderer.set_in_parts(in_parts);
        let mut view = renderer
            .create_view(Arc::clone(&aside), LARGE.0, LARGE.1)
            .expect("a view");
        if in_parts {
            let outcome = renderer.render(&mut view, 0).expect("a frame");
            assert_eq!(outcome, RenderOutcome::Submitted);
            assert!(view.is_under_way(), "the frame has one part");
            assert!(renderer.abandon(&mut view));
            assert!(!renderer.abandon(&mut view), "there is none any more");
        }
        renderer
            .update_view(&mut view, Arc::clone(&scene))
            .expect("another camera");
        for _ in 0..2 {
            frame(&mut renderer, &mut view);
        }
        pictures.push(renderer.read_radiance(&view).expect("a picture"));
    }
    assert_eq!(pictures[0], pictures[1]);
}
