//! A scene's state on the device, as one view shows it.
//!
//! Another state is made beside the one in use and takes over what still holds of it; what fails leaves
//! the old one as it was.

use std::sync::Arc;

use tyndall_scene::{ChangeSet, Light, Medium, MediumShape, Scene, SceneFacts, ShadowMode};

use crate::engine::{
    Access, Constants, Device, Pool, SHORT, ViewResources, check_size, most_frame_iterations,
    most_iterations,
};
use crate::error::RenderError;
use crate::frame::{FramePlan, KeptKind, KeptStates, PlanLimits, PlannedPass, Preparation, Traces};
use crate::gpu_scene::{GpuAssets, GpuPlacement, Inputs};
use crate::plan::plan;
use crate::stages::shadow_maps::{self, ShadowMaps};
use crate::techniques::reference::paths;

/// A scene's state on the device.
#[derive(Debug)]
pub(crate) struct SceneState {
    pub scene: Arc<Scene>,
    pub facts: SceneFacts,
    pub plan: FramePlan,
    pub assets: GpuAssets,
    pub inputs: Inputs,
    pub resources: ViewResources,
    pub kept: KeptStates,
    /// Whether its frames are recorded in parts.
    pub is_cut: bool,
    /// What pipelines are built for that follows from the scene.
    pub constants: Constants,
}

/// What a state is made with.
pub(crate) struct Maker<'a> {
    pub device: &'a Device,
    pub pool: &'a mut Pool,
    pub limits: PlanLimits,
    /// Width and height of the picture. Unit: pixel.
    pub size: [u32; 2],
}

impl Maker<'_> {
    /// The state of `scene`, whose shared parts on the device are `assets`. It differs from `before` by
    /// `changed`; size and limits may differ, too.
    pub fn state(
        &mut self,
        scene: Arc<Scene>,
        assets: GpuAssets,
        before: Option<&SceneState>,
        changed: ChangeSet,
    ) -> Result<SceneState, RenderError> {
        let device = self.device;
        check_size(device, self.size)?;
        let facts = tyndall_scene::facts(&scene);
        let plan = plan(&facts, &scene.render, &self.limits)?;
        check_work(device, &plan, self.size)?;
        need_geometry(device, &assets.placement, &plan)?;
        let accesses: Vec<&[Access]> = plan.passes.iter().map(|p| p.accesses.as_slice()).collect();
        let earlier = before.map(|before| &before.resources);
        let is_cut = self.limits.in_parts && is_long(device, &plan, self.size);
        let resources = self
            .pool
            .fit(device, &accesses, self.size, earlier, !is_cut)?;
        let kinds: Vec<KeptKind> = plan.passes.iter().flat_map(|p| p.keeps.clone()).collect();
        let preparation = Preparation {
            device,
            scene: &scene,
            facts: &facts,
            size: self.size,
            before: before.map(|before| before.scene.as_ref()),
            changed,
        };
        let nothing = KeptStates::default();
        let kept = before
            .map_or(&nothing, |before| &before.kept)
            .next(&kinds, &preparation)?;
        let inputs = before
            .filter(|before| !changed.contains(ChangeSet::SURFACES) && before.inputs.fits(&scene))
            .map_or_else(
                || Inputs::new(device, &scene),
                |before| before.inputs.clone(),
            );
        Ok(SceneState {
            constants: constants(&scene, &facts, assets.placement.emitter_count()),
            scene,
            facts,
            plan,
            assets,
            inputs,
            resources,
            kept,
            is_cut,
        })
    }
}

impl SceneState {
    /// Uploads what `changed`, and what the plan says that small buffers hold.
    pub fn upload(&self, device: &Device, changed: ChangeSet) {
        if !changed.restarts() {
            return;
        }
        let sorted = self.plan.passes.iter().any(|pass| pass.sorts_lights);
        let mode = self.shadow_mode();
        let maps = self.kept.get::<ShadowMaps>();
        // A traced shadow needs no map: any view number says that the light casts shadows.
        let shadow_of = |i: usize, light: &Light| match mode {
            ShadowMode::Mapped => maps.and_then(|maps| maps.of_light(i)),
            ShadowMode::Traced => light.casts_shadows().then_some((0, 0.0)),
            ShadowMode::Off => None,
        };
        self.inputs.upload_scene(
            device,
            &self.scene,
            &self.assets,
            &shadow_of,
            sorted,
            changed,
        );
        self.kept.upload(device, &self.scene);
        for (resource, bytes) in self.plan.passes.iter().flat_map(|pass| &pass.values) {
            if let Some(buffer) = self.resources.buffer(resource.name) {
                device.queue.write_buffer(buffer, 0, bytes);
            }
        }
    }

    /// How visibility toward lights is found at present.
    pub fn shadow_mode(&self) -> ShadowMode {
        if self.plan.runs(shadow_maps::PASS) {
            ShadowMode::Mapped
        } else if self.plan.visibility == Some(ShadowMode::Traced) || self.plan.runs(paths::PASS) {
            ShadowMode::Traced
        } else {
            ShadowMode::Off
        }
    }
}

/// Refuses frames that would keep the device busy for minutes.
fn check_work(
    device: &Device,
    plan: &FramePlan,
    [width, height]: [u32; 2],
) -> Result<(), RenderError> {
    let pixels = u64::from(width) * u64::from(height);
    let allowed = most_frame_iterations(device.summary().kind);
    let longest = plan.passes.iter().max_by_key(|pass| pass.whole_picture());
    let needed = longest.map_or(0, |pass| pass.whole_picture().saturating_mul(pixels));
    if needed > allowed {
        return Err(RenderError::TooLarge {
            what: "loop iterations a frame (lights × steps × media × pixels)",
            needed,
            allowed,
        });
    }
    Ok(())
}

/// Whether a frame may take longer than others should wait for the device, by upper bounds.
fn is_long(device: &Device, plan: &FramePlan, [width, height]: [u32; 2]) -> bool {
    let pixels = u64::from(width) * u64::from(height);
    let loops = plan.passes.iter().map(PlannedPass::whole_picture);
    let per_pixel = loops.fold(SHORT_PASSES * SHORT, u64::saturating_add);
    pixels.saturating_mul(per_pixel) > most_iterations(device.summary().kind)
}

/// Builds what the passes of the plan ask rays about.
pub(crate) fn need_geometry(
    device: &Device,
    placement: &GpuPlacement,
    plan: &FramePlan,
) -> Result<(), RenderError> {
    match plan.passes.iter().map(|pass| pass.traces).max() {
        Some(Traces::Triangles) => placement.need_triangles(device),
        Some(Traces::Rays) => placement.need_bvh(device),
        Some(Traces::Nothing) | None => Ok(()),
    }
}

/// Dispatches over all pixels that a corrected picture takes, without the technique's.
const SHORT_PASSES: u64 = 20;

/// Up to so many lights a pipeline is built for their number: the software driver is then faster.
const MOST_FEW_LIGHTS: usize = 8;
/// The same of media.
const MOST_FEW_MEDIA: usize = 4;
/// Share by which the channels of a grey medium's extinction may differ: it is the sum of rounded scattering and
/// absorption, and another pipeline would be built, and be slower, for their last bits.
const SAME_EXTINCTION: f32 = 1e-6;
/// Stands for every larger number, which one pipeline serves; `MANY` in `scene.wesl`.
const MANY: u32 = u32::MAX;

/// The number that a pipeline is built for: `count` itself while it is small.
fn few(count: usize, most: usize) -> u32 {
    if count <= most { count as u32 } else { MANY }
}

/// What pipelines are built for that follows from the scene and its number of emissive triangles.
pub(crate) fn constants(scene: &Scene, facts: &SceneFacts, emitter_count: u32) -> Constants {
    let chromatic = |medium: &Medium| {
        let grey = |rgb: [f32; 3]| {
            let apart = |channel: f32| (channel - rgb[0]).abs();
            rgb.into_iter()
                .all(|channel| apart(channel) <= SAME_EXTINCTION * rgb[0])
        };
        let sigma_t: [f32; 3] = std::array::from_fn(|c| medium.sigma_s[c] + medium.sigma_a[c]);
        !grey(sigma_t)
    };
    let mixed = |medium: &Medium| !medium.phase.is_henyey_greenstein();
    let in_grid = |medium: &Medium| matches!(medium.shape, MediumShape::Grid { .. });
    let chromatic_grids = scene.media.iter().any(|m| chromatic(m) && in_grid(m));
    Constants::default()
        .number("MEDIUM_COUNT", few(scene.media.len(), MOST_FEW_MEDIA))
        .number("LIGHT_COUNT", few(scene.lights.len(), MOST_FEW_LIGHTS))
        .flag("EMITTERS", emitter_count > 0)
        .flag("CHROMATIC", scene.media.iter().any(chromatic))
        .flag("CHROMATIC_GRIDS", chromatic_grids)
        .flag("FINDS_LIGHT", emitter_count > 0 || facts.environment)
        .flag("GLOWS", facts.medium_emits)
        .flag("ISOTROPIC", !facts.anisotropic)
        .flag("SKY", facts.environment)
        .flag("MIXED_PHASES", scene.media.iter().any(mixed))
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    fn of(medium: &serde_json::Value) -> Constants {
        let description = tyndall_scene::SceneDescription::from_json(
            &json!({
                "version": 1,
                "camera": { "position": [0, 0, 3], "target": [0, 0, 0] },
                "lights": [{ "kind": "environment", "radiance": 1 }],
                "media": [medium],
            })
            .to_string(),
        )
        .expect("a description");
        let scene = tyndall_scene::build(description, None)
            .expect("valid")
            .scene;
        constants(&scene, &tyndall_scene::facts(&scene), 0)
    }

    #[test]
    fn a_grey_medium_is_grey_however_its_coefficients_are_written() {
        let (sigma_t, albedo) = (0.045, [0.93, 0.9, 0.85]);
        let grey = of(&json!({ "kind": "homogeneous", "sigma_t": sigma_t, "albedo": albedo }));
        // As the page writes it.
        let sigma_s = albedo.map(|albedo| sigma_t * albedo);
        let sigma_a = albedo.map(|albedo| sigma_t * (1.0 - albedo));
        for scale in [1.0, 0.37, 3.3, 20.0] {
            let medium = json!({ "kind": "homogeneous", "sigma_s": sigma_s, "sigma_a": sigma_a,
                "density_scale": scale });
            assert_eq!(of(&medium), grey, "{scale}");
        }
        let coloured = json!({ "kind": "homogeneous", "sigma_s": sigma_s, "sigma_a": 0.001 });
        assert_ne!(of(&coloured), grey);
    }
}
