//! Whether area lights are looked at, and what for.

use tyndall_scene::{CorrectionMode, RenderSettings, SceneFacts};

use super::{FramePlan, PassKind, PlanLimits};

/// Whether light comes from emissive triangles or from infinity.
pub(crate) fn has_area_lights(facts: &SceneFacts) -> bool {
    facts.emissive_triangles > 0 || facts.environment
}

/// Why area lights light nothing, if so.
fn without_area_lights(facts: &SceneFacts) -> Option<&'static str> {
    if !has_area_lights(facts) {
        Some("no emissive triangles and no environment")
    } else if facts.triangles == 0 && !facts.scatters {
        Some("nothing reflects or scatters the environment's light")
    } else {
        None
    }
}

/// Points of a ray, of each kind, at which area lights are looked at.
const AREA_STRATA: u32 = 8;
/// Directions toward emitters that a shadow ray is the best of.
const CANDIDATES: u32 = 4;

/// As many points as the march has strata, but few: each costs a shadow ray. Even: half of them are
/// of one kind where there are two.
pub(crate) fn area_strata(
    facts: &SceneFacts,
    settings: &RenderSettings,
    limits: PlanLimits,
) -> u32 {
    // A shadow ray visits tens of nodes; the bound leaves room for hundreds. Each point may lie in any
    // medium, and there are two kinds of lights.
    let media = 12 * facts.media.max(1) as u32;
    let per_point = 2 * (400 + media) + CANDIDATES * (32 + media);
    let most = limits
        .loop_cap
        .map_or(u32::MAX, |cap| cap / (2 * per_point));
    let wanted = settings.single_scattering.steps.min(AREA_STRATA);
    (wanted.min(most) / 2 * 2).max(2)
}

/// Whether traced samples bring their light beside that of other lights. It is smooth, and a few points of
/// a ray are as noisy as a path: at one to 16 samples the corrected hall, smoke and cloud are 10 to 40 %
/// closer to the truth without this pass, in two thirds of the time.
fn left_to_paths(facts: &SceneFacts, settings: &RenderSettings, paths: bool) -> bool {
    let lights = facts.lights();
    paths && settings.correction == CorrectionMode::Always && lights > 0
}

/// Plans the pass; whether it runs. `paths` where the picture is corrected.
pub(super) fn plan_area_lights(
    plan: &mut FramePlan,
    facts: &SceneFacts,
    settings: &RenderSettings,
    (limits, paths): (PlanLimits, bool),
) -> bool {
    let pass = PassKind::AreaLights;
    if let Some(why) = without_area_lights(facts) {
        plan.skip(pass, "", why);
        return false;
    }
    if left_to_paths(facts, settings, paths) {
        plan.skip(
            pass,
            "",
            "traced samples bring the light of areas and the sky",
        );
        return false;
    }
    let mut variant = String::from("area_lights");
    if facts.triangles > 0 {
        variant.push_str("+surfaces");
        if facts.textures > 0 {
            variant.push_str("+textured");
        }
    }
    if facts.grids > 0 {
        variant.push_str("+grids");
    }
    if facts.environment_map {
        variant.push_str("+environment_map");
    }
    let sky = match (facts.environment, facts.environment_map) {
        (false, _) => "no sky",
        (true, false) => "a constant sky",
        (true, true) => "an environment map",
    };
    let strata = area_strata(facts, settings, limits);
    plan.run(
        pass,
        &variant,
        format!(
            "{} emissive triangles and {sky}; {strata} points of a ray for each",
            facts.emissive_triangles
        ),
    );
    true
}

/// The BVH: for shadows and paths that are traced, and for the area lights, whose points lie on its triangles.
pub(super) fn plan_bvh(plan: &mut FramePlan, facts: &SceneFacts, traced: bool) {
    let area = facts.triangles > 0 && without_area_lights(facts).is_none();
    if facts.triangles > 0 && (traced || area) {
        plan.run(
            PassKind::Bvh,
            "",
            format!("{} triangles, built once", facts.triangles),
        );
    } else {
        plan.skip(PassKind::Bvh, "", "no pass traces rays");
    }
}
