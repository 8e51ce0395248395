//! The one place that records and submits commands.

use super::bands::{most_groups, parts};
use super::bindings::Bindings;
use super::constants::Constants;
use super::device::Device;
use super::pipelines::Pipelines;
use super::raster::{Attachment, DrawCall, RasterPass};
use super::timing::{FrameTiming, Timing};
use crate::error::RenderError;

/// Of a picture's pixels seldom more than one in so many is listed.
const MOST_LISTED: u64 = 4;

/// A frame being recorded.
pub(crate) struct Recording<'a> {
    pub device: &'a Device,
    pub pipelines: &'a Pipelines,
    pub encoder: wgpu::CommandEncoder,
    pub timing: &'a Timing,
    pub frame_timing: FrameTiming,
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
    pub fn new(device: &'a Device, pipelines: &'a Pipelines, timing: &'a Timing) -> Self {
        Self {
            device,
            pipelines,
            encoder: device
                .device
                .create_command_encoder(&wgpu::CommandEncoderDescriptor {
                    label: Some("frame"),
                }),
            timing,
            frame_timing: FrameTiming::default(),
        }
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
        match size {
            Size::Invocations(size) => {
                let [x, y, z] = program.groups(size);
                pass.dispatch_workgroups(x, y, z);
            }
            Size::Indirect(counts) => pass.dispatch_workgroups_indirect(counts, 0),
        }
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
        let mut dispatches = Vec::new();
        for part in parts(program.groups(size), most) {
            let band = self.device.band(part.first);
            let mut bindings = bindings.clone();
            bindings.buffer("band", &band);
            dispatches.push((program.bind(self.device, &bindings)?, part.count));
        }
        let mut pass = self.compute_pass(name);
        for (groups, [x, y, z]) in &dispatches {
            program.set(&mut pass, groups);
            pass.dispatch_workgroups(*x, *y, *z);
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
        let mut dispatches = Vec::with_capacity(links.len());
        for link in links {
            let program = self
                .pipelines
                .compute(self.device, link.program, constants)?;
            let groups = program.bind(self.device, &link.bindings)?;
            dispatches.push((program, groups, link.size));
        }
        let mut pass = self.compute_pass(name);
        for (program, groups, size) in &dispatches {
            program.set(&mut pass, groups);
            match size {
                Size::Invocations(size) => {
                    let [x, y, z] = program.groups(*size);
                    pass.dispatch_workgroups(x, y, z);
                }
                Size::Indirect(counts) => pass.dispatch_workgroups_indirect(counts, 0),
            }
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
        Ok(())
    }

    /// Submits everything recorded.
    pub fn submit(self) -> Result<(FrameTiming, wgpu::SubmissionIndex), RenderError> {
        let index = self.device.queue.submit([self.encoder.finish()]);
        self.device.check()?;
        Ok((self.frame_timing, index))
    }
}

fn load<V>(attachment: &Attachment<'_>, zero: V) -> wgpu::LoadOp<V> {
    if attachment.kept {
        wgpu::LoadOp::Load
    } else {
        wgpu::LoadOp::Clear(zero)
    }
}
