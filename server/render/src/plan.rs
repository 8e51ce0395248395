//! What one frame does, and why. Pure: equal inputs give equal plans.

mod area_lights;
mod correction;
mod march;
mod reference;

use std::fmt;

use serde::Serialize;
use tyndall_scene::SceneFacts;
use tyndall_scene::{RenderSettings, ShadowMode, Technique};

pub(crate) use area_lights::{area_strata, has_area_lights};
use area_lights::{plan_area_lights, plan_bvh};
use correction::{plan_correction, plan_no_correction, without_correction};
pub(crate) use march::March;
use reference::{plan_paths, plan_reference};

/// A pass of the renderer.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum PassKind {
    /// Builds the BVH, once a geometry.
    Bvh,
    /// Depth maps seen from the lights; re-rendered only for what moved.
    ShadowMaps,
    /// Depth, base colour, normal, emission of what the camera sees.
    Gbuffer,
    /// Direct light of surfaces, attenuated.
    Shade,
    /// Optical depth of density grids toward the lights; filled again only when either changes.
    LightVolume,
    /// Light scattered once in the media.
    SingleScattering,
    /// Brings interleaved strata together, and fills in pixels that were not marched.
    Gather,
    /// Light of emissive triangles and the environment, scattered once.
    AreaLights,
    /// Unbiased path tracing of everything.
    Reference,
    /// Running mean and statistics.
    Film,
    /// Brings the technique's picture toward the traced one.
    Correction,
    /// The mean's own error.
    Estimate,
    /// Exposure, curve, encoding.
    Tonemap,
}

impl PassKind {
    /// Name in plans, metrics and labels.
    pub fn name(self) -> &'static str {
        match self {
            Self::Bvh => "bvh",
            Self::ShadowMaps => "shadow_maps",
            Self::Gbuffer => "gbuffer",
            Self::Shade => "shade",
            Self::LightVolume => "light_volume",
            Self::SingleScattering => "single_scattering",
            Self::Gather => "gather",
            Self::AreaLights => "area_lights",
            Self::Reference => "reference",
            Self::Film => "film",
            Self::Correction => "correction",
            Self::Estimate => "estimate",
            Self::Tonemap => "tonemap",
        }
    }
}

/// A pass that runs.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct PlannedPass {
    /// Which.
    pub pass: PassKind,
    /// Permutation of its shader; empty where several or none are used.
    pub variant: String,
    /// Why it runs.
    pub reason: String,
}

/// A pass, or part of one, that does not run.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct SkippedPass {
    /// Which.
    pub pass: PassKind,
    /// What of it is left out; empty for all of it.
    pub variant: String,
    /// Why it is skipped.
    pub reason: String,
}

/// Passes in the order they run, and what is skipped.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Default)]
pub struct FramePlan {
    /// Runs, in this order.
    pub passes: Vec<PlannedPass>,
    /// Does not run.
    pub skipped: Vec<SkippedPass>,
}

/// What the device allows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct PlanLimits {
    /// The driver stops an invocation after so many loop iterations.
    pub loop_cap: Option<u32>,
    /// The picture has more pixels than the correction's buffers may hold.
    pub beyond_correction: bool,
    /// Every light is marched along every ray, and every ray takes all strata: to measure what leaving
    /// some out saves.
    pub unskipped: bool,
}

impl FramePlan {
    fn run(&mut self, pass: PassKind, variant: &str, reason: impl Into<String>) {
        self.passes.push(PlannedPass {
            pass,
            variant: variant.to_owned(),
            reason: reason.into(),
        });
    }

    fn skip(&mut self, pass: PassKind, variant: &str, reason: impl Into<String>) {
        self.skipped.push(SkippedPass {
            pass,
            variant: variant.to_owned(),
            reason: reason.into(),
        });
    }

    /// Variant with which `pass` runs, if it does.
    pub fn variant(&self, pass: PassKind) -> Option<&str> {
        self.passes
            .iter()
            .find(|planned| planned.pass == pass)
            .map(|planned| planned.variant.as_str())
    }

    /// Whether rays find what hides lights from surfaces.
    pub fn shades_traced(&self) -> bool {
        self.variant(PassKind::Shade)
            .is_some_and(|variant| variant.contains("+traced"))
    }

    /// Whether `pass` runs.
    pub fn runs(&self, pass: PassKind) -> bool {
        self.variant(pass).is_some()
    }
}

/// How visibility is found once everything is known.
fn visibility(facts: &SceneFacts, settings: &RenderSettings) -> ShadowMode {
    if facts.shadow_casters == 0 || facts.triangles == 0 {
        ShadowMode::Off
    } else {
        settings.shadows.mode
    }
}

/// Decides what a frame of a scene with these facts does.
pub fn plan(facts: &SceneFacts, settings: &RenderSettings, limits: &PlanLimits) -> FramePlan {
    if settings.technique == Technique::Reference {
        return plan_reference(facts, settings);
    }
    let mut plan = FramePlan::default();
    let lights = facts.lights();
    let shadows = visibility(facts, settings);
    let uncorrected = without_correction(facts, settings, *limits);
    let paths = uncorrected.is_none();
    plan_visibility(&mut plan, facts, settings, lights, (shadows, paths));
    let suffix = match shadows {
        ShadowMode::Off => "",
        ShadowMode::Mapped => "+mapped",
        ShadowMode::Traced => "+traced",
    };
    let emissive = if facts.emissive_triangles > 0 {
        "+emissive"
    } else {
        ""
    };
    let media = if facts.media > 0 { "+media" } else { "" };
    if facts.triangles > 0 {
        let textured = if facts.textures > 0 { "+textured" } else { "" };
        plan.run(
            PassKind::Gbuffer,
            &format!("{emissive}{textured}"),
            format!(
                "{} triangles in {} instances",
                facts.triangles, facts.instances
            ),
        );
    } else {
        plan.skip(
            PassKind::Gbuffer,
            "",
            "no triangles: only the depth is cleared",
        );
    }
    if emissive.is_empty() {
        plan.skip(
            PassKind::Gbuffer,
            "emission target",
            "no emissive triangles",
        );
    }
    let grids = if facts.grids > 0 { "+grids" } else { "" };
    plan_light_volume(&mut plan, facts, lights);
    let map = if facts.environment_map {
        "+environment_map"
    } else {
        ""
    };
    plan.run(
        PassKind::Shade,
        &format!("shade{emissive}{media}{suffix}{grids}{map}"),
        format!(
            "{lights} lights on surfaces, attenuated by {} media",
            facts.media
        ),
    );
    let suffix = format!("{suffix}{grids}");
    let marched = plan_march(&mut plan, facts, settings, lights, &suffix, *limits);
    let area = plan_area_lights(&mut plan, facts, settings, (*limits, paths));
    let mut film = String::from("film");
    if marched {
        film.push_str("+in_scatter");
    }
    if area {
        film.push_str("+area");
    }
    plan.run(PassKind::Film, &film, "running mean while nothing changes");
    if let Some(why) = uncorrected {
        plan_no_correction(&mut plan, why);
    } else {
        plan_paths(&mut plan, facts);
        plan_correction(&mut plan, facts, settings, true);
    }
    plan.run(PassKind::Tonemap, "tonemap", "8-bit picture for the screen");
    plan
}

fn plan_visibility(
    plan: &mut FramePlan,
    facts: &SceneFacts,
    settings: &RenderSettings,
    lights: usize,
    (shadows, paths): (ShadowMode, bool),
) {
    let without = if lights == 0 {
        "no lights"
    } else if facts.triangles == 0 {
        "no surfaces that could cast a shadow"
    } else if facts.shadow_casters == 0 {
        "no light casts shadows"
    } else {
        "shadows are off"
    };
    match shadows {
        ShadowMode::Mapped => {
            let views = facts.shadow_views();
            let side = settings.shadows.resolution;
            plan_bvh(plan, facts, paths);
            plan.run(
                PassKind::ShadowMaps,
                "",
                format!(
                    "up to {views} views of {side}×{side}, kept until a light or a caster moves"
                ),
            );
        }
        ShadowMode::Traced => {
            plan_bvh(plan, facts, true);
            plan.skip(PassKind::ShadowMaps, "", "visibility is traced");
        }
        ShadowMode::Off => {
            plan_bvh(plan, facts, paths);
            plan.skip(PassKind::ShadowMaps, "", without);
        }
    }
}

fn plan_light_volume(plan: &mut FramePlan, facts: &SceneFacts, lights: usize) {
    let pass = PassKind::LightVolume;
    if facts.grids == 0 {
        plan.skip(
            pass,
            "",
            "no density grids: optical depths have closed forms",
        );
    } else {
        plan.run(
            pass,
            "",
            format!(
                "depth of {} grids toward {lights} lights, kept until either changes",
                facts.grids
            ),
        );
    }
}

fn plan_march(
    plan: &mut FramePlan,
    facts: &SceneFacts,
    settings: &RenderSettings,
    lights: usize,
    suffix: &str,
    limits: PlanLimits,
) -> bool {
    let pass = PassKind::SingleScattering;
    let reason = if facts.media == 0 {
        "no media"
    } else if !facts.scatters && !facts.medium_emits {
        "no medium scatters or emits: transmittance only"
    } else if lights == 0 && !facts.medium_emits {
        "no light to scatter"
    } else {
        if !facts.anisotropic {
            plan.skip(pass, "phase function", "g = 0 everywhere: 1/4π");
        }
        if !facts.medium_emits {
            plan.skip(pass, "emission", "no medium emits");
        }
        let march = March::of(facts, settings, limits);
        plan.run(
            pass,
            &format!("single_scattering{suffix}"),
            march.reason(facts, settings, lights, limits),
        );
        if march.is_shared() {
            plan.run(
                PassKind::Gather,
                &format!("single_scattering+list{suffix}"),
                march.sharing(),
            );
        } else {
            plan.skip(PassKind::Gather, "", "every pixel takes all strata");
        }
        return true;
    };
    plan.skip(pass, "", reason);
    plan.skip(PassKind::Gather, "", "nothing is marched");
    false
}

impl fmt::Display for FramePlan {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "runs")?;
        for p in &self.passes {
            writeln!(f, "  {:<18} {:<36} {}", p.pass.name(), p.variant, p.reason)?;
        }
        writeln!(f, "skipped")?;
        for p in &self.skipped {
            writeln!(f, "  {:<18} {:<36} {}", p.pass.name(), p.variant, p.reason)?;
        }
        Ok(())
    }
}
