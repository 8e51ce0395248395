//! A picture rendered to its stop rule, with its linear radiance.

use crate::error::RenderError;
use crate::readback::{FinishedFrame, read_now};
use crate::renderer::{RenderOutcome, Renderer};
use crate::view::View;

/// A finished picture.
#[derive(Debug, Clone)]
pub struct Still {
    /// The last frame: displayed picture, statistics, times.
    pub frame: FinishedFrame,
    /// Mean linear RGB radiance and mean transmittance, row 0 at the top. Unit: W·m⁻²·sr⁻¹.
    pub radiance: Vec<[f32; 4]>,
    /// Sum over all frames of pixels that were not finite.
    pub non_finite: u64,
    /// Sum over all frames of pixels that were negative.
    pub negative: u64,
}

/// Told after every frame of a still.
#[derive(Debug, Clone, Copy)]
pub struct StillProgress {
    /// Samples a pixel so far.
    pub samples: u32,
    /// Whether the caller wants more: it may set this to false to stop early.
    pub go_on: bool,
}

impl Renderer {
    /// Renders `view` until its stop rule is met and reads the linear picture.
    /// `progress` is called after every frame.
    pub fn render_still(
        &mut self,
        view: &mut View,
        mut progress: impl FnMut(&mut StillProgress),
    ) -> Result<Still, RenderError> {
        let (mut non_finite, mut negative) = (0, 0);
        let mut last = None;
        loop {
            let outcome = self.render(view, 0)?;
            if outcome != RenderOutcome::Submitted {
                self.wait()?;
            }
            self.poll()?;
            while let Some(frame) = view.take_finished() {
                non_finite += u64::from(frame.stats.non_finite);
                negative += u64::from(frame.stats.negative);
                let mut state = StillProgress {
                    samples: frame.samples,
                    go_on: true,
                };
                progress(&mut state);
                last = Some(frame);
                if !state.go_on {
                    return self.finish(view, last, non_finite, negative);
                }
            }
            if outcome == RenderOutcome::Converged && view.in_flight() == 0 {
                return self.finish(view, last, non_finite, negative);
            }
        }
    }

    fn finish(
        &mut self,
        view: &mut View,
        last: Option<FinishedFrame>,
        non_finite: u64,
        negative: u64,
    ) -> Result<Still, RenderError> {
        self.wait()?;
        let mut frame = last;
        while let Some(newer) = view.take_finished() {
            frame = Some(newer);
        }
        let frame = frame.ok_or_else(|| RenderError::Refused("no frame arrived".into()))?;
        Ok(Still {
            frame,
            radiance: self.read_radiance(view)?,
            non_finite,
            negative,
        })
    }

    /// Reads the running mean: linear RGB radiance and transmittance, row 0 at the top.
    pub fn read_radiance(&self, view: &View) -> Result<Vec<[f32; 4]>, RenderError> {
        let device = self.device();
        let film = &view.targets.film;
        let staging = device.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("still.radiance"),
            size: film.size(),
            usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let mut encoder = device
            .device
            .create_command_encoder(&wgpu::CommandEncoderDescriptor {
                label: Some("still"),
            });
        encoder.copy_buffer_to_buffer(film, 0, &staging, 0, None);
        device.queue.submit([encoder.finish()]);
        let bytes = read_now(device, &staging)?;
        Ok(bytemuck::pod_collect_to_vec(&bytes))
    }
}
