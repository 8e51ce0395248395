//! A still in the making: created, advanced step by step, finished or given up.
//!
//! Nothing here waits for the device except [`StillTask::run`] and [`StillTask::finish`], so a thread that
//! renders for others as well can do a step in between.

use std::sync::Arc;
use std::time::{Duration, Instant};

use tyndall_render::{FinishedFrame, Prepared, RenderError, Renderer, StillRun, StillStep, View};
use tyndall_scene::{Scene, StopRule};

/// How far a still is.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Progress {
    /// Samples a pixel so far.
    pub samples: u32,
    /// Estimated relative error so far, where it is known.
    pub estimated_error: Option<f32>,
    /// Done part by the stop rule, as far as it can be known. Range: 0 to 1.
    pub fraction: f32,
    /// Frames that have arrived: grows as long as the device works.
    pub frames: u64,
}

/// What a step found.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Step {
    /// What the scene needs on the device is still being made, on another thread.
    Preparing,
    /// Work was submitted.
    Submitted,
    /// The device has to finish something first.
    Waiting,
    /// The stop rule is met: call [`StillTask::finish`].
    Finished,
}

/// A still in the making.
#[derive(Debug)]
pub struct StillTask {
    scene: Arc<Scene>,
    /// The picture and its run, once what it needs is there.
    begun: Option<(View, StillRun)>,
    started: Instant,
}

impl StillTask {
    /// A still of `scene` in the size and by the stop rule of its render settings.
    pub fn new(scene: Arc<Scene>) -> Self {
        Self {
            scene,
            begun: None,
            started: Instant::now(),
        }
    }

    /// The scene.
    pub fn scene(&self) -> &Arc<Scene> {
        &self.scene
    }

    /// Does one step without waiting; one is on the device at a time. Traced samples of it take `budget` at
    /// most; without, what is usual on this device.
    ///
    /// # Errors
    /// When the scene cannot be rendered, or the device fails.
    pub fn step(
        &mut self,
        renderer: &mut Renderer,
        budget: Option<Duration>,
    ) -> Result<Step, RenderError> {
        if self.begun.is_none() && renderer.prepare(&self.scene)? == Prepared::Pending {
            return Ok(Step::Preparing);
        }
        let (view, run) = self.begin(renderer)?;
        if view.in_flight() > 0 {
            run.collect(renderer, view)?;
            return Ok(Step::Waiting);
        }
        renderer.trace_within(view, budget);
        Ok(match run.advance(renderer, view)? {
            StillStep::Submitted => Step::Submitted,
            StillStep::Waiting => Step::Waiting,
            StillStep::Finished => Step::Finished,
        })
    }

    /// Whether a step was submitted that the device has not finished.
    pub fn is_on_device(&self) -> bool {
        let view = self.begun.as_ref().map(|(view, _)| view);
        view.is_some_and(|view| view.in_flight() > 0)
    }

    /// Blocks until the step that is on the device has ended; returns at once without one.
    ///
    /// # Errors
    /// When the device fails.
    pub fn wait(&self, renderer: &Renderer) -> Result<(), RenderError> {
        match &self.begun {
            Some((view, _)) => renderer.wait_for(view),
            None => Ok(()),
        }
    }

    /// Runs to the end, with the device for itself; `told` hears after every frame.
    ///
    /// # Errors
    /// When the scene cannot be rendered, or the device fails.
    pub fn run(
        mut self,
        renderer: &mut Renderer,
        mut told: impl FnMut(Progress),
    ) -> Result<tyndall_render::Still, RenderError> {
        let (stop, started) = (self.scene.render.stop, self.started);
        let (view, _) = self.begin(renderer)?;
        let mut frames = 0;
        renderer.render_still(view, |state| {
            frames += 1;
            told(Progress {
                samples: state.samples,
                estimated_error: None,
                fraction: fraction(stop, state.samples, None, started.elapsed()),
                frames,
            });
        })
    }

    /// How far it is.
    pub fn progress(&self) -> Progress {
        let run = self.begun.as_ref().map(|(_, run)| run);
        let Some((run, frame)) = run.and_then(|run| Some((run, run.last()?))) else {
            return Progress::default();
        };
        let error = frame.stats.estimated_error;
        let stop = self.scene.render.stop;
        Progress {
            samples: frame.samples,
            estimated_error: error,
            fraction: fraction(stop, frame.samples, error, self.started.elapsed()),
            frames: run.frames(),
        }
    }

    /// The picture as it was displayed last.
    pub fn shown(&self) -> Option<&FinishedFrame> {
        self.begun.as_ref().and_then(|(_, run)| run.last())
    }

    /// Reads the picture as it is, finished or not; `None` before anything was begun.
    ///
    /// # Errors
    /// When the device fails.
    pub fn finish(
        self,
        renderer: &mut Renderer,
    ) -> Result<Option<tyndall_render::Still>, RenderError> {
        match self.begun {
            Some((mut view, run)) => run.finish(renderer, &mut view),
            None => Ok(None),
        }
    }

    fn begin(&mut self, renderer: &mut Renderer) -> Result<&mut (View, StillRun), RenderError> {
        if let Some(ref mut begun) = self.begun {
            return Ok(begun);
        }
        let (width, height) = (self.scene.render.width, self.scene.render.height);
        let mut view = renderer.create_view(Arc::clone(&self.scene), width, height)?;
        let run = StillRun::new(&mut view);
        self.started = Instant::now();
        Ok(self.begun.insert((view, run)))
    }
}

/// The part of a still that is done, by its stop rule; the error falls with the root of the samples.
fn fraction(stop: StopRule, samples: u32, error: Option<f32>, elapsed: Duration) -> f32 {
    let done = match stop {
        StopRule::Samples(target) => samples as f32 / target.max(1) as f32,
        StopRule::Seconds(seconds) => elapsed.as_secs_f32() / seconds.max(1e-6),
        StopRule::RelativeError(target) => error.map_or(0.0, |error| {
            let ratio = target / error.max(1e-9);
            ratio * ratio
        }),
    };
    done.clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_done_part_follows_the_stop_rule() {
        let second = Duration::from_secs(1);
        assert_eq!(fraction(StopRule::Samples(8), 2, None, second), 0.25);
        assert_eq!(fraction(StopRule::Seconds(4.0), 2, None, second), 0.25);
        let rule = StopRule::RelativeError(0.01);
        assert_eq!(fraction(rule, 2, None, second), 0.0);
        let quarter = fraction(rule, 2, Some(0.02), second);
        assert!((quarter - 0.25).abs() < 1e-6, "{quarter}");
        assert_eq!(fraction(rule, 2, Some(0.001), second), 1.0);
    }
}
