//! Ring of mapped buffers that brings frames home without stalling the device.

use std::sync::Arc;
use std::sync::atomic::{AtomicU8, Ordering};
use std::time::{Duration, Instant};

use serde::Serialize;
use tyndall_shaders::types::Statistics;

use super::device::Device;
use super::timing::{FrameTiming, PassTime, TIMESTAMP_BYTES, Timing};
use crate::error::{FailedFrame, RenderError};
use crate::picture::Sweep;

/// Frames in flight a view may have.
const SLOTS: usize = 3;
/// Copies start at multiples of this.
const ALIGNMENT: u64 = 256;
/// Longest wait for the device before it counts as hung.
pub(crate) const DEVICE_TIMEOUT: Duration = Duration::from_mins(2);

const FREE: u8 = 0;
const WAITING: u8 = 1;
const READY: u8 = 2;
const FAILED: u8 = 3;

/// A rendered frame on the CPU.
#[derive(Debug, Clone)]
pub struct FinishedFrame {
    /// What the caller passed to `render`.
    pub tag: u64,
    /// Unit: pixel.
    pub width: u32,
    /// Unit: pixel.
    pub height: u32,
    /// sRGB-encoded RGBA8, row 0 at the top.
    pub rgba: Vec<u8>,
    /// Samples a pixel in the running mean.
    pub samples: u32,
    /// Whether the picture is finished: nothing is rendered until something changes.
    pub converged: bool,
    /// Counts the restarts of the running mean.
    pub epoch: u32,
    /// Measured on the device.
    pub stats: FrameStats,
    /// Time of each pass that ran.
    pub pass_times: Vec<PassTime>,
    /// From the start of recording to the picture being on the CPU. Unit: µs.
    pub render_micros: u32,
    /// Pixel samples of the reference's slice.
    pub units: u64,
    /// Layers of shadow maps that were rendered: those whose light or casters changed.
    pub shadow_layers: u32,
}

/// Numbers about a frame, measured on the device.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct FrameStats {
    /// Mean over pixels and channels of the transmittance to the first surface. Range: [0, 1].
    pub mean_transmittance: f32,
    /// Mean luminance of the picture after exposure and curve, before encoding. Range: [0, 1].
    pub mean_luminance: f32,
    /// Pixels whose new sample was NaN or infinite (kept out of the mean).
    pub non_finite: u32,
    /// Pixels whose new sample was negative.
    pub negative: u32,
    /// Values limited by a named clamp.
    pub clamped: u32,
    /// Paths given up after too many scatterings.
    pub truncated: u32,
    /// Pixels of this frame's slice that lack samples, because a path of theirs is still under way.
    pub unfinished: u32,
    /// Estimated error of the running mean relative to the picture's mean, √(mean variance)/mean,
    /// where the technique knows it.
    pub estimated_error: Option<f32>,
}

/// What is known of a frame when it is submitted.
#[derive(Debug, Clone, Copy)]
pub(crate) struct FrameMeta {
    pub tag: u64,
    pub samples: u32,
    pub converged: bool,
    pub epoch: u32,
    pub started: Instant,
    /// Fixed-point scale of the statistics' sums.
    pub statistics_scale: f32,
    /// Whether the film pass ran; otherwise its statistics are the previous frame's.
    pub filmed: bool,
    /// How often the transmittance was summed.
    pub transmittances: u32,
    /// Whether the error was estimated.
    pub estimated: bool,
    /// Pixel samples of the reference's slice.
    pub units: u64,
    /// Layers of shadow maps that were rendered.
    pub shadow_layers: u32,
    /// The reference's sweep it is part of.
    pub sweep: Option<Sweep>,
}

#[derive(Debug)]
struct Slot {
    buffer: wgpu::Buffer,
    state: Arc<AtomicU8>,
    frame: Option<InFlight>,
}

/// A frame between its submission and its return.
#[derive(Debug)]
struct InFlight {
    meta: FrameMeta,
    timing: FrameTiming,
    submission: wgpu::SubmissionIndex,
}

/// The ring of one view.
#[derive(Debug)]
pub(crate) struct ReadbackRing {
    width: u32,
    height: u32,
    slots: Vec<Slot>,
    /// Next slot to write; the oldest frame in flight is the next one that is not free.
    next: usize,
    /// Of the frame taken last, and its restart.
    last_stats: (u32, FrameStats),
}

impl ReadbackRing {
    pub fn new(device: &Device, width: u32, height: u32) -> Self {
        let size = Self::timestamps_at(width, height) + TIMESTAMP_BYTES;
        let slots = (0..SLOTS)
            .map(|_| Slot {
                buffer: device.device.create_buffer(&wgpu::BufferDescriptor {
                    label: Some("readback"),
                    size,
                    usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
                    mapped_at_creation: false,
                }),
                state: Arc::new(AtomicU8::new(FREE)),
                frame: None,
            })
            .collect();
        Self {
            width,
            height,
            slots,
            next: 0,
            last_stats: (0, FrameStats::default()),
        }
    }

    fn picture_bytes(width: u32, height: u32) -> u64 {
        u64::from(width) * u64::from(height) * 4
    }

    fn statistics_at(width: u32, height: u32) -> u64 {
        Self::picture_bytes(width, height).next_multiple_of(ALIGNMENT)
    }

    fn timestamps_at(width: u32, height: u32) -> u64 {
        Self::statistics_at(width, height) + ALIGNMENT
    }

    /// Whether a frame can be submitted.
    pub fn has_room(&self) -> bool {
        self.slots[self.next].frame.is_none()
    }

    /// Records the copies of a finished frame into the next slot.
    pub fn record(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        displayed: &wgpu::Buffer,
        statistics: &wgpu::Buffer,
        timing: &Timing,
        frame: &FrameTiming,
    ) {
        let (w, h) = (self.width, self.height);
        let slot = &self.slots[self.next].buffer;
        encoder.copy_buffer_to_buffer(displayed, 0, slot, 0, Some(Self::picture_bytes(w, h)));
        let bytes = size_of::<Statistics>() as u64;
        encoder.copy_buffer_to_buffer(statistics, 0, slot, Self::statistics_at(w, h), Some(bytes));
        timing.resolve(encoder, frame, slot, Self::timestamps_at(w, h));
    }

    /// Asks for the slot just recorded to be mapped once the device is done; call after submitting.
    pub fn submit(
        &mut self,
        meta: FrameMeta,
        timing: FrameTiming,
        submission: wgpu::SubmissionIndex,
    ) {
        let slot = &mut self.slots[self.next];
        slot.state.store(WAITING, Ordering::Release);
        slot.frame = Some(InFlight {
            meta,
            timing,
            submission,
        });
        let state = Arc::clone(&slot.state);
        slot.buffer
            .slice(..)
            .map_async(wgpu::MapMode::Read, move |result| {
                state.store(
                    if result.is_ok() { READY } else { FAILED },
                    Ordering::Release,
                );
            });
        self.next = (self.next + 1) % self.slots.len();
    }

    /// The slot of the oldest frame in flight.
    fn oldest(&self) -> Option<usize> {
        let count = self.slots.len();
        (0..count)
            .map(|i| (self.next + i) % count)
            .find(|i| self.slots[*i].frame.is_some())
    }

    /// The submission of the oldest frame in flight.
    pub fn oldest_submission(&self) -> Option<wgpu::SubmissionIndex> {
        let frame = self.slots[self.oldest()?].frame.as_ref();
        frame.map(|frame| frame.submission.clone())
    }

    /// The oldest frame in flight, if it has arrived, and the part of a sweep it was. Frames come in the
    /// order of submission. One that cannot be read is an error once, and its slot is free again.
    pub fn take(
        &mut self,
        timing: &Timing,
    ) -> Option<Result<(FinishedFrame, Option<Sweep>), FailedFrame>> {
        let index = self.oldest()?;
        let slot = &mut self.slots[index];
        let state = slot.state.load(Ordering::Acquire);
        if state != READY && state != FAILED {
            return None;
        }
        let InFlight {
            meta,
            timing: frame_timing,
            ..
        } = slot.frame.take()?;
        let failed = |reason: String| FailedFrame {
            tag: meta.tag,
            reason,
        };
        if state == FAILED {
            slot.state.store(FREE, Ordering::Release);
            return Some(Err(failed("its buffer could not be mapped".to_owned())));
        }
        let (w, h) = (self.width, self.height);
        let result = slot.buffer.slice(..).get_mapped_range().map(|bytes| {
            let statistics_at = Self::statistics_at(w, h) as usize;
            let statistics: Statistics = bytemuck::pod_read_unaligned(
                &bytes[statistics_at..statistics_at + size_of::<Statistics>()],
            );
            let stats = frame_stats(&statistics, &meta, w, h, self.last_stats);
            FinishedFrame {
                tag: meta.tag,
                width: w,
                height: h,
                rgba: bytes[..Self::picture_bytes(w, h) as usize].to_vec(),
                samples: meta.samples,
                converged: meta.converged,
                epoch: meta.epoch,
                stats,
                pass_times: timing
                    .times(&frame_timing, &bytes[Self::timestamps_at(w, h) as usize..]),
                render_micros: u32::try_from(meta.started.elapsed().as_micros())
                    .unwrap_or(u32::MAX),
                units: meta.units,
                shadow_layers: meta.shadow_layers,
            }
        });
        slot.buffer.unmap();
        slot.state.store(FREE, Ordering::Release);
        let frame = match result {
            Ok(frame) => frame,
            Err(error) => return Some(Err(failed(error.to_string()))),
        };
        self.last_stats = (frame.epoch, frame.stats);
        Some(Ok((frame, meta.sweep)))
    }

    /// Frames submitted and not yet taken.
    pub fn in_flight(&self) -> usize {
        self.slots
            .iter()
            .filter(|slot| slot.frame.is_some())
            .count()
    }
}

fn frame_stats(
    counted: &Statistics,
    meta: &FrameMeta,
    width: u32,
    height: u32,
    (last_epoch, last): (u32, FrameStats),
) -> FrameStats {
    let pixels = width as f32 * height as f32 * meta.statistics_scale;
    let displayed = counted.displayed as f32 / pixels;
    let estimated_error = if meta.estimated {
        estimated_error(counted)
    } else {
        last.estimated_error.filter(|_| last_epoch == meta.epoch)
    };
    if !meta.filmed {
        return FrameStats {
            mean_luminance: displayed,
            estimated_error,
            ..last
        };
    }
    FrameStats {
        mean_transmittance: match meta.transmittances {
            0 => last.mean_transmittance,
            sums => counted.transmittance as f32 / (pixels * sums as f32),
        },
        mean_luminance: displayed,
        non_finite: counted.non_finite,
        negative: counted.negative,
        clamped: counted.clamped,
        truncated: counted.truncated,
        unfinished: counted.unfinished,
        estimated_error,
    }
}

/// √(mean variance)/mean radiance; unknown where nothing was measured. A picture that is black in every
/// sample has no error: otherwise an error target would never be met.
fn estimated_error(counted: &Statistics) -> Option<f32> {
    if counted.measured_pixels <= 0.0 {
        return None;
    }
    let mean = counted.radiance / counted.measured_pixels;
    let variance = counted.variance_of_halves / counted.measured_pixels;
    if mean > 0.0 {
        Some(variance.sqrt() / mean)
    } else {
        (variance <= 0.0).then_some(0.0)
    }
}

/// Fixed-point scale that keeps two sums of values in [0, 1] over all pixels below 2³².
pub(crate) fn statistics_scale(width: u32, height: u32) -> f32 {
    (2.0_f64.powi(30) / (f64::from(width) * f64::from(height))).min(65536.0) as f32
}

/// Waits for `buffer` (usage `MAP_READ`) and copies it. For tests, stills and the self-test.
pub(crate) fn read_now(device: &Device, buffer: &wgpu::Buffer) -> Result<Vec<u8>, RenderError> {
    let (sender, receiver) = std::sync::mpsc::sync_channel(1);
    buffer
        .slice(..)
        .map_async(wgpu::MapMode::Read, move |result| {
            // The receiver outlives the poll below; if not, nobody wants the answer.
            sender.send(result).unwrap_or_default();
        });
    wait(device, None)?;
    device.check()?;
    match receiver.try_recv() {
        Ok(Ok(())) => {}
        Ok(Err(error)) => return Err(RenderError::Refused(error.to_string())),
        Err(_) => {
            return Err(RenderError::Timeout {
                seconds: DEVICE_TIMEOUT.as_secs(),
            });
        }
    }
    let bytes = buffer
        .slice(..)
        .get_mapped_range()
        .map_err(|error| RenderError::Refused(error.to_string()))?
        .to_vec();
    buffer.unmap();
    Ok(bytes)
}

/// Blocks until the device has finished a submission and all before it; everything without one.
pub(crate) fn wait(
    device: &Device,
    submission: Option<wgpu::SubmissionIndex>,
) -> Result<(), RenderError> {
    device
        .device
        .poll(wgpu::PollType::Wait {
            submission_index: submission,
            timeout: Some(DEVICE_TIMEOUT),
        })
        .map(|_| ())
        .map_err(|error| match error {
            wgpu::PollError::Timeout => RenderError::Timeout {
                seconds: DEVICE_TIMEOUT.as_secs(),
            },
            other @ wgpu::PollError::WrongSubmissionIndex(..) => {
                RenderError::Refused(other.to_string())
            }
        })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn error_of(radiance: f32, variance_of_halves: f32, measured_pixels: f32) -> Option<f32> {
        estimated_error(&Statistics {
            radiance,
            variance_of_halves,
            measured_pixels,
            ..bytemuck::Zeroable::zeroed()
        })
    }

    #[test]
    fn a_black_picture_has_no_error_and_an_unmeasured_one_an_unknown_one() {
        assert_eq!(error_of(0.0, 0.0, 0.0), None);
        assert_eq!(error_of(0.0, 0.0, 8.0), Some(0.0));
        assert_eq!(error_of(16.0, 8.0, 8.0), Some(0.5));
    }
}
