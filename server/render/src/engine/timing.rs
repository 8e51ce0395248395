//! Time of every pass on the device's own clock.

use serde::Serialize;

use super::device::Device;

/// Timestamps a frame may take; passes beyond go untimed.
const CAPACITY: u32 = 128;

/// Time one pass took in one frame.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct PassTime {
    /// Name of the pass.
    pub name: &'static str,
    /// Unit: µs.
    pub micros: f32,
}

/// Bytes a frame's timestamps take in a readback slot.
pub(crate) const TIMESTAMP_BYTES: u64 = CAPACITY as u64 * 8;

/// Query set and the buffer its results are resolved into; absent where the device has no clock.
#[derive(Debug)]
pub(crate) struct Timing {
    queries: Option<(wgpu::QuerySet, wgpu::Buffer)>,
    /// Nanoseconds a tick.
    period: f32,
}

/// Timestamps taken so far in one frame.
#[derive(Debug, Default)]
pub(crate) struct FrameTiming {
    names: Vec<&'static str>,
}

impl Timing {
    pub fn new(device: &Device) -> Self {
        let queries = device
            .device
            .features()
            .contains(wgpu::Features::TIMESTAMP_QUERY)
            .then(|| {
                let set = device.device.create_query_set(&wgpu::QuerySetDescriptor {
                    label: Some("timing"),
                    ty: wgpu::QueryType::Timestamp,
                    count: CAPACITY,
                });
                let buffer = device.device.create_buffer(&wgpu::BufferDescriptor {
                    label: Some("timing.resolved"),
                    size: TIMESTAMP_BYTES,
                    usage: wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::COPY_SRC,
                    mapped_at_creation: false,
                });
                (set, buffer)
            });
        Self {
            queries,
            period: device.queue.get_timestamp_period(),
        }
    }

    /// Timestamps around a compute pass called `name`.
    pub fn compute<'a>(
        &'a self,
        frame: &mut FrameTiming,
        name: &'static str,
    ) -> Option<wgpu::ComputePassTimestampWrites<'a>> {
        let (query_set, begin) = self.next(frame, name)?;
        Some(wgpu::ComputePassTimestampWrites {
            query_set,
            beginning_of_pass_write_index: Some(begin),
            end_of_pass_write_index: Some(begin + 1),
        })
    }

    /// Timestamps around a raster pass called `name`.
    pub fn raster<'a>(
        &'a self,
        frame: &mut FrameTiming,
        name: &'static str,
    ) -> Option<wgpu::RenderPassTimestampWrites<'a>> {
        let (query_set, begin) = self.next(frame, name)?;
        Some(wgpu::RenderPassTimestampWrites {
            query_set,
            beginning_of_pass_write_index: Some(begin),
            end_of_pass_write_index: Some(begin + 1),
        })
    }

    fn next(&self, frame: &mut FrameTiming, name: &'static str) -> Option<(&wgpu::QuerySet, u32)> {
        let (set, _) = self.queries.as_ref()?;
        let begin = 2 * frame.names.len() as u32;
        if begin + 2 > CAPACITY {
            return None;
        }
        frame.names.push(name);
        Some((set, begin))
    }

    /// Copies the frame's timestamps to `offset` in `slot`.
    pub fn resolve(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        frame: &FrameTiming,
        slot: &wgpu::Buffer,
        offset: u64,
    ) {
        let count = 2 * frame.names.len() as u32;
        if let Some((set, buffer)) = &self.queries
            && count > 0
        {
            encoder.resolve_query_set(set, 0..count, buffer, 0);
            encoder.copy_buffer_to_buffer(buffer, 0, slot, offset, Some(u64::from(count) * 8));
        }
    }

    /// Times by pass, in order of first appearance; passes of one name are added up.
    pub fn times(&self, frame: &FrameTiming, bytes: &[u8]) -> Vec<PassTime> {
        let ticks: Vec<u64> = bytemuck::pod_collect_to_vec(&bytes[..bytes.len() / 8 * 8]);
        let mut times: Vec<PassTime> = Vec::new();
        for (name, pair) in frame.names.iter().zip(ticks.chunks_exact(2)) {
            let micros = pair[1].saturating_sub(pair[0]) as f32 * self.period / 1000.0;
            match times.iter_mut().find(|time| time.name == *name) {
                Some(time) => time.micros += micros,
                None => times.push(PassTime { name, micros }),
            }
        }
        times
    }
}
