//! One picture, timed: the frames of one setting from the first sample to the last.

use std::sync::Arc;
use std::time::{Duration, Instant};

use tyndall_quality::Image;
use tyndall_render::{FinishedFrame, RenderError, RenderOutcome, Renderer, Still, View};
use tyndall_scene::{Scene, StopRule};

use crate::error::BenchError;
use crate::machine::cpu_seconds;
use crate::statistics::Summary;

/// Longest dispatch: throughput counts here, not how soon a frame shows.
const SLICE_BUDGET: Duration = Duration::from_millis(500);
/// Frames before timing starts: pipelines are built at their first use.
pub(crate) const WARM_UP: u32 = 2;

/// A picture and what it cost.
#[derive(Debug, Clone)]
pub(crate) struct Shot {
    /// With the variance of the mean, if the renderer knows it.
    pub image: Image,
    /// Samples a pixel that were taken.
    pub samples: u32,
    /// Wall time of all samples, pipelines built before. Unit: s.
    pub seconds: f64,
    /// CPU time of the process over the same frames. Unit: s.
    pub cpu_seconds: Option<f64>,
    /// Wall time of a frame, one in flight. Unit: ms.
    pub frame_millis: Summary,
    /// Device time of each pass. Unit: ms.
    pub pass_millis: Vec<(String, Summary)>,
    /// Samples that were not finite.
    pub non_finite: u64,
    /// Fewer samples than asked for: the time was up.
    pub cut_short: bool,
}

/// Renders `samples` samples of `scene`, or as many as `budget` allows (at least two if so many are
/// asked for), after `warm_up` frames.
pub(crate) fn shoot(
    renderer: &mut Renderer,
    scene: &Scene,
    (width, height): (u32, u32),
    samples: u32,
    budget: Duration,
    warm_up: u32,
) -> Result<Shot, BenchError> {
    let with = |seed: u64, samples: u32| {
        let mut scene = scene.clone();
        scene.render.seed = seed;
        scene.render.stop = StopRule::Samples(samples);
        Arc::new(scene)
    };
    // Another seed, so that the true one starts the mean anew.
    let seed = scene.render.seed;
    let mut view = renderer.create_view(with(seed ^ 1, u32::MAX), width, height)?;
    view.set_slice_budget(SLICE_BUDGET);
    for _ in 0..warm_up {
        next_frame(renderer, &mut view)?;
    }
    let mut times = Times::default();
    let cpu = cpu_seconds();
    let started = Instant::now();
    // One sample is left to `render_still`, which reads the picture.
    renderer.update_view(&mut view, with(seed, samples))?;
    let mut taken = 0;
    while taken + 1 < samples && (taken == 0 || started.elapsed() < budget) {
        taken = times.frame(renderer, &mut view)?;
    }
    renderer.update_view(&mut view, with(seed, taken + 1))?;
    let last = Instant::now();
    let still = renderer.render_still(&mut view, |_| {})?;
    let seconds = started.elapsed().as_secs_f64();
    times.add(last, &still.frame);
    let cpu_seconds = cpu_seconds().zip(cpu).map(|(after, before)| after - before);
    Ok(Shot {
        image: image(width, height, &still)?,
        samples: still.frame.samples,
        seconds,
        cpu_seconds,
        frame_millis: Summary::of(&times.frames),
        pass_millis: times
            .passes
            .into_iter()
            .map(|(name, times)| (name, Summary::of(&times)))
            .collect(),
        non_finite: times.non_finite + still.non_finite,
        cut_short: still.frame.samples < samples,
    })
}

/// Renders one frame and waits for it.
pub(crate) fn next_frame(
    renderer: &mut Renderer,
    view: &mut View,
) -> Result<FinishedFrame, RenderError> {
    if renderer.render(view, 0)? != RenderOutcome::Submitted {
        return Err(RenderError::Refused(
            "the view had nothing to render".into(),
        ));
    }
    renderer.wait()?;
    let frame = view.take_finished();
    Ok(frame.ok_or_else(|| RenderError::Refused("no frame arrived".into()))??)
}

/// With the variance of the mean, where the technique keeps it.
fn image(width: u32, height: u32, still: &Still) -> Result<Image, BenchError> {
    let image = Image::from_rgba(width, height, &still.radiance)?;
    // The traced samples' variance is not the corrected picture's.
    let own = still.variance.as_ref().filter(|_| still.traced.is_none());
    Ok(match own {
        Some(variance) => image.with_variance(variance.clone())?,
        None => image,
    })
}

/// Times gathered frame by frame.
#[derive(Debug, Default)]
struct Times {
    frames: Vec<f64>,
    passes: Vec<(String, Vec<f64>)>,
    non_finite: u64,
}

impl Times {
    /// Renders a frame; returns the samples so far.
    fn frame(&mut self, renderer: &mut Renderer, view: &mut View) -> Result<u32, BenchError> {
        let started = Instant::now();
        let frame = next_frame(renderer, view)?;
        self.add(started, &frame);
        self.non_finite += u64::from(frame.stats.non_finite);
        Ok(frame.samples)
    }

    fn add(&mut self, started: Instant, frame: &FinishedFrame) {
        self.frames.push(started.elapsed().as_secs_f64() * 1e3);
        for pass in &frame.pass_times {
            let millis = f64::from(pass.micros) / 1e3;
            match self.passes.iter_mut().find(|(name, _)| name == pass.name) {
                Some((_, times)) => times.push(millis),
                None => self.passes.push((pass.name.to_owned(), vec![millis])),
            }
        }
    }
}
