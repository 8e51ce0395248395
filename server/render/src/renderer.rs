//! One device, its pipelines, and the geometries its views share.

use std::sync::{Arc, Weak};
use std::time::Instant;

use glam::DVec3;
use tyndall_scene::Scene;

use crate::device::{AdapterSummary, Device};
use crate::engine::Recording;
use crate::error::RenderError;
use crate::frame;
use crate::gpu_scene::{GpuGeometry, SampleValues};
use crate::image::Work;
use crate::plan::{PlanLimits, march_steps};
use crate::programs::{Constants, Programs};
use crate::readback::{FrameMeta, statistics_scale, wait};
use crate::self_test::SelfTest;
use crate::supported::check_supported;
use crate::view::{View, ViewParts};

/// Renders views on one device. Single-threaded: one thread owns it.
#[derive(Debug)]
pub struct Renderer {
    device: Device,
    programs: Programs,
    /// Geometries some view still uses.
    geometries: Vec<Weak<GpuGeometry>>,
}

/// What a call of [`Renderer::render`] did.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RenderOutcome {
    /// A frame is on its way to [`View::take_finished`].
    Submitted,
    /// The picture is finished and shown: nothing was done.
    Converged,
    /// Too many frames are in flight: take one first.
    RingFull,
}

impl Renderer {
    /// A renderer on an open device. Pipelines are built at their first use.
    pub fn new(device: Device) -> Result<Self, RenderError> {
        device.check()?;
        Ok(Self {
            device,
            programs: Programs::default(),
            geometries: Vec::new(),
        })
    }

    /// The adapter in use.
    pub fn adapter(&self) -> &AdapterSummary {
        self.device.summary()
    }

    /// Memory allocated on the device, by its allocator's own report, if it makes one. Unit: byte.
    pub fn device_bytes(&self) -> Option<u64> {
        let report = self.device.device.generate_allocator_report()?;
        Some(report.total_allocated_bytes)
    }

    /// What the start-up self-test found.
    pub fn self_test(&self) -> SelfTest {
        self.device.self_test()
    }

    pub(crate) fn device(&self) -> &Device {
        &self.device
    }

    /// What the planner must respect on this device.
    pub fn plan_limits(&self) -> PlanLimits {
        PlanLimits {
            loop_cap: self.device.self_test().loop_cap,
        }
    }

    /// A view of `scene`, `width` × `height` pixels. Refuses what is not rendered yet by name.
    pub fn create_view(
        &mut self,
        scene: Arc<Scene>,
        width: u32,
        height: u32,
    ) -> Result<View, RenderError> {
        check_supported(&scene)?;
        let geometry = self.geometry(&scene)?;
        let limits = self.plan_limits();
        let view = View::new(&self.device, scene, geometry, (width, height), limits)?;
        self.device.check()?;
        Ok(view)
    }

    /// Gives a view a new state of its scene. On an error the view keeps the old one.
    pub fn update_view(&mut self, view: &mut View, scene: Arc<Scene>) -> Result<(), RenderError> {
        check_supported(&scene)?;
        let geometry = if view.scene.geometry == scene.geometry {
            Arc::clone(&view.geometry)
        } else {
            self.geometry(&scene)?
        };
        view.update(&self.device, scene, geometry)?;
        self.device.check()
    }

    /// Gives a view another size; frames in flight of the old size are dropped.
    pub fn resize_view(
        &mut self,
        view: &mut View,
        width: u32,
        height: u32,
    ) -> Result<(), RenderError> {
        view.resize(&self.device, width, height)?;
        self.device.check()
    }

    /// Submits the next frame of `view`, if there is anything to do. Never waits for the device.
    /// `tag` comes back with the frame.
    pub fn render(&mut self, view: &mut View, tag: u64) -> Result<RenderOutcome, RenderError> {
        let stop = view.scene.render.stop;
        let work = view.image.work(stop);
        if work == Work::Nothing {
            return Ok(RenderOutcome::Converged);
        }
        if !view.ring.has_room() {
            return Ok(RenderOutcome::RingFull);
        }
        let started = Instant::now();
        if view.stale {
            view.inputs.upload_scene(
                &self.device,
                &view.scene,
                &view.geometry,
                &view.shadows,
                view.shadow_mode(),
            );
            view.stale = false;
        }
        let (width, height) = view.size();
        let sample = SampleValues {
            pixel_offset: view.image.pixel_offset(),
            sample_index: view.image.samples(),
            march_steps: march_steps(&view.facts, &view.scene.render, view.limits()),
        };
        view.inputs.upload_frame(
            &self.device,
            &view.scene,
            &view.facts,
            view.geometry.anchor,
            (width, height),
            sample,
        );
        let mut recording = Recording::new(
            &self.device,
            &self.programs,
            &view.timing,
            Constants {
                medium_count: view.scene.media.len() as u32,
                light_count: view.scene.lights.len() as u32,
            },
        );
        let mut parts = ViewParts {
            geometry: &view.geometry,
            targets: &view.targets,
            inputs: &view.inputs,
            shadows: &mut view.shadows,
        };
        frame::record(&mut recording, &view.plan, &mut parts, work)?;
        view.ring.record(
            &mut recording.encoder,
            &view.targets.displayed,
            &view.inputs.statistics,
            &view.timing,
            &recording.frame_timing,
        );
        let frame_timing = recording.submit()?;
        view.image.advance(work);
        let meta = FrameMeta {
            tag,
            samples: view.image.samples(),
            converged: view.image.is_finished(stop),
            epoch: view.image.epoch(),
            started,
            statistics_scale: statistics_scale(width, height),
            filmed: work == Work::Sample,
        };
        view.ring.submit(meta, frame_timing);
        Ok(RenderOutcome::Submitted)
    }

    /// Lets finished frames arrive. Never blocks.
    pub fn poll(&self) -> Result<(), RenderError> {
        self.device
            .device
            .poll(wgpu::PollType::Poll)
            .map_err(|error| RenderError::Refused(error.to_string()))?;
        self.device.check()
    }

    /// Blocks until everything submitted has finished.
    pub fn wait(&self) -> Result<(), RenderError> {
        wait(&self.device)?;
        self.device.check()
    }

    /// The scene's geometry on the device, shared with every view that already has it.
    fn geometry(&mut self, scene: &Scene) -> Result<Arc<GpuGeometry>, RenderError> {
        self.geometries.retain(|known| known.strong_count() > 0);
        let known = self
            .geometries
            .iter()
            .filter_map(Weak::upgrade)
            .find(|known| known.source == scene.geometry);
        if let Some(known) = known {
            return Ok(known);
        }
        let anchor = tyndall_scene::facts(scene)
            .surface_bounds
            .map_or(DVec3::ZERO, |bounds| 0.5 * (bounds.min + bounds.max));
        let uploaded = Arc::new(GpuGeometry::upload(&self.device, &scene.geometry, anchor)?);
        self.geometries.push(Arc::downgrade(&uploaded));
        Ok(uploaded)
    }
}
