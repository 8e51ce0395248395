//! What the render thread needs of a renderer.
//!
//! Two callers: [`Wgpu`] in service, and a paced fake in the tests, which checks scheduling
//! without a device.

use std::sync::Arc;
use std::time::Duration;

use tyndall_render::{
    AdapterKind, AdapterSummary, Device, DeviceOptions, FailedFrame, FinishedFrame, MemoryBudget,
    PlanLimits, Prepared, RenderError, RenderOutcome, Renderer, View,
};
use tyndall_scene::Scene;
use tyndall_still::{Progress, Step, StillTask};
use tyndall_stream::protocol;

use crate::options::ServeError;

/// Of the frame that nobody sees. Unit: pixel.
const WARM_UP_SIZE: (u32, u32) = (64, 36);

/// A renderer that lives on one thread.
pub trait Backend {
    /// A session's picture.
    type View;
    /// A picture of a job in the making.
    type Still: StillInMaking;

    /// What renders.
    fn adapter(&self) -> protocol::Adapter;
    /// What the planner must respect on this device.
    fn plan_limits(&self) -> PlanLimits;
    /// Gets ready what a picture of `scene` in this size needs, on other threads where that takes
    /// long; asked again until it is. Never blocks. Unit of the size: pixel.
    fn prepare(
        &mut self,
        scene: &Arc<Scene>,
        width: u32,
        height: u32,
    ) -> Result<Prepared, RenderError>;
    /// A picture of `scene`. Unit of the size: pixel.
    fn create_view(
        &mut self,
        scene: Arc<Scene>,
        width: u32,
        height: u32,
    ) -> Result<Self::View, RenderError>;
    /// Shows another scene, or the same one changed.
    fn update_view(&mut self, view: &mut Self::View, scene: Arc<Scene>) -> Result<(), RenderError>;
    /// Changes the size. Unit: pixel.
    fn resize_view(
        &mut self,
        view: &mut Self::View,
        width: u32,
        height: u32,
    ) -> Result<(), RenderError>;
    /// Starts one frame, which [`Backend::take_finished`] gives back under `tag`.
    fn render(&mut self, view: &mut Self::View, tag: u64) -> Result<RenderOutcome, RenderError>;
    /// Renders a frame of `scene` that nobody sees, so that the first one to be seen need not wait for
    /// shaders.
    fn warm_up(&mut self, scene: &Arc<Scene>) -> Result<(), RenderError>;
    /// Goes on with a frame of this view that is submitted in parts, once the device is done with the last
    /// one.
    fn go_on(&mut self, view: &mut Self::View) -> Result<(), RenderError>;
    /// Drops the frame of this view that is submitted in parts, before a change that starts the picture
    /// anew; whether there was one.
    fn abandon(&mut self, view: &mut Self::View) -> bool;
    /// Sets the time that traced samples may take in the next frames; without, what is usual on the device.
    fn trace_within(&mut self, view: &mut Self::View, budget: Option<Duration>);
    /// Looks for finished work without blocking.
    fn poll(&mut self) -> Result<(), RenderError>;
    /// Blocks until the oldest frame in flight of this view is finished, whatever else is on the device.
    fn wait_for(&mut self, view: &Self::View) -> Result<(), RenderError>;
    /// The next frame of this view that has come back; an error is a frame whose picture is lost.
    /// The view is not used any more after an error.
    fn take_finished(
        &mut self,
        view: &mut Self::View,
    ) -> Option<Result<FinishedFrame, FailedFrame>>;
    /// What a frame of this view does, and why.
    fn plan(&self, view: &Self::View) -> protocol::Plan;
    /// Whether rendering more would change nothing.
    fn is_converged(&self, view: &Self::View) -> bool;
    /// A still of `scene`, of which nothing is begun.
    fn new_still(&self, scene: Arc<Scene>) -> Self::Still;
    /// Does one step of a still without waiting, whose traced samples take `budget` at most. While one is on
    /// the device it only looks whether that has ended.
    fn step_still(
        &mut self,
        still: &mut Self::Still,
        budget: Option<Duration>,
    ) -> Result<Step, RenderError>;
    /// Blocks until the step of this still that is on the device has ended.
    fn wait_for_still(&mut self, still: &Self::Still) -> Result<(), RenderError>;
    /// The still as it is, finished or not; `None` before anything of it was begun.
    fn finish_still(
        &mut self,
        still: Self::Still,
    ) -> Result<Option<tyndall_render::Still>, RenderError>;
}

/// What is told of a still while it is made.
pub trait StillInMaking {
    /// Whether a step of it is on the device.
    fn is_on_device(&self) -> bool;
    /// How far it is.
    fn progress(&self) -> Progress;
    /// Its newest frame.
    fn shown(&self) -> Option<&FinishedFrame>;
}

impl StillInMaking for StillTask {
    fn is_on_device(&self) -> bool {
        StillTask::is_on_device(self)
    }

    fn progress(&self) -> Progress {
        StillTask::progress(self)
    }

    fn shown(&self) -> Option<&FinishedFrame> {
        StillTask::shown(self)
    }
}

/// Opens a backend, at start and again after the device was lost.
pub type OpenBackend<B> = Box<dyn FnMut() -> Result<B, ServeError> + Send>;

/// The real renderer.
#[derive(Debug)]
pub struct Wgpu {
    renderer: Renderer,
}

impl Wgpu {
    /// Opens a device and starts a renderer on it.
    ///
    /// # Errors
    /// [`ServeError::Device`] and [`ServeError::Renderer`].
    pub fn open(options: &DeviceOptions, memory: MemoryBudget) -> Result<Self, ServeError> {
        let device = Device::open(options)?;
        let mut renderer = Renderer::new(device)?;
        // Nobody waits for the whole of another's long frame.
        renderer.set_in_parts(true);
        renderer.set_memory_budget(memory);
        Ok(Self { renderer })
    }
}

impl Backend for Wgpu {
    type View = View;
    type Still = StillTask;

    fn adapter(&self) -> protocol::Adapter {
        adapter(self.renderer.adapter())
    }

    fn plan_limits(&self) -> PlanLimits {
        self.renderer.plan_limits()
    }

    fn prepare(
        &mut self,
        scene: &Arc<Scene>,
        width: u32,
        height: u32,
    ) -> Result<Prepared, RenderError> {
        // Pipelines and geometry do not depend on the size.
        let _ = (width, height);
        self.renderer.prepare(scene)
    }

    fn create_view(
        &mut self,
        scene: Arc<Scene>,
        width: u32,
        height: u32,
    ) -> Result<View, RenderError> {
        self.renderer.create_view(scene, width, height)
    }

    fn update_view(&mut self, view: &mut View, scene: Arc<Scene>) -> Result<(), RenderError> {
        self.renderer.update_view(view, scene)
    }

    fn resize_view(&mut self, view: &mut View, width: u32, height: u32) -> Result<(), RenderError> {
        self.renderer.resize_view(view, width, height)
    }

    fn render(&mut self, view: &mut View, tag: u64) -> Result<RenderOutcome, RenderError> {
        self.renderer.render(view, tag)
    }

    fn warm_up(&mut self, scene: &Arc<Scene>) -> Result<(), RenderError> {
        let (width, height) = WARM_UP_SIZE;
        let mut view = self
            .renderer
            .create_view(Arc::clone(scene), width, height)?;
        self.renderer.render(&mut view, 0)?;
        self.renderer.wait()
    }

    fn go_on(&mut self, view: &mut View) -> Result<(), RenderError> {
        self.renderer.go_on(view)
    }

    fn abandon(&mut self, view: &mut View) -> bool {
        self.renderer.abandon(view)
    }

    fn trace_within(&mut self, view: &mut View, budget: Option<Duration>) {
        self.renderer.trace_within(view, budget);
    }

    fn poll(&mut self) -> Result<(), RenderError> {
        self.renderer.poll()
    }

    fn wait_for(&mut self, view: &View) -> Result<(), RenderError> {
        self.renderer.wait_for(view)
    }

    fn take_finished(&mut self, view: &mut View) -> Option<Result<FinishedFrame, FailedFrame>> {
        view.take_finished()
    }

    fn plan(&self, view: &View) -> protocol::Plan {
        plan(view.plan())
    }

    fn is_converged(&self, view: &View) -> bool {
        view.is_converged()
    }

    fn new_still(&self, scene: Arc<Scene>) -> StillTask {
        StillTask::new(scene)
    }

    fn step_still(
        &mut self,
        still: &mut StillTask,
        budget: Option<Duration>,
    ) -> Result<Step, RenderError> {
        still.step(&mut self.renderer, budget)
    }

    fn wait_for_still(&mut self, still: &StillTask) -> Result<(), RenderError> {
        still.wait(&self.renderer)
    }

    fn finish_still(
        &mut self,
        still: StillTask,
    ) -> Result<Option<tyndall_render::Still>, RenderError> {
        still.finish(&mut self.renderer)
    }
}

/// The adapter as the protocol says it.
pub(crate) fn adapter(summary: &AdapterSummary) -> protocol::Adapter {
    protocol::Adapter {
        name: summary.name.clone(),
        driver: summary.driver.clone(),
        kind: match summary.kind {
            AdapterKind::Gpu => protocol::AdapterKind::Gpu,
            AdapterKind::Software => protocol::AdapterKind::Software,
            AdapterKind::Other => protocol::AdapterKind::Other,
        },
    }
}

/// The plan as the protocol says it.
pub(crate) fn plan(plan: &tyndall_render::FramePlan) -> protocol::Plan {
    protocol::Plan {
        passes: plan
            .passes
            .iter()
            .map(|pass| protocol::PlannedPass {
                pass: pass.pass.name().to_owned(),
                variant: pass.variant().to_owned(),
                reason: pass.reason.clone(),
            })
            .collect(),
        skipped: plan
            .skipped
            .iter()
            .map(|pass| protocol::PlannedPass {
                pass: pass.pass.name().to_owned(),
                variant: pass.variant.clone(),
                reason: pass.reason.clone(),
            })
            .collect(),
    }
}
