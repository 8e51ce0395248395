//! The one place that records and submits commands.
//!
//! A frame that takes long is recorded as several parts, each a command buffer of its own, so that whoever
//! submits them may let others have the device between two of them.

use std::collections::VecDeque;

use super::bands::{most_groups, most_iterations, parts};
use super::bindings::Bindings;
use super::constants::Constants;
use super::device::Device;
use super::pipelines::{ComputeProgram, Pipelines};
use super::raster::{Attachment, DrawCall, RasterPass};
use super::timing::{FrameTiming, Timing};
use crate::error::RenderError;

/// Of a picture's pixels seldom more than one in so many is listed.
const MOST_LISTED: u64 = 4;

/// What an invocation of a pass without long loops takes, in loop iterations: the correction's take 0.06 µs
/// on the software driver.
pub(crate) const SHORT: u64 = 40;
/// What drawing takes, in loop iterations.
const DRAWING: u64 = 1 << 22;

/// A frame being recorded.
pub(crate) struct Recording<'a> {
    pub device: &'a Device,
    pub pipelines: &'a Pipelines,
    pub encoder: wgpu::CommandEncoder,
    pub timing: &'a Timing,
    pub frame_timing: FrameTiming,
    /// Parts that are recorded.
    ended: VecDeque<wgpu::CommandBuffer>,
    /// Loop iterations of the part that is being recorded, at most.
    iterations: u64,
    /// Loop iterations after which a part ends.
    most: u64,
}

/// A frame that was recorded: its parts in order, of which there is at least one.
pub(crate) struct Recorded {
    pub parts: VecDeque<wgpu::CommandBuffer>,
    pub timing: FrameTiming,
}

/// How many invocations a dispatch has.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Size<'a> {
    /// So many along each axis, at least.
    Invocations([u32; 3]),
    /// As many groups as the first three words of a buffer say.
    Indirect(&'a wgpu::Buffer),
}

impl From<[u32; 2]> for Size<'_> {
    fn from([width, height]: [u32; 2]) -> Self {
        Self::Invocations([width, height, 1])
    }
}

/// One dispatch of a pass.
pub(crate) struct Link<'a> {
    /// Name of the permutation.
    pub program: &'a str,
    pub bindings: Bindings<'a>,
    pub size: Size<'a>,
}

impl<'a> Recording<'a> {
    /// A new frame; `in_parts` cuts it where it gets long.
    pub fn new(
        device: &'a Device,
        pipelines: &'a Pipelines,
        timing: &'a Timing,
        in_parts: bool,
    ) -> Self {
        let most = most_iterations(device.summary().kind);
        Self {
            device,
            pipelines,
            encoder: encoder(device),
            timing,
            frame_timing: FrameTiming::default(),
            ended: VecDeque::new(),
            iterations: 0,
            most: if in_parts { most } else { u64::MAX },
        }
    }

    /// Counts what was recorded, and ends the part if that is enough.
    fn count(&mut self, iterations: u64) {
        self.iterations = self.iterations.saturating_add(iterations);
        if self.iterations >= self.most {
            self.end_part();
        }
    }

    /// Ends a part before something that takes as long as one, and after it.
    pub fn end_part(&mut self) {
        if self.most == u64::MAX || self.iterations == 0 {
            return;
        }
        let ended = std::mem::replace(&mut self.encoder, encoder(self.device));
        self.ended.push_back(ended.finish());
        self.iterations = 0;
    }

    /// Dispatches permutation `program`.
    pub fn compute(
        &mut self,
        name: &'static str,
        program: &str,
        constants: &Constants,
        bindings: &Bindings<'_>,
        size: Size<'_>,
    ) -> Result<(), RenderError> {
        let program = self.pipelines.compute(self.device, program, constants)?;
        let groups = program.bind(self.device, bindings)?;
        let mut pass = self.compute_pass(name);
        program.set(&mut pass, &groups);
        dispatch(&mut pass, &program, size);
        drop(pass);
        self.count(short_iterations(&program, size));
        Ok(())
    }

    /// Dispatches permutation `program`, whose invocations loop up to `iterations` times each, in as many
    /// parts as keep each of them short. The shader finds its part by `engine/band.wesl`.
    pub fn compute_in_parts(
        &mut self,
        name: &'static str,
        program: &str,
        constants: &Constants,
        bindings: &Bindings<'_>,
        (size, iterations): ([u32; 3], u64),
    ) -> Result<(), RenderError> {
        let program = self.pipelines.compute(self.device, program, constants)?;
        let kind = self.device.summary().kind;
        let most = most_groups(kind, program.invocations(), iterations);
        let mut dispatches = VecDeque::new();
        for part in parts(program.groups(size), most) {
            let band = self.device.band(part.first);
            let mut bindings = bindings.clone();
            bindings.buffer("band", &band);
            dispatches.push_back((program.bind(self.device, &bindings)?, part.count));
        }
        let per_group = u64::from(program.invocations()).saturating_mul(iterations.max(SHORT));
        while !dispatches.is_empty() {
            let room = self.most - self.iterations.min(self.most);
            let mut counted = 0_u64;
            let mut pass = self.compute_pass(name);
            while let Some((groups, [x, y, z])) = dispatches.pop_front() {
                program.set(&mut pass, &groups);
                pass.dispatch_workgroups(x, y, z);
                let count = u64::from(x) * u64::from(y) * u64::from(z);
                counted = counted.saturating_add(per_group.saturating_mul(count));
                if counted >= room {
                    break;
                }
            }
            drop(pass);
            self.count(counted);
        }
        Ok(())
    }

    /// Dispatches permutation `program` over a list of up to `most` entries, of which `list` says how many
    /// groups there are: in one indirect dispatch where that cannot take long, otherwise in parts over all
    /// that there may be, whose invocations beyond the list end at once.
    pub fn compute_listed(
        &mut self,
        name: &'static str,
        program: &str,
        constants: &Constants,
        bindings: &Bindings<'_>,
        (list, most, iterations): (&wgpu::Buffer, u32, u64),
    ) -> Result<(), RenderError> {
        let built = self.pipelines.compute(self.device, program, constants)?;
        let kind = self.device.summary().kind;
        let [groups, ..] = built.groups([most, 1, 1]);
        let usual = most_groups(kind, built.invocations(), iterations / MOST_LISTED);
        if groups <= usual {
            let band = self.device.band([0; 3]);
            let mut bindings = bindings.clone();
            bindings.buffer("band", &band);
            return self.compute(name, program, constants, &bindings, Size::Indirect(list));
        }
        let long = ([most, 1, 1], iterations);
        self.compute_in_parts(name, program, constants, bindings, long)
    }

    /// Dispatches several permutations one after the other in one pass.
    pub fn compute_chain(
        &mut self,
        name: &'static str,
        constants: &Constants,
        links: &[Link<'_>],
    ) -> Result<(), RenderError> {
        let mut dispatches = VecDeque::with_capacity(links.len());
        for link in links {
            let program = self
                .pipelines
                .compute(self.device, link.program, constants)?;
            let groups = program.bind(self.device, &link.bindings)?;
            dispatches.push_back((program, groups, link.size));
        }
        while !dispatches.is_empty() {
            let room = self.most - self.iterations.min(self.most);
            let mut counted = 0_u64;
            let mut pass = self.compute_pass(name);
            while let Some((program, groups, size)) = dispatches.pop_front() {
                program.set(&mut pass, &groups);
                dispatch(&mut pass, &program, size);
                counted = counted.saturating_add(short_iterations(&program, size));
                if counted >= room {
                    break;
                }
            }
            drop(pass);
            self.count(counted);
        }
        Ok(())
    }

    fn compute_pass(&mut self, name: &'static str) -> wgpu::ComputePass<'_> {
        self.encoder
            .begin_compute_pass(&wgpu::ComputePassDescriptor {
                label: Some(name),
                timestamp_writes: self.timing.compute(&mut self.frame_timing, name),
            })
    }

    /// Draws.
    pub fn raster(
        &mut self,
        name: &'static str,
        raster: &RasterPass<'_>,
        bindings: &Bindings<'_>,
    ) -> Result<(), RenderError> {
        let colors: Vec<_> = raster
            .colors
            .iter()
            .map(|attachment| {
                Some(wgpu::RenderPassColorAttachment {
                    view: attachment.view,
                    depth_slice: None,
                    resolve_target: None,
                    ops: wgpu::Operations {
                        load: load(attachment, wgpu::Color::TRANSPARENT),
                        store: wgpu::StoreOp::Store,
                    },
                })
            })
            .collect();
        let depth = raster
            .depth
            .map(|attachment| wgpu::RenderPassDepthStencilAttachment {
                view: attachment.view,
                depth_ops: Some(wgpu::Operations {
                    load: load(&attachment, 0.0),
                    store: wgpu::StoreOp::Store,
                }),
                stencil_ops: None,
            });
        let mut pass = self.encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some(name),
            color_attachments: &colors,
            depth_stencil_attachment: depth,
            timestamp_writes: self.timing.raster(&mut self.frame_timing, name),
            occlusion_query_set: None,
            multiview_mask: None,
        });
        if let Some((vertices, indices)) = raster.geometry {
            pass.set_vertex_buffer(0, vertices.slice(..));
            pass.set_index_buffer(indices.slice(..), wgpu::IndexFormat::Uint32);
        }
        let mut current = None;
        for draw in raster.draws {
            // Draws are sorted by class, so pipelines change a few times a pass.
            if current != Some(draw.shader.name) {
                let program = self
                    .pipelines
                    .raster_of(self.device, draw.shader, raster.state)?;
                let groups = program.bind(self.device, bindings)?;
                program.set(&mut pass, &groups);
                current = Some(draw.shader.name);
            }
            match &draw.call {
                DrawCall::Indexed {
                    indices,
                    base_vertex,
                    instances,
                } => pass.draw_indexed(indices.clone(), *base_vertex, instances.clone()),
                DrawCall::Vertices {
                    vertices,
                    instances,
                } => pass.draw(vertices.clone(), instances.clone()),
                DrawCall::Indirect(counts) => pass.draw_indirect(counts, 0),
            }
        }
        drop(pass);
        self.count(DRAWING);
        Ok(())
    }

    /// Everything that was recorded.
    pub fn finish(mut self) -> Recorded {
        self.ended.push_back(self.encoder.finish());
        Recorded {
            parts: self.ended,
            timing: self.frame_timing,
        }
    }
}

fn encoder(device: &Device) -> wgpu::CommandEncoder {
    device
        .device
        .create_command_encoder(&wgpu::CommandEncoderDescriptor {
            label: Some("frame"),
        })
}

fn dispatch(pass: &mut wgpu::ComputePass<'_>, program: &ComputeProgram, size: Size<'_>) {
    match size {
        Size::Invocations(size) => {
            let [x, y, z] = program.groups(size);
            pass.dispatch_workgroups(x, y, z);
        }
        Size::Indirect(counts) => pass.dispatch_workgroups_indirect(counts, 0),
    }
}

/// What a dispatch without long loops takes, in loop iterations. A list counts nothing: whoever dispatches
/// over it bounds it.
fn short_iterations(program: &ComputeProgram, size: Size<'_>) -> u64 {
    match size {
        Size::Invocations(size) => {
            let groups: u64 = program.groups(size).map(u64::from).iter().product();
            groups * u64::from(program.invocations()) * SHORT
        }
        Size::Indirect(_) => 0,
    }
}

fn load<V>(attachment: &Attachment<'_>, zero: V) -> wgpu::LoadOp<V> {
    if attachment.kept {
        wgpu::LoadOp::Load
    } else {
        wgpu::LoadOp::Clear(zero)
    }
}
