//! Stills made in steps beside other pictures have the bits of those that had the device for themselves.

#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use std::sync::Arc;
use std::time::Duration;

use tyndall_render::{RenderOutcome, Renderer, Still};
use tyndall_scene::{CorrectionMode, Loaded, StopRule, Technique, presets};
use tyndall_still::{FinishedStill, Format, Output, Step, StillTask, encode};
use tyndall_tests::gpu;

fn small(technique: Technique, correction: CorrectionMode, samples: u32) -> Loaded {
    let description = presets::description("cornell_fog").unwrap();
    let mut loaded = tyndall_scene::build(description, None).unwrap();
    let render = &mut loaded.scene.render;
    (render.width, render.height) = (72, 48);
    render.technique = technique;
    render.correction = correction;
    render.stop = StopRule::Samples(samples);
    loaded
}

/// The files of a still in every format.
fn files(still: Still, loaded: &Loaded, renderer: &Renderer) -> Vec<Vec<u8>> {
    let (description, scene) = (&loaded.description, &loaded.scene);
    let adapter = renderer.adapter();
    let names = (adapter.name.as_str(), adapter.driver.as_str());
    let finished = FinishedStill::new(still, description, scene, names).unwrap();
    let file = |format| encode(&finished, &Output::whole(format)).unwrap();
    Format::ALL.into_iter().map(file).collect()
}

/// The names of the planes that differ in any bit.
fn differing(a: &Still, b: &Still) -> Vec<&'static str> {
    let bits = |pixels: &[[f32; 4]]| -> Vec<[u32; 4]> {
        pixels.iter().map(|p| p.map(f32::to_bits)).collect()
    };
    let planes = [
        ("radiance", bits(&a.radiance) == bits(&b.radiance)),
        ("base", a.base == b.base),
        ("traced", a.traced == b.traced),
        ("square_error", a.square_error == b.square_error),
        ("variance", a.variance == b.variance),
        ("samples", a.samples_per_pixel == b.samples_per_pixel),
        ("depth", a.depth == b.depth),
        ("normal", a.normal == b.normal),
        ("albedo", a.albedo == b.albedo),
        ("displayed", a.frame.rgba == b.frame.rgba),
    ];
    let planes = planes.into_iter().filter(|(_, equal)| !equal);
    planes.map(|(name, _)| name).collect()
}

/// The still of a task that gets a millisecond at a time, between frames of another picture.
fn in_company(renderer: &mut Renderer, loaded: &Loaded) -> Still {
    let mut other = small(
        Technique::SingleScattering,
        CorrectionMode::Always,
        u32::MAX,
    )
    .scene;
    other.camera.position.x += 0.1;
    let mut view = renderer.create_view(Arc::new(other), 40, 30).unwrap();
    let mut task = StillTask::new(Arc::new(loaded.scene.clone()));
    let mut frames = 0;
    let mut last = 0.0;
    loop {
        if !task.is_on_device()
            && renderer.render(&mut view, 0).unwrap() == RenderOutcome::Submitted
        {
            renderer.wait_for(&view).unwrap();
            frames += usize::from(view.take_finished().is_some_and(|frame| frame.is_ok()));
        }
        let step = task.step(renderer, Some(Duration::from_millis(1))).unwrap();
        let progress = task.progress();
        assert!(progress.fraction >= last && progress.fraction <= 1.0);
        last = progress.fraction;
        match step {
            Step::Finished => break,
            Step::Waiting => task.wait(renderer).unwrap(),
            Step::Preparing => std::thread::sleep(Duration::from_millis(1)),
            Step::Submitted => {}
        }
    }
    assert!(frames > 0 && last == 1.0);
    task.finish(renderer).unwrap().expect("it was begun")
}

#[test]
fn a_still_in_steps_beside_other_pictures_has_the_same_bits() {
    let mut alone = gpu::renderer();
    let mut shared = gpu::renderer();
    shared.set_in_parts(true);
    for (technique, correction) in [
        (Technique::Reference, CorrectionMode::Off),
        (Technique::SingleScattering, CorrectionMode::Off),
        (Technique::SingleScattering, CorrectionMode::Always),
    ] {
        let loaded = small(technique, correction, 6);
        let task = StillTask::new(Arc::new(loaded.scene.clone()));
        let mut told = 0;
        let still = task.run(&mut alone, |_| told += 1).unwrap();
        assert!(told > 0);
        let stepped = in_company(&mut shared, &loaded);
        let found = differing(&still, &stepped);
        assert!(found.is_empty(), "{technique:?} {correction:?}: {found:?}");
        let expected = files(still, &loaded, &alone);
        let found = files(stepped, &loaded, &shared);
        for ((expected, found), format) in expected.iter().zip(&found).zip(Format::ALL) {
            assert!(expected == found, "{technique:?} {correction:?} {format:?}");
        }
    }
}

#[test]
fn a_still_that_is_given_up_keeps_what_it_has() {
    let mut renderer = gpu::renderer();
    let loaded = small(Technique::Reference, CorrectionMode::Off, 60_000);
    let mut task = StillTask::new(Arc::new(loaded.scene.clone()));
    while task.progress().samples < 2 {
        task.step(&mut renderer, None).unwrap();
        task.wait(&renderer).unwrap();
    }
    let still = task.finish(&mut renderer).unwrap().expect("it was begun");
    assert!((2..60_000).contains(&still.frame.samples));
    let mean = gpu::mean_rgb(&still);
    assert!(mean.iter().all(|mean| *mean > 0.0), "{mean:?}");
    let unbegun = StillTask::new(Arc::new(loaded.scene.clone()));
    assert!(unbegun.finish(&mut renderer).unwrap().is_none());
}
