//! One device, its pipelines, and the geometries its views share.

use std::sync::Arc;
use std::time::Instant;

use tyndall_scene::Scene;

use crate::engine::{
    AdapterSummary, Device, FrameMeta, FrameTiming, MemoryBudget, Pipelines, Pool, Recording,
    SelfTest, statistics_scale, wait,
};
use crate::error::RenderError;
use crate::frame::{self, PlanLimits};
use crate::gpu_scene::{AssetCache, GpuAssets};
use crate::picture::{Share, Slice, Work};
use crate::prepare::{Preparations, Prepared, Shared};
use crate::stages::area_lights::has_area_lights;
use crate::stages::shadow_maps::ShadowMaps;
use crate::stages::tonemap::DISPLAYED;
use crate::supported::check_supported;
use crate::techniques;
use crate::view::View;

/// Renders views on one device. Single-threaded: one thread owns it.
#[derive(Debug)]
pub struct Renderer {
    shared: Shared,
    pool: Pool,
    preparations: Preparations,
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

impl Renderer {
    /// A renderer on an open device. Pipelines are built at their first use.
    pub fn new(device: Device) -> Result<Self, RenderError> {
        device.check()?;
        Ok(Self {
            shared: Shared {
                device: Arc::new(device),
                pipelines: Arc::new(Pipelines::default()),
                assets: Arc::new(AssetCache::default()),
            },
            pool: Pool::default(),
            preparations: Preparations::default(),
            unskipped: false,
        })
    }

    /// From now on, the views that are made march every light along every ray and all strata. To measure
    /// what leaving out saves; pictures stay the same within 1e-3.
    pub fn set_unskipped(&mut self, unskipped: bool) {
        self.unskipped = unskipped;
    }

    /// Limits the memory that pictures may take from now on. What would exceed it is refused with
    /// [`RenderError::Memory`]; views that are there stay.
    pub fn set_memory_budget(&mut self, budget: MemoryBudget) {
        self.pool.budget = budget;
    }

    /// The adapter in use.
    pub fn adapter(&self) -> &AdapterSummary {
        self.device().summary()
    }

    /// Memory allocated on the device, by its allocator's own report, if it makes one. Unit: byte.
    pub fn device_bytes(&self) -> Option<u64> {
        self.device().allocated_bytes()
    }

    /// How often meshes, materials and textures went to the device; instances that move send none
    /// of them again.
    pub fn uploaded_geometries(&self) -> u64 {
        self.shared.assets.uploaded_geometries()
    }

    /// What the start-up self-test found.
    pub fn self_test(&self) -> SelfTest {
        self.device().self_test()
    }

    pub(crate) fn device(&self) -> &Device {
        &self.shared.device
    }

    /// What the planner must respect on this device.
    pub fn plan_limits(&self) -> PlanLimits {
        PlanLimits {
            loop_cap: self.self_test().loop_cap,
            beyond_correction: false,
            unskipped: self.unskipped,
        }
    }

    /// Begins to make what `scene` needs on the device, on another thread; whether it is there. A view
    /// may take the scene at any time, and then makes itself what is not. Refuses what is not rendered
    /// yet by name. Never waits.
    pub fn prepare(&mut self, scene: &Arc<Scene>) -> Result<Prepared, RenderError> {
        check_supported(scene)?;
        self.check_loops(scene)?;
        let limits = self.plan_limits();
        Ok(self.preparations.ask(&self.shared, scene, limits))
    }

    /// A view of `scene`, `width` × `height` pixels. Refuses what is not rendered yet by name.
    pub fn create_view(
        &mut self,
        scene: Arc<Scene>,
        width: u32,
        height: u32,
    ) -> Result<View, RenderError> {
        let assets = self.assets(&scene)?;
        let limits = self.plan_limits();
        let size = [width, height];
        let device = &self.shared.device;
        let view = View::new(device, &mut self.pool, scene, assets, size, limits)?;
        self.device().check()?;
        self.preparations.taken(view.scene());
        Ok(view)
    }

    /// Gives a view a new state of its scene. On an error the view keeps the old one.
    pub fn update_view(&mut self, view: &mut View, scene: Arc<Scene>) -> Result<(), RenderError> {
        let assets = self.assets(&scene)?;
        view.update(&self.shared.device, &mut self.pool, scene, assets)?;
        self.preparations.taken(view.scene());
        self.device().check()
    }

    /// Gives a view another size; frames in flight of the old size are dropped.
    pub fn resize_view(
        &mut self,
        view: &mut View,
        width: u32,
        height: u32,
    ) -> Result<(), RenderError> {
        view.resize(&self.shared.device, &mut self.pool, [width, height])?;
        self.device().check()
    }

    /// The scene's shared parts on the device, of a scene that can be rendered.
    fn assets(&self, scene: &Scene) -> Result<GpuAssets, RenderError> {
        check_supported(scene)?;
        self.check_loops(scene)?;
        self.shared.assets.assets(&self.shared.device, scene)
    }

    /// Submits the next frame of `view`, if there is anything to do. Never waits for the device.
    /// `tag` comes back with the frame.
    pub fn render(&mut self, view: &mut View, tag: u64) -> Result<RenderOutcome, RenderError> {
        let work = view.accumulation.work(view.scene().render.stop);
        match work {
            Work::Nothing => return Ok(RenderOutcome::Converged),
            Work::Wait => return Ok(RenderOutcome::Busy),
            Work::Redisplay | Work::Sample => {}
        }
        if !view.ring.has_room() {
            return Ok(RenderOutcome::Busy);
        }
        let started = Instant::now();
        let share = view.share(work);
        view.prepare_frame(&self.shared.device, share);
        let submitted = self.submit(view, share);
        view.settle(submitted.is_ok(), share);
        let (frame_timing, submission) = submitted?;
        let (width, height) = view.size();
        let sweep = share.slice.map(|slice| view.slices.advance(slice));
        let added = share.slice.map_or(1, Slice::completed_samples);
        let base = view.has_base().then_some(share.base);
        let estimated = share.estimated.then_some(share.done);
        view.accumulation.advance(work, added, base, estimated);
        if let Some(sweep) = sweep {
            view.accumulation.await_sweep(sweep);
        }
        let shadows = view.state.kept.get::<ShadowMaps>();
        let meta = FrameMeta {
            tag,
            samples: view.accumulation.samples(),
            converged: view.is_converged(),
            epoch: view.accumulation.epoch(),
            started,
            statistics_scale: statistics_scale(width, height),
            filmed: work == Work::Sample,
            transmittances: view.transmittance_sums(share),
            estimated: view.estimates(share),
            units: share.slice.map_or(0, |slice| slice.units(width)),
            shadow_layers: shadows.map_or(0, ShadowMaps::take_rendered),
            sweep,
        };
        view.ring.submit(meta, frame_timing, submission);
        Ok(RenderOutcome::Submitted)
    }

    /// Records and submits what `share` includes of the view's plan.
    fn submit(
        &self,
        view: &View,
        share: Share,
    ) -> Result<(FrameTiming, wgpu::SubmissionIndex), RenderError> {
        let Shared {
            device, pipelines, ..
        } = &self.shared;
        let mut recording = Recording::new(device, pipelines, &view.timing);
        let parts = view.parts(share);
        frame::record(&mut recording, view.plan(), &parts)?;
        view.ring.record(
            &mut recording.encoder,
            parts.buffer(&DISPLAYED)?,
            &parts.inputs.statistics,
            &view.timing,
            &recording.frame_timing,
        );
        recording.submit()
    }

    /// Lets finished frames arrive. Never blocks.
    pub fn poll(&self) -> Result<(), RenderError> {
        self.device()
            .device
            .poll(wgpu::PollType::Poll)
            .map_err(|error| RenderError::Refused(error.to_string()))?;
        self.device().check()
    }

    /// Blocks until everything submitted has finished.
    pub fn wait(&self) -> Result<(), RenderError> {
        wait(self.device(), None)?;
        self.device().check()
    }

    /// Blocks until the oldest frame in flight of `view` has finished; returns at once without one.
    pub fn wait_for(&self, view: &View) -> Result<(), RenderError> {
        if let Some(submission) = view.ring.oldest_submission() {
            wait(self.device(), Some(submission))?;
        }
        self.device().check()
    }

    /// Paths are longer than what some drivers let a shader do.
    fn check_loops(&self, scene: &Scene) -> Result<(), RenderError> {
        let limits = self.plan_limits();
        let Some(cap) = limits.loop_cap else {
            return Ok(());
        };
        let facts = tyndall_scene::facts(scene);
        let technique = techniques::of(scene.render.technique);
        if let Some(why) = technique.and_then(|t| t.device_refusal(&facts, limits)) {
            return Err(RenderError::Refused(why));
        }
        // Collisions in grids are tracked as long as it takes.
        if facts.grids > 0 && has_area_lights(&facts) {
            return Err(RenderError::Refused(format!(
                "this driver silently stops a shader after {cap} loop iterations, which cuts short the walks of area lights through grids: a newer driver (Mesa 23.1 or later) is needed"
            )));
        }
        Ok(())
    }
}
