//! One picture being made: a scene, its state on the device, its running mean and its readback ring.

mod places;
mod scene_state;
mod under_way;

use std::sync::Arc;
use std::time::{Duration, Instant};

use glam::DVec3;
use tyndall_scene::{ChangeSet, CorrectionMode, Scene, SceneFacts, ShadowMode};

use crate::correction::{self, Correction, SAFETY, Seen, largest_buffer};
use crate::engine::{
    AdapterKind, Device, FinishedFrame, FrameMeta, Pool, ReadbackRing, Recorded, Timing,
    statistics_scale,
};
use crate::error::{FailedFrame, RenderError};
use crate::frame::{FramePlan, Parts, PlanLimits};
use crate::gpu_scene::{GpuAssets, SampleValues, pixel_ray};
use crate::picture::{Accumulation, Share, Slice, Slices, Work, pixel_offset};
use crate::stages::shadow_maps::ShadowMaps;
use crate::stages::{estimate, film};
use crate::techniques::reference::paths;
use scene_state::Maker;
pub(crate) use scene_state::{SceneState, constants, need_geometry};
use under_way::UnderWay;

/// Surfaces beyond are not found under a place of the picture. Unit: m.
const MOST_DISTANCE: f32 = 1e30;

/// A picture being made. Created and driven by a [`Renderer`](crate::Renderer).
#[derive(Debug)]
pub struct View {
    pub(crate) state: SceneState,
    pub(crate) accumulation: Accumulation,
    /// Pictures since residuals were carried over last.
    restart: u32,
    /// The last picture, whose residuals were carried over.
    last_seen: Option<Seen>,
    /// The picture at present, while its residuals may be carried over.
    seen: Option<Seen>,
    pub(crate) slices: Slices,
    pub(crate) ring: ReadbackRing,
    pub(crate) timing: Timing,
    /// What changed since the state was uploaded.
    unsent: ChangeSet,
    /// The frame of which parts are not submitted yet.
    under_way: Option<UnderWay>,
    limits: PlanLimits,
}

impl View {
    pub(crate) fn new(
        device: &Device,
        pool: &mut Pool,
        scene: Arc<Scene>,
        assets: GpuAssets,
        size: [u32; 2],
        limits: PlanLimits,
    ) -> Result<Self, RenderError> {
        let limits = limits_at(device, limits, size);
        let mut maker = Maker {
            device,
            pool,
            limits,
            size,
        };
        Ok(Self {
            state: maker.state(scene, assets, None, ChangeSet::all())?,
            accumulation: Accumulation::new(),
            restart: 0,
            last_seen: None,
            seen: None,
            slices: Slices::new(slice_budget(device)),
            ring: ReadbackRing::new(device, size[0], size[1]),
            timing: Timing::new(device),
            unsent: ChangeSet::all(),
            under_way: None,
            limits,
        })
    }

    /// Takes a new state of the scene; `assets` are its shared parts on the device. On an error the view
    /// is as it was.
    pub(crate) fn update(
        &mut self,
        device: &Device,
        pool: &mut Pool,
        scene: Arc<Scene>,
        assets: GpuAssets,
    ) -> Result<(), RenderError> {
        let changed = ChangeSet::between(&self.state.scene, &scene);
        if changed.restarts() {
            self.abandon();
        } else {
            self.submit_rest(device)?;
        }
        let mut maker = Maker {
            device,
            pool,
            limits: self.limits,
            size: self.state.resources.size,
        };
        let state = maker.state(scene, assets, Some(&self.state), changed)?;
        let others = ChangeSet::SURFACES | ChangeSet::SETTINGS;
        let gradual = !changed.intersects(others) && state.resources.same_as(&self.state.resources);
        if gradual {
            self.restart += u32::from(changed.restarts());
        } else {
            self.forget_seen();
        }
        if let Some(seen) = &mut self.seen {
            seen.changed |= changed.beyond_camera();
        }
        self.unsent |= if state.inputs.same_as(&self.state.inputs) {
            changed
        } else {
            ChangeSet::all()
        };
        self.state = state;
        self.accumulation.apply(changed);
        if changed.restarts() {
            self.slices.restart();
        }
        Ok(())
    }

    pub(crate) fn resize(
        &mut self,
        device: &Device,
        pool: &mut Pool,
        size: [u32; 2],
    ) -> Result<(), RenderError> {
        if size == self.state.resources.size {
            return Ok(());
        }
        self.abandon();
        let limits = limits_at(device, self.limits, size);
        let mut maker = Maker {
            device,
            pool,
            limits,
            size,
        };
        let (scene, assets) = (Arc::clone(&self.state.scene), self.state.assets.clone());
        self.state = maker.state(scene, assets, Some(&self.state), ChangeSet::empty())?;
        self.limits = limits;
        self.ring = ReadbackRing::new(device, size[0], size[1]);
        // What was seen is carried over in its own size.
        self.restart += 1;
        self.unsent = ChangeSet::all();
        self.accumulation.restart();
        self.slices.restart();
        Ok(())
    }

    fn forget_seen(&mut self) {
        self.seen = None;
        self.restart = 0;
    }

    /// What the next frame does of the plan.
    pub(crate) fn share(&self, work: Work) -> Share {
        let stop = self.state.scene.render.stop;
        let corrected = self.is_corrected();
        // At rest only: the first frame after a change does not wait for paths.
        let moving = corrected && self.accumulation.is_new();
        let later = moving && self.state.scene.render.correction == CorrectionMode::AtRest;
        let traces = self.state.plan.runs(paths::PASS) && !later;
        let slice = (work == Work::Sample && traces).then(|| self.next_slice(corrected));
        let samples = self.accumulation.samples() + slice.map_or(0, Slice::completed_samples);
        // Of the first sample its part counts, too: many frames may pass before it is whole.
        let part = slice.map_or(0.0, Slice::part);
        let done = samples as f32 + if samples == 0 { part } else { 0.0 };
        Share {
            adds: work == Work::Sample,
            base: !corrected || self.accumulation.wants_base(stop),
            place: self.place_index(),
            slice,
            done,
            estimated: match work {
                Work::Sample => !corrected || self.accumulation.wants_estimate(done, stop),
                Work::Redisplay => corrected && self.accumulation.is_behind(),
                Work::Nothing | Work::Wait => false,
            },
            restarts: corrected && self.accumulation.is_new(),
        }
    }

    /// Uploads what the frame reads, and turns what is carried over to the last picture where this one is
    /// new.
    pub(crate) fn prepare_frame(&mut self, device: &Device, share: Share) {
        self.state.upload(device, self.unsent);
        if share.restarts {
            self.state.resources.swap(device);
        }
        self.look_back(device, share);
        if let Some(slice) = share.slice {
            self.state.inputs.upload_slice(device, slice.values());
        }
        let sample = SampleValues {
            pixel_offset: pixel_offset(share.place),
            sample_index: share.place,
            accumulated: self.accumulation.base_samples() + 1,
            restart: self.restart,
        };
        self.state.inputs.upload_frame(
            device,
            &self.state.scene,
            &self.state.facts,
            self.state.assets.placement.anchor,
            self.size(),
            sample,
        );
    }

    /// Takes a frame that was recorded, and submits its first part; all of it where it is not cut.
    pub(crate) fn begin(
        &mut self,
        device: &Device,
        tag: u64,
        started: Instant,
        what: (Work, Share),
        recorded: Recorded,
    ) -> Result<(), RenderError> {
        self.under_way = Some(UnderWay::new(tag, started, what, recorded));
        self.go_on(device)
    }

    /// Submits the next part of the frame under way, once the device is done with the one before.
    pub(crate) fn go_on(&mut self, device: &Device) -> Result<(), RenderError> {
        if let Some(frame) = &mut self.under_way
            && let Some(submission) = frame.go_on(device)
        {
            self.submitted(submission);
        }
        device.check()
    }

    /// Submits what is left of the frame under way.
    fn submit_rest(&mut self, device: &Device) -> Result<(), RenderError> {
        if let Some(frame) = &mut self.under_way {
            let submission = frame.submit_all(device)?;
            self.submitted(submission);
        }
        Ok(())
    }

    /// Whether parts of a frame are not submitted yet.
    pub fn is_under_way(&self) -> bool {
        self.under_way.is_some()
    }

    /// Drops the frame of which parts are not submitted yet, as if it had never begun; whether there was
    /// one. What a picture gained in it is lost: for pictures that start anew.
    pub(crate) fn abandon(&mut self) -> bool {
        let Some(frame) = self.under_way.take() else {
            return false;
        };
        self.state.kept.settle(false);
        if frame.share.restarts {
            self.state.resources.swap_back();
            self.seen = self.last_seen.take();
        }
        true
    }

    /// Counts a frame whose last part was submitted.
    fn submitted(&mut self, submission: wgpu::SubmissionIndex) {
        let Some(frame) = self.under_way.take() else {
            return;
        };
        let (work, share) = (frame.work, frame.share);
        self.settle(true, share);
        let (width, height) = self.size();
        let sweep = share.slice.map(|slice| self.slices.advance(slice));
        let added = share.slice.map_or(1, Slice::completed_samples);
        let base = self.has_base().then_some(share.base);
        let estimated = share.estimated.then_some(share.done);
        self.accumulation.advance(work, added, base, estimated);
        if let Some(sweep) = sweep {
            self.accumulation.await_sweep(sweep);
        }
        let shadows = self.state.kept.get::<ShadowMaps>();
        let meta = FrameMeta {
            tag: frame.tag,
            samples: self.accumulation.samples(),
            converged: self.is_converged(),
            epoch: self.accumulation.epoch(),
            started: frame.started,
            statistics_scale: statistics_scale(width, height),
            filmed: work == Work::Sample,
            transmittances: self.transmittance_sums(share),
            estimated: self.estimates(share),
            units: share.slice.map_or(0, |slice| slice.units(width)),
            shadow_layers: shadows.map_or(0, ShadowMaps::take_rendered),
            sweep,
        };
        self.ring.submit(meta, frame.timing, submission);
    }

    /// The oldest work of this view on the device.
    pub(crate) fn oldest_submission(&self) -> Option<wgpu::SubmissionIndex> {
        let part = || self.under_way.as_ref()?.submission();
        self.ring.oldest_submission().or_else(part)
    }

    /// What the passes of a frame use.
    pub(crate) fn parts(&self, share: Share) -> Parts<'_> {
        Parts {
            assets: &self.state.assets,
            inputs: &self.state.inputs,
            resources: &self.state.resources,
            kept: &self.state.kept,
            constants: &self.state.constants,
            share,
        }
    }

    /// Hears that the frame that was recorded last was submitted, or dropped.
    pub(crate) fn settle(&mut self, submitted: bool, share: Share) {
        self.state.kept.settle(submitted);
        if !submitted {
            // What was carried over is at its turn, and nothing took its place.
            self.forget_seen();
            return;
        }
        self.unsent = ChangeSet::empty();
        if share.estimated {
            self.seen = Some(Seen {
                camera: self.state.scene.camera,
                size: self.state.resources.size,
                changed: false,
            });
        }
    }

    /// Tells the correction what of the last picture it may use.
    fn look_back(&mut self, device: &Device, share: Share) {
        let Some(correction) = self.state.kept.get::<Correction>() else {
            return;
        };
        if share.restarts {
            self.last_seen = self.seen.take();
        }
        if share.estimated {
            let last = self.last_seen.as_ref();
            let base_samples = self.accumulation.base_samples() + u32::from(share.base);
            let samples = (self.accumulation.samples(), base_samples);
            correction.look_back(device, last, &self.state.scene.camera, samples);
        }
    }

    fn is_corrected(&self) -> bool {
        self.state.plan.runs(correction::PASS)
    }

    /// Whether the technique has a mean of its own beside the traced one.
    pub(crate) fn has_base(&self) -> bool {
        self.is_corrected() && self.state.plan.runs(film::PASS)
    }

    /// Whether a frame with this share estimates the error.
    pub(crate) fn estimates(&self, share: Share) -> bool {
        share.estimated && self.state.plan.runs(estimate::PASS)
    }

    /// How often a frame with this share sums the transmittance.
    pub(crate) fn transmittance_sums(&self, share: Share) -> u32 {
        let filmed = share.base && self.state.plan.runs(film::PASS);
        u32::from(filmed) + u32::from(self.estimates(share))
    }

    /// Why each pass runs or doesn't.
    pub fn plan(&self) -> &FramePlan {
        &self.state.plan
    }

    /// The facts the plan follows from.
    pub fn facts(&self) -> &SceneFacts {
        &self.state.facts
    }

    /// The scene's present state.
    pub fn scene(&self) -> &Arc<Scene> {
        &self.state.scene
    }

    /// Width and height. Unit: pixel.
    pub fn size(&self) -> (u32, u32) {
        self.state.resources.size.into()
    }

    /// Memory that its passes keep and exchange, some of it together with other views. Unit: byte.
    pub fn device_bytes(&self) -> u64 {
        self.state.resources.bytes()
    }

    /// The point of a surface that is seen at a place of the picture, in the world, if a surface is; found
    /// on the CPU, which builds the BVH at the first call. Unit: m; of the place: pixel, from the left
    /// upper corner.
    pub fn surface_at(&self, place: [f64; 2]) -> Result<Option<DVec3>, RenderError> {
        let camera = &self.state.scene.camera;
        let placement = &self.state.assets.placement;
        let direction = pixel_ray(camera, self.size(), place);
        let origin = (camera.position - placement.anchor).as_vec3a();
        let bvh = placement.cpu_bvh()?;
        let hit = bvh.closest(origin, direction.as_vec3a(), MOST_DISTANCE);
        Ok(hit.map(|hit| camera.position + direction * f64::from(hit.distance)))
    }

    /// Samples in the running mean, those in flight included.
    pub fn samples(&self) -> u32 {
        self.accumulation.samples()
    }

    /// Whether the stop rule is met: nothing is rendered until something changes.
    pub fn is_converged(&self) -> bool {
        self.accumulation.is_finished(self.state.scene.render.stop)
            && !self.accumulation.is_behind()
    }

    /// Frames begun and not yet taken.
    pub fn in_flight(&self) -> usize {
        self.ring.in_flight() + usize::from(self.is_under_way())
    }

    /// The oldest finished frame, if one has arrived; call [`Renderer::poll`](crate::Renderer::poll) first.
    /// After an error the picture's own record of what it shows is no longer right: make another view.
    pub fn take_finished(&mut self) -> Option<Result<FinishedFrame, FailedFrame>> {
        let (mut frame, sweep) = match self.ring.take(&self.timing)? {
            Ok(taken) => taken,
            Err(failed) => return Some(Err(failed)),
        };
        let traced = frame
            .pass_times
            .iter()
            .find(|t| t.name == paths::PASS.name());
        let seconds = traced.map_or(f64::from(frame.render_micros), |t| f64::from(t.micros)) * 1e-6;
        self.slices.measured(frame.units, seconds);
        if let Some(error) = frame.stats.estimated_error {
            let corrected = self.is_corrected();
            let error = if corrected { SAFETY * error } else { error };
            self.accumulation
                .note_error(frame.epoch, frame.samples, error);
        }
        if let Some(sweep) = sweep {
            self.accumulation
                .note_sweep(frame.epoch, sweep, frame.stats.unfinished);
        }
        // Some pictures are known to be finished only when their last frame has come home.
        let last = self.in_flight() == 0 && frame.epoch == self.accumulation.epoch();
        frame.converged |= last && self.is_converged();
        Some(Ok(frame))
    }

    /// Longest dispatch of the reference; 8 ms on a GPU, 60 ms on a software driver without this.
    pub fn set_slice_budget(&mut self, budget: Duration) {
        self.slices.set_budget(budget);
    }

    /// How visibility toward lights is found at present.
    pub fn shadow_mode(&self) -> ShadowMode {
        self.state.shadow_mode()
    }
}

/// What the planner must respect at this size.
fn limits_at(device: &Device, limits: PlanLimits, size: [u32; 2]) -> PlanLimits {
    let most = device.device.limits().max_storage_buffer_binding_size;
    PlanLimits {
        beyond_correction: largest_buffer(size) > most,
        ..limits
    }
}

/// Longest dispatch of the reference that leaves a picture responsive.
pub(crate) fn slice_budget(device: &Device) -> Duration {
    match device.summary().kind {
        AdapterKind::Gpu => Duration::from_millis(8),
        AdapterKind::Software | AdapterKind::Other => Duration::from_millis(60),
    }
}
