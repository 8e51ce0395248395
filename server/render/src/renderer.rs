//! One device, its pipelines, and the geometries its views share.

use std::sync::Arc;
use std::time::Instant;

use tyndall_scene::{Medium, MediumShape, Scene, ShadowMode, Technique};

use crate::correction::Seen;
use crate::device::{AdapterSummary, Device};
use crate::engine::Recording;
use crate::error::RenderError;
use crate::frame;
use crate::gpu_scene::{AssetCache, SampleValues};
use crate::image::Work;
use crate::pixel_offsets::pixel_offset;
use crate::plan::{March, PassKind, PlanLimits, area_strata, has_area_lights};
use crate::programs::{Constants, Programs};
use crate::readback::{FrameMeta, statistics_scale, wait};
use crate::self_test::SelfTest;
use crate::slices::Slice;
use crate::supported::check_supported;
use crate::view::{View, ViewParts};

/// Renders views on one device. Single-threaded: one thread owns it.
#[derive(Debug)]
pub struct Renderer {
    device: Device,
    programs: Programs,
    /// What views share.
    assets: AssetCache,
    unskipped: bool,
}

/// What a call of [`Renderer::render`] did.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RenderOutcome {
    /// A frame is on its way to [`View::take_finished`].
    Submitted,
    /// The picture is finished and shown: nothing was done.
    Converged,
    /// Frames are in flight that must be taken first: too many, or the ones that tell whether the picture
    /// is finished.
    Busy,
}

/// What a call of [`Renderer::prepare`] found.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Prepared {
    /// A view can be made, updated or resized without a long wait.
    Ready,
    /// Something is being made on other threads: ask again.
    Pending,
}

impl Renderer {
    /// A renderer on an open device. Pipelines are built at their first use.
    pub fn new(device: Device) -> Result<Self, RenderError> {
        device.check()?;
        Ok(Self {
            device,
            programs: Programs::default(),
            assets: AssetCache::default(),
            unskipped: false,
        })
    }

    /// From now on, the views that are made march every light along every ray and all strata. To measure
    /// what leaving out saves; pictures stay the same within 1e-3.
    pub fn set_unskipped(&mut self, unskipped: bool) {
        self.unskipped = unskipped;
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

    /// How often meshes, materials and textures went to the device; instances that move send none
    /// of them again.
    pub fn uploaded_geometries(&self) -> u64 {
        self.assets.uploaded_geometries()
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
            beyond_correction: false,
            unskipped: self.unskipped,
        }
    }

    /// Gets ready what a view of `scene` with this size needs. Refuses what is not rendered yet by name;
    /// everything else is built when the view is made. Never waits. Unit of the size: pixel.
    pub fn prepare(
        &mut self,
        scene: &Arc<Scene>,
        _size: (u32, u32),
    ) -> Result<Prepared, RenderError> {
        check_supported(scene)?;
        self.check_loops(scene)?;
        Ok(Prepared::Ready)
    }

    /// A view of `scene`, `width` × `height` pixels. Refuses what is not rendered yet by name.
    pub fn create_view(
        &mut self,
        scene: Arc<Scene>,
        width: u32,
        height: u32,
    ) -> Result<View, RenderError> {
        check_supported(&scene)?;
        self.check_loops(&scene)?;
        let assets = self.assets.assets(&self.device, &scene)?;
        let limits = self.plan_limits();
        let view = View::new(&self.device, scene, assets, (width, height), limits)?;
        self.device.check()?;
        Ok(view)
    }

    /// Gives a view a new state of its scene. On an error the view keeps the old one.
    pub fn update_view(&mut self, view: &mut View, scene: Arc<Scene>) -> Result<(), RenderError> {
        check_supported(&scene)?;
        self.check_loops(&scene)?;
        let assets = self.assets.assets(&self.device, &scene)?;
        view.update(&self.device, scene, assets)?;
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
        match work {
            Work::Nothing => return Ok(RenderOutcome::Converged),
            Work::Wait => return Ok(RenderOutcome::Busy),
            Work::Redisplay | Work::Sample => {}
        }
        if !view.ring.has_room() {
            return Ok(RenderOutcome::Busy);
        }
        let started = Instant::now();
        let march = March::of(&view.facts, &view.scene.render, view.limits());
        if view.stale {
            view.inputs.upload_scene(
                &self.device,
                &view.scene,
                &view.assets,
                &view.shadows,
                view.shadow_mode(),
                march.culls,
            );
            if let Some(volume) = &view.light_volume {
                volume.upload(&self.device, view.scene.camera.position);
            }
            view.stale = false;
        }
        let (width, height) = view.size();
        let share = view.share(work);
        view.look_back(&self.device, share);
        let slice = share.slice;
        if let Some(slice) = slice {
            view.inputs.upload_slice(&self.device, slice);
        }
        let sample = SampleValues {
            pixel_offset: pixel_offset(share.place),
            sample_index: share.place,
            accumulated: view.image.base_samples() + 1,
            turn: view.turn,
            march,
        };
        view.inputs.upload_frame(
            &self.device,
            &view.scene,
            &view.facts,
            view.assets.placement.anchor,
            (width, height),
            sample,
        );
        let mut recording = Recording::new(
            &self.device,
            &self.programs,
            &view.timing,
            constants(view, march),
        );
        let mut parts = ViewParts {
            assets: &view.assets,
            targets: &view.targets,
            inputs: &view.inputs,
            shadows: &mut view.shadows,
            light_volume: view.light_volume.as_ref(),
        };
        frame::record(&mut recording, &view.plan, &mut parts, work, share)?;
        if share.estimated {
            view.seen = Some(Seen {
                camera: view.scene.camera,
                changed: false,
            });
        }
        view.ring.record(
            &mut recording.encoder,
            &view.targets.displayed,
            &view.inputs.statistics,
            &view.timing,
            &recording.frame_timing,
        );
        let (frame_timing, submission) = recording.submit()?;
        let sweep = slice.map(|slice| view.slices.advance(slice));
        let added = slice.map_or(1, Slice::completed_samples);
        let base = view.has_base().then_some(share.base);
        view.image
            .advance(work, added, base, share.estimated.then_some(share.done));
        if let Some(sweep) = sweep {
            view.image.await_sweep(sweep);
        }
        let meta = FrameMeta {
            tag,
            samples: view.image.samples(),
            converged: view.is_converged(),
            epoch: view.image.epoch(),
            started,
            statistics_scale: statistics_scale(width, height),
            filmed: work == Work::Sample,
            transmittances: view.transmittance_sums(share),
            estimated: share.estimated && view.plan.runs(PassKind::Estimate),
            units: slice.map_or(0, |slice| slice.units(width)),
            shadow_layers: view.shadows.take_rendered(),
            sweep,
        };
        view.ring.submit(meta, frame_timing, submission);
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
        wait(&self.device, None)?;
        self.device.check()
    }

    /// Blocks until the oldest frame in flight of `view` has finished; returns at once without one.
    pub fn wait_for(&self, view: &View) -> Result<(), RenderError> {
        if let Some(submission) = view.ring.oldest_submission() {
            wait(&self.device, Some(submission))?;
        }
        self.device.check()
    }

    /// Paths are longer than what some drivers let a shader do.
    fn check_loops(&self, scene: &Scene) -> Result<(), RenderError> {
        match self.plan_limits().loop_cap {
            Some(cap) if scene.render.technique == Technique::Reference => {
                Err(RenderError::Refused(format!(
                    "this driver silently stops a shader after {cap} loop iterations, which cuts the reference's paths short: a newer driver (Mesa 23.1 or later) is needed"
                )))
            }
            Some(cap) if walks_through_grids(scene) => Err(RenderError::Refused(format!(
                "this driver silently stops a shader after {cap} loop iterations, which cuts short the walks of area lights through grids: a newer driver (Mesa 23.1 or later) is needed"
            ))),
            _ => Ok(()),
        }
    }
}

/// Whether a pass tracks collisions in grids, which takes as long as it takes.
fn walks_through_grids(scene: &Scene) -> bool {
    let facts = tyndall_scene::facts(scene);
    facts.grids > 0 && has_area_lights(&facts)
}

/// What pipelines are built for.
fn constants(view: &View, march: March) -> Constants {
    let (scene, facts) = (&view.scene, &view.facts);
    let emitter_count = view.assets.placement.emitter_count();
    let chromatic = |medium: &Medium| {
        let grey = |rgb: [f32; 3]| rgb == [rgb[0]; 3];
        let sigma_t: [f32; 3] = std::array::from_fn(|c| medium.sigma_s[c] + medium.sigma_a[c]);
        !grey(sigma_t)
    };
    let in_grid = |medium: &Medium| matches!(medium.shape, MediumShape::Grid { .. });
    Constants {
        medium_count: scene.media.len() as u32,
        light_count: scene.lights.len() as u32,
        emitter_count,
        chromatic: scene.media.iter().any(chromatic),
        chromatic_grids: scene.media.iter().any(|m| chromatic(m) && in_grid(m)),
        finds_light: emitter_count > 0 || facts.environment,
        glows: facts.medium_emits,
        isotropic: !facts.anisotropic,
        interleave: march.interleave,
        spacing: march.spacing,
        equiangular: march.equiangular,
        quadrature: march.quadrature,
        by_voxels: march.by_voxels,
        culls: march.culls,
        shadowed: scene.render.shadows.mode != ShadowMode::Off,
        sky: facts.environment,
        area_strata: area_strata(facts, &scene.render, view.limits()),
    }
}
