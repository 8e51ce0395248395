//! Frames of a moving camera, and the error of one of them.

use std::fmt;
use std::sync::Arc;
use std::time::{Duration, Instant};

use glam::{DQuat, DVec3};
use serde::Serialize;
use tyndall_metrics::{Image, estimated_error, relative_rmse_trim_debiased};
use tyndall_render::{FinishedFrame, RenderError, RenderOutcome, Renderer, View};
use tyndall_scene::{Scene, ShadowMode, StopRule};

use crate::error::BenchError;
use crate::memory::resident_bytes;
use crate::shot::shoot;
use crate::statistics::Summary;
use crate::truth::{another_seed, settle};

/// Frames before timing starts: pipelines are built at their first use.
const WARM_UP: u32 = 5;

/// Settings of the measurement.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FrameBench {
    /// Unit: pixel.
    pub width: u32,
    /// Unit: pixel.
    pub height: u32,
    /// Frames to time, at most.
    pub frames: u32,
    /// Longest time of them. Unit: s.
    pub frames_seconds: f64,
    /// Samples at rest, at most.
    pub rest_samples: u32,
    /// Longest time of them. Unit: s.
    pub rest_seconds: f64,
    /// Samples of the converged picture, at most.
    pub truth_samples: u32,
    /// Longest time of them. Unit: s.
    pub truth_seconds: f64,
}

/// One scene's figures.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Row {
    /// Preset or file.
    pub scene: String,
    /// Adapter and driver.
    pub device: String,
    /// Unit: pixel.
    pub width: u32,
    /// Unit: pixel.
    pub height: u32,
    /// March steps a ray.
    pub steps: u32,
    /// Seed of the scene.
    pub seed: u64,
    /// Frames timed.
    pub frames: u32,
    /// From the view's creation to its first picture, pipelines built on the way. Unit: s.
    pub first_frame_secs: f64,
    /// Wall time of a frame, camera moving, one frame in flight. Unit: ms.
    pub frame_millis: Summary,
    /// Device time of each pass. Unit: ms.
    pub pass_millis: Vec<(String, Summary)>,
    /// relRMSE without the worst 0.1 % of pixels of one frame (1 sample) against `truth_samples`
    /// samples of the same view and technique, shadows traced where possible; the variance of those is
    /// taken off.
    pub error_one_sample: f64,
    /// Samples taken at rest.
    pub rest_samples: u32,
    /// The same of them.
    pub error_at_rest: f64,
    /// Wall time of them. Unit: s.
    pub seconds_at_rest: f64,
    /// Samples of the converged picture.
    pub truth_samples: u32,
    /// Its own relative error.
    pub truth_error: Option<f64>,
    /// Non-finite samples over all frames.
    pub non_finite: u64,
    /// Resident memory after the first 100 timed frames. Unit: byte.
    pub resident_after_100: Option<u64>,
    /// Resident memory after the last timed frame. Unit: byte.
    pub resident_after_all: Option<u64>,
}

impl FrameBench {
    /// Measures `scene`.
    pub fn run(
        &self,
        renderer: &mut Renderer,
        name: &str,
        scene: &Scene,
    ) -> Result<Row, BenchError> {
        let mode = scene.render.shadows.mode;
        let mut first = scene.clone();
        first.render.stop = StopRule::Samples(self.rest_samples);
        let started = Instant::now();
        let mut view = renderer.create_view(Arc::new(first), self.width, self.height)?;
        next_frame(renderer, &mut view)?;
        let first_frame_secs = started.elapsed().as_secs_f64();
        let one = renderer.read_radiance(&view)?;

        let (times, passes, mut non_finite, resident) = self.fly(renderer, &mut view, scene)?;

        let size = (self.width, self.height);
        let rest = Duration::from_secs_f64(self.rest_seconds);
        let settled = shoot(renderer, scene, size, self.rest_samples, rest, 0)?;
        non_finite += settled.non_finite;

        let mut converged = scene.clone();
        let masked = scene
            .geometry
            .materials
            .iter()
            .any(|material| material.alpha_cutoff.is_some());
        if !masked && mode != ShadowMode::Off {
            converged.render.shadows.mode = ShadowMode::Traced;
        }
        converged.render.seed = another_seed(scene.render.seed);
        let budget = Duration::from_secs_f64(self.truth_seconds);
        let (truth, truth_samples) =
            settle(renderer, &converged, size, self.truth_samples, budget)?;
        let error = |image: &Image| relative_rmse_trim_debiased(image, &truth);
        let one = Image::from_rgba(self.width, self.height, &one)?;
        let adapter = renderer.adapter();
        Ok(Row {
            scene: name.to_owned(),
            device: format!("{} ({})", adapter.name, adapter.driver),
            width: self.width,
            height: self.height,
            steps: scene.render.single_scattering.steps,
            seed: scene.render.seed,
            frames: times.len() as u32,
            first_frame_secs,
            frame_millis: Summary::of(&times),
            pass_millis: passes
                .into_iter()
                .map(|(name, times)| (name, Summary::of(&times)))
                .collect(),
            error_one_sample: error(&one)?,
            rest_samples: settled.samples,
            error_at_rest: error(&settled.image)?,
            seconds_at_rest: settled.seconds,
            truth_samples,
            truth_error: estimated_error(&truth).ok().map(|e| e.relative_error_trim),
            non_finite,
            resident_after_100: resident[0],
            resident_after_all: resident[1],
        })
    }

    /// Times frames of a camera that swings around its target.
    #[expect(
        clippy::type_complexity,
        reason = "four results of one loop, taken apart at once"
    )]
    fn fly(
        &self,
        renderer: &mut Renderer,
        view: &mut View,
        scene: &Scene,
    ) -> Result<(Vec<f64>, Vec<(String, Vec<f64>)>, u64, [Option<u64>; 2]), RenderError> {
        let mut times = Vec::new();
        let mut passes: Vec<(String, Vec<f64>)> = Vec::new();
        let mut non_finite = 0;
        let mut resident = [None; 2];
        let budget = Duration::from_secs_f64(self.frames_seconds);
        let mut began = Instant::now();
        for i in 0..WARM_UP + self.frames {
            if i == WARM_UP {
                began = Instant::now();
            } else if i > WARM_UP && began.elapsed() > budget {
                break;
            }
            let mut moved = scene.clone();
            let angle = 0.1 * (f64::from(i) * 0.05).sin();
            let offset = moved.camera.position - moved.camera.target;
            moved.camera.position =
                moved.camera.target + DQuat::from_axis_angle(DVec3::Y, angle) * offset;
            let started = Instant::now();
            renderer.update_view(view, Arc::new(moved))?;
            let frame = next_frame(renderer, view)?;
            if i < WARM_UP {
                continue;
            }
            times.push(started.elapsed().as_secs_f64() * 1e3);
            non_finite += u64::from(frame.stats.non_finite);
            for pass in frame.pass_times {
                let millis = f64::from(pass.micros) / 1e3;
                match passes.iter_mut().find(|(name, _)| name == pass.name) {
                    Some((_, times)) => times.push(millis),
                    None => passes.push((pass.name.to_owned(), vec![millis])),
                }
            }
            if i == WARM_UP + 99 {
                resident[0] = resident_bytes();
            }
        }
        resident[1] = resident_bytes();
        Ok((times, passes, non_finite, resident))
    }
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

impl fmt::Display for Row {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "{}  {}×{}, {} steps, seed {}, {}",
            self.scene, self.width, self.height, self.steps, self.seed, self.device
        )?;
        writeln!(
            f,
            "  frame {:.2} ms median, {:.2} ms p95 ({:.1} fps) with error {:.4}; first frame {:.3} s",
            self.frame_millis.median,
            self.frame_millis.p95,
            1e3 / self.frame_millis.median.max(1e-9),
            self.error_one_sample,
            self.first_frame_secs
        )?;
        writeln!(
            f,
            "  {} samples in {:.3} s with error {:.4}; truth: {} samples, shadows traced where possible, own \
             error {} taken off; {} non-finite",
            self.rest_samples,
            self.seconds_at_rest,
            self.error_at_rest,
            self.truth_samples,
            self.truth_error
                .map_or("?".to_owned(), |error| format!("{error:.4}")),
            self.non_finite
        )?;
        for (name, times) in &self.pass_millis {
            writeln!(
                f,
                "    {name:<18} {:8.3} ms median {:8.3} ms p95",
                times.median, times.p95
            )?;
        }
        let mebibytes = |bytes: Option<u64>| {
            bytes.map_or_else(
                || "?".to_owned(),
                |b| format!("{:.1}", b as f64 / 1_048_576.0),
            )
        };
        write!(
            f,
            "  resident {} MiB after 100 frames, {} MiB after {}",
            mebibytes(self.resident_after_100),
            mebibytes(self.resident_after_all),
            self.frames
        )
    }
}
