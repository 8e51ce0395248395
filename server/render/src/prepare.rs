//! Makes what a scene needs on the device before a view takes it, on another thread: geometry, grids,
//! BVH and pipelines. The thread that renders goes on with other views meanwhile.

use std::sync::mpsc::{Receiver, TryRecvError, sync_channel};
use std::sync::{Arc, Weak};

use tyndall_scene::{ChangeSet, Scene};

use crate::engine::{Constants, Device, Pipelines};
use crate::error::RenderError;
use crate::frame::{FramePlan, PipelineList, PlanLimits, Traces};
use crate::gpu_scene::{AssetCache, GpuAssets};
use crate::plan::plan;
use crate::view::{constants, need_geometry};

/// Scenes that are prepared at the same time, and that wait for a view to take them.
const MOST_JOBS: usize = 4;

/// Scenes that are remembered as ready, about one a session.
const MOST_READY: usize = 16;

/// Whether a view can take a scene at once.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Prepared {
    /// Everything is there, or an error that making the view will tell.
    Ready,
    /// It is being made: ask again.
    Pending,
}

/// What scenes need and share.
#[derive(Debug, Clone)]
pub(crate) struct Shared {
    pub device: Arc<Device>,
    pub pipelines: Arc<Pipelines>,
    pub assets: Arc<AssetCache>,
}

/// Scenes that are being prepared, or are and wait to be taken.
#[derive(Debug, Default)]
pub(crate) struct Preparations {
    jobs: Vec<Job>,
    /// Scenes that had everything when they were asked about last.
    ready: Vec<Weak<Scene>>,
}

#[derive(Debug)]
struct Job {
    scene: Arc<Scene>,
    state: State,
}

#[derive(Debug)]
enum State {
    Running(Receiver<Option<GpuAssets>>),
    /// Holds what was made until a view does.
    Done(#[allow(dead_code, reason = "keeps it from being dropped")] Option<GpuAssets>),
}

impl Preparations {
    /// Sees to it that `scene` gets what it needs.
    pub fn ask(&mut self, shared: &Shared, scene: &Arc<Scene>, limits: PlanLimits) -> Prepared {
        self.collect();
        if let Some(job) = self.jobs.iter().find(|job| Arc::ptr_eq(&job.scene, scene)) {
            return match job.state {
                State::Running(_) => Prepared::Pending,
                State::Done(_) => Prepared::Ready,
            };
        }
        if self.is_seen_anew(scene) {
            return Prepared::Ready;
        }
        let Ok(plan) = plan(&tyndall_scene::facts(scene), &scene.render, &limits) else {
            return Prepared::Ready;
        };
        if shared.has(scene, &plan) {
            self.ready.retain(|known| known.strong_count() > 0);
            self.ready.truncate(MOST_READY - 1);
            self.ready.insert(0, Arc::downgrade(scene));
            return Prepared::Ready;
        }
        self.make_room();
        if self.jobs.len() >= MOST_JOBS {
            return Prepared::Pending;
        }
        match start(shared.clone(), Arc::clone(scene), plan) {
            Some(receiver) => {
                self.jobs.push(Job {
                    scene: Arc::clone(scene),
                    state: State::Running(receiver),
                });
                Prepared::Pending
            }
            // Without another thread the view makes it all itself.
            None => Prepared::Ready,
        }
    }

    /// Whether a scene is one that was ready, seen from elsewhere: it needs nothing more.
    fn is_seen_anew(&mut self, scene: &Arc<Scene>) -> bool {
        let alike = ChangeSet::CAMERA | ChangeSet::DISPLAY | ChangeSet::STOP;
        let found = self.ready.iter_mut().find(|known| {
            let known = known.upgrade();
            known.is_some_and(|known| alike.contains(ChangeSet::between(&known, scene)))
        });
        if let Some(known) = found {
            *known = Arc::downgrade(scene);
            true
        } else {
            false
        }
    }

    /// A view has taken `scene`: it holds what was made.
    pub fn taken(&mut self, scene: &Arc<Scene>) {
        self.jobs.retain(|job| !Arc::ptr_eq(&job.scene, scene));
    }

    fn collect(&mut self) {
        for job in &mut self.jobs {
            if let State::Running(receiver) = &job.state {
                match receiver.try_recv() {
                    Ok(assets) => job.state = State::Done(assets),
                    Err(TryRecvError::Disconnected) => job.state = State::Done(None),
                    Err(TryRecvError::Empty) => {}
                }
            }
        }
    }

    /// Drops what nobody took, the oldest first.
    fn make_room(&mut self) {
        while self.jobs.len() >= MOST_JOBS
            && let Some(done) = self
                .jobs
                .iter()
                .position(|job| matches!(job.state, State::Done(_)))
        {
            self.jobs.remove(done);
        }
    }
}

impl Shared {
    /// Whether nothing of it is left to make.
    fn has(&self, scene: &Scene, plan: &FramePlan) -> bool {
        let Some(assets) = self.assets.known(scene) else {
            return false;
        };
        let traced = plan.passes.iter().map(|pass| pass.traces).max();
        let has_geometry = match traced {
            None | Some(Traces::Nothing) => true,
            Some(Traces::Rays) => assets.placement.has(false),
            Some(Traces::Triangles) => assets.placement.has(true),
        };
        let constants = scene_constants(scene, &assets);
        has_geometry
            && pipelines(plan, &constants).all(|(constants, list)| {
                let compute = |name: &String| self.pipelines.has_compute(name, &constants);
                list.compute.iter().all(compute)
                    && list
                        .raster
                        .iter()
                        .all(|(name, state)| self.pipelines.has_raster(name, state))
            })
    }

    /// Makes all of it.
    fn make(&self, scene: &Scene, plan: &FramePlan) -> Result<GpuAssets, RenderError> {
        let assets = self.assets.assets(&self.device, scene)?;
        need_geometry(&self.device, &assets.placement, plan)?;
        let constants = scene_constants(scene, &assets);
        for (constants, list) in pipelines(plan, &constants) {
            for name in &list.compute {
                self.pipelines.compute(&self.device, name, &constants)?;
            }
            for (name, state) in &list.raster {
                self.pipelines.raster(&self.device, name, state)?;
            }
        }
        Ok(assets)
    }
}

fn scene_constants(scene: &Scene, assets: &GpuAssets) -> Constants {
    let emitter_count = assets.placement.emitter_count();
    constants(scene, &tyndall_scene::facts(scene), emitter_count)
}

/// The pipelines of every pass, and the constants they are built for.
fn pipelines(
    plan: &FramePlan,
    constants: &Constants,
) -> impl Iterator<Item = (Constants, PipelineList)> {
    plan.passes.iter().map(|planned| {
        let mut list = PipelineList::default();
        planned.recorder.pipelines(planned, &mut list);
        (constants.with(&planned.constants), list)
    })
}

/// Makes it all on a thread of its own, which ends with it.
fn start(
    shared: Shared,
    scene: Arc<Scene>,
    plan: FramePlan,
) -> Option<Receiver<Option<GpuAssets>>> {
    let (sender, receiver) = sync_channel(1);
    let make = move || {
        // What the driver refuses here belongs to no frame: the view that takes the scene meets it again.
        let device = &shared.device.device;
        let invalid = device.push_error_scope(wgpu::ErrorFilter::Validation);
        let out_of_memory = device.push_error_scope(wgpu::ErrorFilter::OutOfMemory);
        let made = shared.make(&scene, &plan);
        for scope in [out_of_memory, invalid] {
            if let Some(error) = pollster::block_on(scope.pop()) {
                tracing::debug!(%error, "preparing a scene");
            }
        }
        // Nobody may wait for it any more.
        drop(sender.send(made.ok()));
    };
    let thread = std::thread::Builder::new().name("prepare".to_owned());
    thread.spawn(make).ok().map(|_handle| receiver)
}

#[cfg(test)]
mod tests {
    use tyndall_scene::{CorrectionMode, ShadowMode, Technique, presets};

    use super::*;

    #[test]
    fn every_shader_of_a_plan_is_listed_and_given_every_constant_that_it_declares() {
        for preset in presets::names() {
            let description = presets::description(preset.name).expect("a preset");
            let mut scene = tyndall_scene::build(description, None)
                .expect("valid")
                .scene;
            for technique in [Technique::SingleScattering, Technique::Reference] {
                for (correction, shadows) in [
                    (CorrectionMode::Off, ShadowMode::Traced),
                    (CorrectionMode::Always, ShadowMode::Mapped),
                ] {
                    scene.render.technique = technique;
                    scene.render.correction = correction;
                    scene.render.shadows.mode = shadows;
                    scene.render.single_scattering.interleave = 4;
                    scene.render.single_scattering.half_resolution = true;
                    check(&scene);
                }
            }
        }
    }

    fn check(scene: &Scene) {
        let facts = tyndall_scene::facts(scene);
        let plan = plan(&facts, &scene.render, &PlanLimits::default()).expect("rendered");
        for (constants, list) in pipelines(&plan, &constants(scene, &facts, 1)) {
            for name in &list.compute {
                let shader = tyndall_shaders::shader(name);
                let shader = shader.unwrap_or_else(|| panic!("{name} is in no list"));
                let missing = constants.missing(shader);
                assert!(
                    missing.is_empty(),
                    "{}: {name} lacks {missing:?}",
                    scene.name
                );
            }
            for (name, _) in &list.raster {
                assert!(
                    tyndall_shaders::shader(name).is_some(),
                    "{name} is in no list"
                );
            }
        }
    }
}
