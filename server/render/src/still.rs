//! A picture rendered to its stop rule, with its linear radiance.

use crate::correction;
use crate::engine::{FinishedFrame, ResourceSpec, read_now};
use crate::error::RenderError;
use crate::renderer::{RenderOutcome, Renderer};
use crate::stages::film::{self, FILM, TECHNIQUE_FILM};
use crate::techniques::reference::paths::{FILM_ALBEDO, FILM_NORMAL, MOMENTS, PASS, TRACED_FILM};
use crate::view::View;

/// A finished picture.
#[derive(Debug, Clone)]
pub struct Still {
    /// The last frame: displayed picture, statistics, times.
    pub frame: FinishedFrame,
    /// Mean linear RGB radiance and mean transmittance, row 0 at the top. Unit: W·m⁻²·sr⁻¹.
    pub radiance: Vec<[f32; 4]>,
    /// Variance of each pixel's mean as if its samples were independent, an upper estimate where they
    /// are better spread than that. Only the reference knows it.
    pub variance: Option<Vec<[f32; 3]>>,
    /// The technique's own mean and the traced one, where the picture is the one corrected by the other.
    pub base: Option<Vec<[f32; 4]>>,
    /// See `base`.
    pub traced: Option<Vec<[f32; 4]>>,
    /// Square error that the correction expects of each pixel, mean of the channels.
    pub square_error: Option<Vec<f32>>,
    /// Samples of each pixel. Only the reference counts them a pixel.
    pub samples_per_pixel: Option<Vec<f32>>,
    /// Distance along the view axis to the first surface, mean over the samples that met one; 0 without
    /// any. Unit: m.
    pub depth: Option<Vec<f32>>,
    /// Normal of the first surface in world axes, mean over the samples.
    pub normal: Option<Vec<[f32; 3]>>,
    /// Base colour of the first surface, mean over the samples.
    pub albedo: Option<Vec<[f32; 3]>>,
    /// Sum over all frames of pixels that were not finite.
    pub non_finite: u64,
    /// Sum over all frames of pixels that were negative.
    pub negative: u64,
    /// Paths given up after too many scatterings, or when time was up: light that is missing.
    pub truncated: u64,
}

/// What went wrong, summed over the frames.
#[derive(Debug, Clone, Copy, Default)]
struct Counts {
    non_finite: u64,
    negative: u64,
    truncated: u64,
}

impl Counts {
    fn add(&mut self, frame: &FinishedFrame) {
        self.non_finite += u64::from(frame.stats.non_finite);
        self.negative += u64::from(frame.stats.negative);
        self.truncated += u64::from(frame.stats.truncated);
    }
}

/// Told after every frame of a still.
#[derive(Debug, Clone, Copy)]
pub struct StillProgress {
    /// Samples a pixel so far.
    pub samples: u32,
    /// Whether the caller wants more: it may set this to false to stop early.
    pub go_on: bool,
}

/// A still in the making, driven step by step, so that others may have the device in between. Where the
/// stop rule counts samples its bits do not depend on the steps.
#[derive(Debug)]
pub struct StillRun {
    counts: Counts,
    last: Option<FinishedFrame>,
    /// Frames that have arrived.
    frames: u64,
}

/// What a step of a [`StillRun`] found.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StillStep {
    /// Work was submitted.
    Submitted,
    /// The device has to finish something first.
    Waiting,
    /// The stop rule is met and every frame has arrived.
    Finished,
}

impl StillRun {
    /// Begins a still of `view`: from now on every frame traces all of its pixels.
    pub fn new(view: &mut View) -> Self {
        view.slices.keep_whole(true);
        Self {
            counts: Counts::default(),
            last: None,
            frames: 0,
        }
    }

    /// Submits the next piece of work and takes the frames that have arrived. Never waits.
    pub fn advance(
        &mut self,
        renderer: &mut Renderer,
        view: &mut View,
    ) -> Result<StillStep, RenderError> {
        let outcome = if view.is_under_way() {
            renderer.go_on(view)?;
            RenderOutcome::Busy
        } else {
            renderer.render(view, 0)?
        };
        renderer.poll()?;
        self.take(view)?;
        Ok(match outcome {
            RenderOutcome::Submitted => StillStep::Submitted,
            RenderOutcome::Converged if view.in_flight() == 0 => StillStep::Finished,
            RenderOutcome::Converged | RenderOutcome::Busy => StillStep::Waiting,
        })
    }

    /// [`Self::advance`] that begins nothing new.
    pub fn collect(&mut self, renderer: &Renderer, view: &mut View) -> Result<(), RenderError> {
        if view.is_under_way() {
            renderer.go_on(view)?;
        }
        renderer.poll()?;
        self.take(view)
    }

    /// Takes the frames that have arrived.
    fn take(&mut self, view: &mut View) -> Result<(), RenderError> {
        while let Some(frame) = view.take_finished() {
            let frame = frame?;
            self.counts.add(&frame);
            self.frames += 1;
            self.last = Some(frame);
        }
        Ok(())
    }

    /// The frame that arrived last.
    pub fn last(&self) -> Option<&FinishedFrame> {
        self.last.as_ref()
    }

    /// Frames that have arrived.
    pub fn frames(&self) -> u64 {
        self.frames
    }

    /// Reads the linear picture as it is, finished or not, after what is on the device has ended; `None`
    /// before any frame was begun.
    pub fn finish(
        mut self,
        renderer: &mut Renderer,
        view: &mut View,
    ) -> Result<Option<Still>, RenderError> {
        while view.is_under_way() {
            renderer.wait_for(view)?;
            renderer.go_on(view)?;
        }
        renderer.wait()?;
        self.take(view)?;
        view.slices.keep_whole(false);
        let Some(frame) = self.last else {
            return Ok(None);
        };
        renderer.read_still(view, frame, self.counts).map(Some)
    }
}

impl Renderer {
    /// Renders `view` until its stop rule is met and reads the linear picture.
    /// `progress` is called after every frame.
    pub fn render_still(
        &mut self,
        view: &mut View,
        mut progress: impl FnMut(&mut StillProgress),
    ) -> Result<Still, RenderError> {
        let budget = view.slices.widen();
        let run = StillRun::new(view);
        let still = self.render_to_the_end(run, view, &mut progress);
        view.slices.keep_whole(false);
        view.slices.set_budget(budget);
        still?.ok_or_else(|| RenderError::Refused("no frame arrived".into()))
    }

    fn render_to_the_end(
        &mut self,
        mut run: StillRun,
        view: &mut View,
        progress: &mut dyn FnMut(&mut StillProgress),
    ) -> Result<Option<Still>, RenderError> {
        loop {
            let known = run.frames();
            let step = run.advance(self, view)?;
            if let Some(frame) = run.last().filter(|_| run.frames() > known) {
                let mut state = StillProgress {
                    samples: frame.samples,
                    go_on: true,
                };
                progress(&mut state);
                if !state.go_on {
                    return run.finish(self, view);
                }
            }
            match step {
                StillStep::Submitted => {}
                StillStep::Waiting if view.in_flight() > 0 => self.wait_for(view)?,
                StillStep::Waiting => self.wait()?,
                StillStep::Finished => return run.finish(self, view),
            }
        }
    }

    fn read_still(
        &mut self,
        view: &mut View,
        frame: FinishedFrame,
        counts: Counts,
    ) -> Result<Still, RenderError> {
        let mut still = Still {
            frame,
            radiance: self.read_radiance(view)?,
            variance: None,
            base: None,
            traced: None,
            square_error: None,
            samples_per_pixel: None,
            depth: None,
            normal: None,
            albedo: None,
            non_finite: counts.non_finite,
            negative: counts.negative,
            truncated: counts.truncated + view.accumulation.unfinished(),
        };
        let plan = view.plan();
        if plan.runs(PASS) {
            let moments = self.read_pixels(view, &MOMENTS)?;
            let albedo = self.read_pixels(view, &FILM_ALBEDO)?;
            let normal = self.read_pixels(view, &FILM_NORMAL)?;
            if plan.runs(correction::PASS) {
                still.base = plan
                    .runs(film::PASS)
                    .then(|| self.read_pixels(view, &TECHNIQUE_FILM))
                    .transpose()?;
                still.traced = Some(self.read_pixels(view, &TRACED_FILM)?);
                let bytes = self.read_bytes(view, &correction::SQUARE_ERRORS)?;
                let mut errors: Vec<f32> = bytemuck::pod_collect_to_vec(&bytes);
                errors.truncate(still.radiance.len());
                still.square_error = Some(errors);
            }
            let rgb = |v: [f32; 4]| [v[0], v[1], v[2]];
            let variance = |m: &[f32; 4]| rgb(*m).map(|sum| sum / (m[3] * (m[3] - 1.0)).max(1.0));
            still.variance = Some(moments.iter().map(variance).collect());
            still.samples_per_pixel = Some(moments.iter().map(|m| m[3]).collect());
            // Means over all samples, of which a share met a surface.
            let met = normal.iter().map(|n| n[3].max(1e-6));
            still.depth = Some(met.zip(&albedo).map(|(s, p)| p[3] / s).collect());
            still.albedo = Some(albedo.into_iter().map(rgb).collect());
            still.normal = Some(normal.into_iter().map(rgb).collect());
        }
        Ok(still)
    }

    /// Reads the running mean: linear RGB radiance and transmittance, row 0 at the top.
    pub fn read_radiance(&self, view: &View) -> Result<Vec<[f32; 4]>, RenderError> {
        self.read_pixels(view, &FILM)
    }

    /// Reads a buffer of four floats an entry.
    fn read_pixels(&self, view: &View, spec: &ResourceSpec) -> Result<Vec<[f32; 4]>, RenderError> {
        Ok(bytemuck::pod_collect_to_vec(&self.read_bytes(view, spec)?))
    }

    fn read_bytes(&self, view: &View, spec: &ResourceSpec) -> Result<Vec<u8>, RenderError> {
        let device = self.device();
        let found = view.state.resources.buffer(spec.name);
        let buffer = found.ok_or_else(|| RenderError::Shader {
            shader: spec.name.to_owned(),
            what: "no pass of the plan declares it".into(),
        })?;
        let staging = device.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("still.read"),
            size: buffer.size(),
            usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let mut encoder = device
            .device
            .create_command_encoder(&wgpu::CommandEncoderDescriptor {
                label: Some("still"),
            });
        encoder.copy_buffer_to_buffer(buffer, 0, &staging, 0, None);
        device.queue.submit([encoder.finish()]);
        read_now(device, &staging)
    }
}
