//! The one place that records and submits commands.

use crate::device::Device;
use crate::error::RenderError;
use crate::gpu_scene::{Draw, GpuGeometry};
use crate::programs::{Bindings, Constants, Programs, RasterTargets};
use crate::timing::{FrameTiming, Timing};

/// A frame being recorded.
pub(crate) struct Recording<'a> {
    pub device: &'a Device,
    pub programs: &'a Programs,
    pub encoder: wgpu::CommandEncoder,
    pub timing: &'a Timing,
    pub frame_timing: FrameTiming,
    pub constants: Constants,
}

/// Attachments of a raster pass.
pub(crate) struct Attachments<'a> {
    /// Cleared to 0 each.
    pub colors: &'a [&'a wgpu::TextureView],
    /// Cleared to 0: nothing there, in reversed depth.
    pub depth: &'a wgpu::TextureView,
}

/// A draw of a raster pass.
pub(crate) struct RasterDraw<'a> {
    pub variant: String,
    pub draw: &'a Draw,
}

impl<'a> Recording<'a> {
    pub fn new(
        device: &'a Device,
        programs: &'a Programs,
        timing: &'a Timing,
        constants: Constants,
    ) -> Self {
        Self {
            device,
            programs,
            encoder: device
                .device
                .create_command_encoder(&wgpu::CommandEncoderDescriptor {
                    label: Some("frame"),
                }),
            timing,
            frame_timing: FrameTiming::default(),
            constants,
        }
    }

    /// Dispatches permutation `variant` over `width` × `height` invocations.
    pub fn compute(
        &mut self,
        name: &'static str,
        variant: &str,
        bindings: &Bindings<'_>,
        width: u32,
        height: u32,
    ) -> Result<(), RenderError> {
        let program = self
            .programs
            .compute(self.device, variant, self.constants)?;
        let groups = program.bind(self.device, bindings)?;
        let [x, y] = program.workgroups(width, height);
        let mut pass = self.compute_pass(name);
        program.set(&mut pass, &groups);
        pass.dispatch_workgroups(x, y, 1);
        Ok(())
    }

    /// Dispatches several permutations one after the other in one pass, each over its size.
    pub fn compute_chain(
        &mut self,
        name: &'static str,
        links: &[(String, Bindings<'_>, [u32; 2])],
    ) -> Result<(), RenderError> {
        let mut dispatches = Vec::with_capacity(links.len());
        for (variant, bindings, [width, height]) in links {
            let program = self
                .programs
                .compute(self.device, variant, self.constants)?;
            let groups = program.bind(self.device, bindings)?;
            let counts = program.workgroups(*width, *height);
            dispatches.push((program, groups, counts));
        }
        let mut pass = self.compute_pass(name);
        for (program, groups, [x, y]) in &dispatches {
            program.set(&mut pass, groups);
            pass.dispatch_workgroups(*x, *y, 1);
        }
        Ok(())
    }

    /// Dispatches permutation `name` over a volume.
    pub fn compute_volume(
        &mut self,
        name: &'static str,
        bindings: &Bindings<'_>,
        size: [u32; 3],
    ) -> Result<(), RenderError> {
        let program = self.programs.compute(self.device, name, self.constants)?;
        let groups = program.bind(self.device, bindings)?;
        let mut pass = self.compute_pass(name);
        program.set(&mut pass, &groups);
        let [x, y, z] = program.groups(size);
        pass.dispatch_workgroups(x, y, z);
        Ok(())
    }

    /// Dispatches as many groups as the first three words of `counts` say.
    pub fn compute_indirect(
        &mut self,
        name: &'static str,
        variant: &str,
        bindings: &Bindings<'_>,
        counts: &wgpu::Buffer,
    ) -> Result<(), RenderError> {
        let program = self
            .programs
            .compute(self.device, variant, self.constants)?;
        let groups = program.bind(self.device, bindings)?;
        let mut pass = self.compute_pass(name);
        program.set(&mut pass, &groups);
        pass.dispatch_workgroups_indirect(counts, 0);
        Ok(())
    }

    fn compute_pass(&mut self, name: &'static str) -> wgpu::ComputePass<'_> {
        self.encoder
            .begin_compute_pass(&wgpu::ComputePassDescriptor {
                label: Some(name),
                timestamp_writes: self.timing.compute(&mut self.frame_timing, name),
            })
    }

    /// Clears the attachments and draws.
    pub fn raster(
        &mut self,
        name: &'static str,
        attachments: &Attachments<'_>,
        targets: &RasterTargets<'_>,
        geometry: &GpuGeometry,
        bindings: &Bindings<'_>,
        draws: &[RasterDraw<'_>],
    ) -> Result<(), RenderError> {
        let colors: Vec<_> = attachments
            .colors
            .iter()
            .map(|view| {
                Some(wgpu::RenderPassColorAttachment {
                    view,
                    depth_slice: None,
                    resolve_target: None,
                    ops: wgpu::Operations {
                        load: wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT),
                        store: wgpu::StoreOp::Store,
                    },
                })
            })
            .collect();
        let mut pass = self.encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some(name),
            color_attachments: &colors,
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: attachments.depth,
                depth_ops: Some(wgpu::Operations {
                    load: wgpu::LoadOp::Clear(0.0),
                    store: wgpu::StoreOp::Store,
                }),
                stencil_ops: None,
            }),
            timestamp_writes: self.timing.raster(&mut self.frame_timing, name),
            occlusion_query_set: None,
            multiview_mask: None,
        });
        pass.set_vertex_buffer(0, geometry.vertices.slice(..));
        pass.set_index_buffer(geometry.indices.slice(..), wgpu::IndexFormat::Uint32);
        let mut current = None;
        for RasterDraw { variant, draw } in draws {
            // Draws are sorted by class, so pipelines change a few times a pass.
            if current != Some(variant) {
                let program = self.programs.raster(self.device, variant, targets)?;
                let groups = program.bind(self.device, bindings)?;
                program.set(&mut pass, &groups);
                current = Some(variant);
            }
            pass.draw_indexed(
                draw.indices.clone(),
                draw.base_vertex,
                draw.instances.clone(),
            );
        }
        Ok(())
    }

    /// Submits everything recorded; the index is what to wait for until the device has done it.
    pub fn submit(self) -> Result<(FrameTiming, wgpu::SubmissionIndex), RenderError> {
        let index = self.device.queue.submit([self.encoder.finish()]);
        self.device.check()?;
        Ok((self.frame_timing, index))
    }
}
