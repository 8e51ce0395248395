//! One picture being made: a scene, its state on the device, its running mean and its readback ring.

mod places;

use std::sync::Arc;
use std::time::Duration;

use tyndall_scene::{Aabb, CorrectionMode, Geometry, Scene, SceneFacts, ShadowMode};

use crate::correction::{SAFETY, Seen, largest_buffer};
use crate::device::{AdapterKind, Device};
use crate::error::RenderError;
use crate::frame::Share;
use crate::gpu_scene::{GpuAssets, GpuPlacement, Inputs};
use crate::image::{Change, Image, Work};
use crate::plan::{FramePlan, March, PassKind, PlanLimits, plan};
use crate::programs::Bindings;
use crate::readback::{FailedFrame, FinishedFrame, ReadbackRing};
use crate::slices::{Slice, Slices};
use crate::targets::{SharedMarch, TargetNeeds, Targets};
use crate::techniques::shadow_maps::ShadowMaps;
use crate::techniques::single_scattering::LightVolume;
use crate::timing::Timing;

/// A picture being made. Created and driven by a [`Renderer`](crate::Renderer).
#[derive(Debug)]
pub struct View {
    pub(crate) scene: Arc<Scene>,
    pub(crate) facts: SceneFacts,
    pub(crate) plan: FramePlan,
    pub(crate) assets: GpuAssets,
    pub(crate) targets: Targets,
    pub(crate) inputs: Inputs,
    pub(crate) shadows: ShadowMaps,
    pub(crate) light_volume: Option<LightVolume>,
    pub(crate) image: Image,
    /// Pictures since residuals were carried over last.
    pub(crate) turn: u32,
    /// The last picture, whose residuals were carried over.
    pub(crate) last_seen: Option<Seen>,
    /// The picture at present, while its residuals may be carried over.
    pub(crate) seen: Option<Seen>,
    pub(crate) slices: Slices,
    pub(crate) ring: ReadbackRing,
    pub(crate) timing: Timing,
    /// Whether lights, media, instances and shadow transforms must be uploaded again.
    pub(crate) stale: bool,
    limits: PlanLimits,
}

/// What the passes of a frame use of a view.
pub(crate) struct ViewParts<'a> {
    pub assets: &'a GpuAssets,
    pub targets: &'a Targets,
    pub inputs: &'a Inputs,
    pub shadows: &'a mut ShadowMaps,
    pub light_volume: Option<&'a LightVolume>,
}

impl ViewParts<'_> {
    /// Every resource by its name in the shaders; each pass takes those it declares.
    pub fn bind<'a>(&'a self, bindings: &mut Bindings<'a>) {
        let (inputs, targets) = (self.inputs, self.targets);
        bindings
            .buffer("frame", &inputs.frame)
            .buffer("instances", &inputs.instances)
            .buffer("lights", &inputs.lights)
            .buffer("media", &inputs.media)
            .buffer("statistics", &inputs.statistics)
            .buffer("slice", &inputs.slice)
            .buffer("grids", &inputs.grids)
            .buffer("film", &targets.film)
            .buffer("displayed", &targets.displayed);
        if let Some(surfaces) = &targets.surfaces {
            bindings
                .texture("gbuffer_depth", &surfaces.depth)
                .texture("gbuffer_base_color", &surfaces.base_color)
                .texture("gbuffer_normal", &surfaces.normal)
                .texture("surface_radiance", &surfaces.surface_radiance);
            if let Some(emission) = &surfaces.emission {
                bindings.texture("gbuffer_emission", emission);
            }
        }
        if let Some(reference) = &targets.reference {
            bindings
                .buffer("moments", &reference.moments)
                .buffer("even_means", &reference.even_means)
                .buffer("film_albedo", &reference.film_albedo)
                .buffer("film_normal", &reference.film_normal)
                .buffer("tile_sums", &reference.tile_sums);
            for (name, buffer) in &reference.waiting {
                bindings.buffer(name, buffer);
            }
            bindings.buffer("traced_film", reference.film(targets));
        }
        if let Some(correction) = &targets.correction {
            correction.bind(bindings);
        }
        if let Some(radiance) = &targets.in_scattered_radiance {
            bindings
                .texture("in_scattered_radiance", radiance)
                .texture("in_scattered_radiance_written", radiance);
            // Where nothing is shared, what is marched is all of it.
            let marched = targets.shared_march.as_ref();
            let marched = marched.map_or(radiance, |targets| &targets.marched_radiance);
            bindings.texture("marched_radiance", marched);
        }
        if let Some(radiance) = &targets.area_radiance {
            bindings.texture("area_radiance", radiance);
        }
        if let Some(shared) = &targets.shared_march {
            bindings
                .texture("gathered_radiance", shared.restorable())
                .buffer("rejected_pixels", &shared.rejected_pixels);
            if let Some(gathered) = &shared.gathered {
                bindings
                    .texture("gathered_rows", &gathered.rows)
                    .texture("gathered_rows_written", &gathered.rows)
                    .texture("gathered_radiance_written", &gathered.radiance);
            }
        }
        if let Some(volume) = self.light_volume {
            volume.bind(bindings);
        }
        self.assets.bind(bindings);
        self.shadows.bind(bindings);
    }
}

impl View {
    pub(crate) fn new(
        device: &Device,
        scene: Arc<Scene>,
        assets: GpuAssets,
        (width, height): (u32, u32),
        limits: PlanLimits,
    ) -> Result<Self, RenderError> {
        let facts = tyndall_scene::facts(&scene);
        let limits = limits_at(device, limits, (width, height));
        let plan = plan(&facts, &scene.render, &limits);
        need_placement(device, &assets.placement, &plan)?;
        let mut shadows = ShadowMaps::new(device);
        fit_shadows(&mut shadows, device, &scene, &facts, &plan)?;
        Ok(Self {
            targets: Targets::new(device, width, height, needs(&plan, &facts, &scene, limits))?,
            inputs: Inputs::new(device, &scene),
            shadows,
            light_volume: light_volume_for(device, &scene, &plan)?,
            image: Image::new(),
            turn: 0,
            last_seen: None,
            seen: None,
            slices: Slices::new(slice_budget(device)),
            ring: ReadbackRing::new(device, width, height),
            timing: Timing::new(device),
            stale: true,
            scene,
            facts,
            plan,
            assets,
            limits,
        })
    }

    /// Takes a new state of the scene; `assets` are its shared parts on the device. What can fail comes
    /// before anything is taken, so on an error the view is as it was.
    pub(crate) fn update(
        &mut self,
        device: &Device,
        scene: Arc<Scene>,
        assets: GpuAssets,
    ) -> Result<(), RenderError> {
        let change = Change::between(&self.scene, &scene);
        let facts = tyndall_scene::facts(&scene);
        let plan = plan(&facts, &scene.render, &self.limits);
        let (width, height) = self.size();
        let needs = needs(&plan, &facts, &scene, self.limits);
        let targets = if change.geometry || needs != self.targets.needs {
            Some(Targets::new(device, width, height, needs)?)
        } else {
            None
        };
        need_placement(device, &assets.placement, &plan)?;
        fit_shadows(&mut self.shadows, device, &scene, &facts, &plan)?;
        let served = |volume: &LightVolume| volume.serves(&scene);
        if !plan.runs(PassKind::LightVolume) {
            self.light_volume = None;
        } else if !self.light_volume.as_ref().is_some_and(served) {
            self.light_volume = light_volume_for(device, &scene, &plan)?;
        }
        if change.geometry {
            self.shadows.invalidate();
        } else if change.placement {
            self.shadows
                .casters_moved(&moved_bounds(&self.scene.geometry, &scene.geometry));
        }
        if change.geometry || !self.inputs.fits(&scene) {
            self.inputs = Inputs::new(device, &scene);
        }
        if targets.is_some() || !change.is_gradual() {
            self.seen = None;
            self.turn = 0;
        } else {
            self.turn += u32::from(change.restarts());
        }
        if let Some(seen) = &mut self.seen {
            seen.changed |= change.beyond_camera();
        }
        if let Some(targets) = targets {
            self.targets = targets;
        }
        self.scene = scene;
        self.facts = facts;
        self.plan = plan;
        self.assets = assets;
        self.stale |= change.restarts();
        self.image.apply(change);
        if change.restarts() {
            self.slices.restart();
        }
        Ok(())
    }

    pub(crate) fn resize(
        &mut self,
        device: &Device,
        width: u32,
        height: u32,
    ) -> Result<(), RenderError> {
        if (width, height) == (self.targets.width, self.targets.height) {
            return Ok(());
        }
        let limits = limits_at(device, self.limits, (width, height));
        let plan = plan(&self.facts, &self.scene.render, &limits);
        need_placement(device, &self.assets.placement, &plan)?;
        let needs = needs(&plan, &self.facts, &self.scene, limits);
        self.targets = Targets::new(device, width, height, needs)?;
        (self.limits, self.plan) = (limits, plan);
        self.ring = ReadbackRing::new(device, width, height);
        self.seen = None;
        self.turn = 0;
        self.image.restart();
        self.slices.restart();
        Ok(())
    }

    /// What the next frame does of the plan.
    pub(crate) fn share(&self, work: Work) -> Share {
        let stop = self.scene.render.stop;
        let corrected = self.plan.runs(PassKind::Correction);
        // At rest only: the first frame after a change does not wait for paths.
        let moving = corrected && self.image.is_new();
        let later = moving && self.scene.render.correction == CorrectionMode::AtRest;
        let traces = self.plan.runs(PassKind::Reference) && !later;
        let slice = (work == Work::Sample && traces).then(|| self.next_slice(corrected));
        let samples = self.image.samples() + slice.map_or(0, Slice::completed_samples);
        // Of the first sample its part counts, too: many frames may pass before it is whole.
        let part = slice.map_or(0.0, |slice| slice.part(self.size().1));
        let done = samples as f32 + if samples == 0 { part } else { 0.0 };
        Share {
            base: !corrected || self.image.wants_base(stop),
            place: self.place_index(),
            slice,
            done,
            estimated: match work {
                Work::Sample => !corrected || self.image.wants_estimate(done, stop),
                Work::Redisplay => corrected && self.image.is_behind(),
                Work::Nothing | Work::Wait => false,
            },
            restarts: corrected && self.image.is_new(),
        }
    }

    fn next_slice(&self, corrected: bool) -> Slice {
        let done = self.image.samples();
        let most = self.image.most_samples(self.scene.render.stop);
        let thinned = (corrected && self.image.is_new())
            .then(|| self.slices.thinned(self.size(), self.turn))
            .flatten();
        let slice = thinned.unwrap_or_else(|| self.slices.next(self.size(), done, most));
        Slice {
            shares_places: self.shares_places(),
            cleared: corrected,
            ..slice
        }
    }

    /// Tells the correction what of the last picture it may use.
    pub(crate) fn look_back(&mut self, device: &Device, share: Share) {
        let Some(correction) = &mut self.targets.correction else {
            return;
        };
        if share.restarts {
            self.last_seen = self.seen.take();
        }
        if share.estimated {
            let last = self.last_seen.as_ref();
            let base_samples = self.image.base_samples() + u32::from(share.base);
            let samples = (self.image.samples(), base_samples);
            correction.look_back(device, last, &self.scene.camera, samples);
        }
    }

    /// Whether the technique has a mean of its own beside the traced one.
    pub(crate) fn has_base(&self) -> bool {
        self.plan.runs(PassKind::Correction) && self.plan.runs(PassKind::Film)
    }

    /// How often a frame with this share sums the transmittance.
    pub(crate) fn transmittance_sums(&self, share: Share) -> u32 {
        let filmed = share.base && self.plan.runs(PassKind::Film);
        let estimated = share.estimated && self.plan.runs(PassKind::Estimate);
        u32::from(filmed) + u32::from(estimated)
    }

    pub(crate) fn limits(&self) -> PlanLimits {
        self.limits
    }

    /// Why each pass runs or doesn't.
    pub fn plan(&self) -> &FramePlan {
        &self.plan
    }

    /// The facts the plan follows from.
    pub fn facts(&self) -> &SceneFacts {
        &self.facts
    }

    /// The scene's present state.
    pub fn scene(&self) -> &Arc<Scene> {
        &self.scene
    }

    /// Width and height. Unit: pixel.
    pub fn size(&self) -> (u32, u32) {
        (self.targets.width, self.targets.height)
    }

    /// Samples in the running mean, those in flight included.
    pub fn samples(&self) -> u32 {
        self.image.samples()
    }

    /// Whether the stop rule is met: nothing is rendered until something changes.
    pub fn is_converged(&self) -> bool {
        self.image.is_finished(self.scene.render.stop) && !self.image.is_behind()
    }

    /// Frames submitted and not yet taken.
    pub fn in_flight(&self) -> usize {
        self.ring.in_flight()
    }

    /// The oldest finished frame, if one has arrived; call [`Renderer::poll`](crate::Renderer::poll) first.
    /// After an error the picture's own record of what it shows is no longer right: make another view.
    pub fn take_finished(&mut self) -> Option<Result<FinishedFrame, FailedFrame>> {
        let (mut frame, sweep) = match self.ring.take(&self.timing)? {
            Ok(taken) => taken,
            Err(failed) => return Some(Err(failed)),
        };
        let traced = frame.pass_times.iter().find(|t| t.name == "reference");
        let seconds = traced.map_or(f64::from(frame.render_micros), |t| f64::from(t.micros)) * 1e-6;
        self.slices.measured(frame.units, seconds);
        if let Some(error) = frame.stats.estimated_error {
            let corrected = self.plan.runs(PassKind::Correction);
            let error = if corrected { SAFETY * error } else { error };
            self.image.note_error(frame.epoch, frame.samples, error);
        }
        if let Some(sweep) = sweep {
            self.image
                .note_sweep(frame.epoch, sweep, frame.stats.unfinished);
        }
        // Some pictures are known to be finished only when their last frame has come home.
        let last = self.in_flight() == 0 && frame.epoch == self.image.epoch();
        frame.converged |= last && self.is_converged();
        Some(Ok(frame))
    }

    /// Longest dispatch of the reference; 8 ms on a GPU, 60 ms on a software driver without this.
    pub fn set_slice_budget(&mut self, budget: Duration) {
        self.slices.set_budget(budget);
    }

    /// How visibility toward lights is found at present.
    pub fn shadow_mode(&self) -> ShadowMode {
        if self.plan.runs(PassKind::ShadowMaps) {
            ShadowMode::Mapped
        } else if self.plan.shades_traced() || self.plan.runs(PassKind::Reference) {
            ShadowMode::Traced
        } else {
            ShadowMode::Off
        }
    }
}

/// What the planner must respect at this size.
fn limits_at(device: &Device, limits: PlanLimits, (width, height): (u32, u32)) -> PlanLimits {
    let most = device.device.limits().max_storage_buffer_binding_size;
    PlanLimits {
        beyond_correction: largest_buffer(width, height) > most,
        ..limits
    }
}

/// Longest dispatch of the reference that leaves a picture responsive.
fn slice_budget(device: &Device) -> Duration {
    match device.summary().kind {
        AdapterKind::Gpu => Duration::from_millis(8),
        AdapterKind::Software | AdapterKind::Other => Duration::from_millis(60),
    }
}

/// Builds what the plan asks rays about.
fn need_placement(
    device: &Device,
    placement: &GpuPlacement,
    plan: &FramePlan,
) -> Result<(), RenderError> {
    let paths = plan.runs(PassKind::Reference) || plan.runs(PassKind::AreaLights);
    if paths && plan.runs(PassKind::Bvh) {
        placement.need_triangles(device)
    } else if plan.runs(PassKind::Bvh) {
        placement.need_bvh(device)
    } else {
        Ok(())
    }
}

/// The volume of the grids' depths toward the lights, if the plan looks it up.
fn light_volume_for(
    device: &Device,
    scene: &Scene,
    plan: &FramePlan,
) -> Result<Option<LightVolume>, RenderError> {
    if plan.runs(PassKind::LightVolume) {
        LightVolume::new(device, scene)
    } else {
        Ok(None)
    }
}

/// Fits the depth maps to what the plan looks up in them.
fn fit_shadows(
    shadows: &mut ShadowMaps,
    device: &Device,
    scene: &Scene,
    facts: &SceneFacts,
    plan: &FramePlan,
) -> Result<(), RenderError> {
    let casters = facts
        .swept_bounds
        .filter(|_| plan.runs(PassKind::ShadowMaps));
    let resolution = scene.render.shadows.resolution;
    shadows.update(device, &scene.lights, casters, resolution)
}

/// Boxes around every instance that stands elsewhere, where it was and where it is. Unit: m.
fn moved_bounds(old: &Geometry, new: &Geometry) -> Vec<Aabb> {
    old.instances
        .iter()
        .zip(&new.instances)
        .filter(|(old, new)| old.world_from_object != new.world_from_object)
        .flat_map(|(was, is)| [old.instance_bounds(was), new.instance_bounds(is)])
        .flatten()
        .collect()
}

fn needs(plan: &FramePlan, facts: &SceneFacts, scene: &Scene, limits: PlanLimits) -> TargetNeeds {
    let march = March::of(facts, &scene.render, limits);
    TargetNeeds {
        surfaces: plan.runs(PassKind::Shade),
        emission: plan
            .variant(PassKind::Shade)
            .is_some_and(|variant| variant.contains("+emissive")),
        in_scatter: plan.runs(PassKind::SingleScattering),
        area: plan.runs(PassKind::AreaLights),
        shared_march: plan.runs(PassKind::Gather).then_some(SharedMarch {
            interleaved: march.interleave > 1,
            spacing: march.spacing,
        }),
        reference: plan.runs(PassKind::Reference),
        correction: plan.runs(PassKind::Correction),
        history: plan
            .variant(PassKind::Correction)
            .is_some_and(|variant| variant.contains("+history")),
    }
}
