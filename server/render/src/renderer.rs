//! One device, its pipelines, and the geometries its views share.

use std::sync::Arc;
use std::time::{Duration, Instant};

use tyndall_scene::Scene;

use crate::engine::{
    AdapterKind, AdapterSummary, Device, MemoryBudget, Pipelines, Pool, Recorded, Recording,
    SelfTest, wait,
};
use crate::error::RenderError;
use crate::frame::{self, PlanLimits};
use crate::gpu_scene::{AssetCache, GpuAssets};
use crate::picture::{Share, Work};
use crate::prepare::{Preparations, Prepared, Shared};
use crate::stages::area_lights::has_area_lights;
use crate::stages::tonemap::DISPLAYED;
use crate::supported::check_supported;
use crate::techniques;
use crate::view::{View, slice_budget};

/// Renders views on one device. Single-threaded: one thread owns it.
#[derive(Debug)]
pub struct Renderer {
    shared: Shared,
    pool: Pool,
    preparations: Preparations,
    unskipped: bool,
    in_parts: bool,
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
            in_parts: false,
        })
    }

    /// From now on, the views that are made march every light along every ray and all strata. To measure
    /// what leaving out saves; pictures stay the same within 1e-3.
    pub fn set_unskipped(&mut self, unskipped: bool) {
        self.unskipped = unskipped;
    }

    /// From now on, long frames of the views that are made are submitted part by part: the first by
    /// [`Self::render`], the others by [`Self::go_on`]. Others may have the device between two of them.
    pub fn set_in_parts(&mut self, in_parts: bool) {
        self.in_parts = in_parts;
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
            in_parts: self.in_parts,
            software: self.adapter().kind != AdapterKind::Gpu,
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
        if !view.ring.has_room() || view.is_under_way() {
            return Ok(RenderOutcome::Busy);
        }
        let started = Instant::now();
        let share = view.share(work);
        view.prepare_frame(&self.shared.device, share);
        match self.record(view, share) {
            Ok(recorded) => {
                view.begin(self.device(), tag, started, (work, share), recorded)?;
                Ok(RenderOutcome::Submitted)
            }
            Err(error) => {
                view.settle(false, share);
                Err(error)
            }
        }
    }

    /// Submits the next part of the frame of `view` that is under way, if there is one and the device is
    /// done with the part before. Never waits.
    pub fn go_on(&self, view: &mut View) -> Result<(), RenderError> {
        view.go_on(self.device())
    }

    /// Drops the frame of `view` of which parts are not submitted yet, for a picture that is about to
    /// start anew; whether there was one.
    pub fn abandon(&self, view: &mut View) -> bool {
        view.abandon()
    }

    /// Sets the time that traced samples of `view` may take in a frame: at most three times what is usual on
    /// this device, which holds without `budget`.
    pub fn trace_within(&self, view: &mut View, budget: Option<Duration>) {
        let usual = slice_budget(self.device());
        view.set_slice_budget(budget.map_or(usual, |budget| budget.min(3 * usual)));
    }

    /// Records what `share` includes of the view's plan.
    fn record(&self, view: &View, share: Share) -> Result<Recorded, RenderError> {
        let Shared {
            device, pipelines, ..
        } = &self.shared;
        let in_parts = view.state.is_cut;
        let mut recording = Recording::new(device, pipelines, &view.timing, in_parts);
        let parts = view.parts(share);
        frame::record(&mut recording, view.plan(), &parts)?;
        view.ring.record(
            &mut recording.encoder,
            parts.buffer(&DISPLAYED)?,
            &parts.inputs.statistics,
            &view.timing,
            &recording.frame_timing,
        );
        Ok(recording.finish())
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

    /// Blocks until the oldest frame in flight of `view` has finished, or the part that is on the device
    /// of one under way; returns at once without one.
    pub fn wait_for(&self, view: &View) -> Result<(), RenderError> {
        if let Some(submission) = view.oldest_submission() {
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
