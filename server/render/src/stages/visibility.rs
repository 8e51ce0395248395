//! How visibility toward lights is found: by depth maps, by rays through the BVH, or not at all.

use tyndall_scene::ShadowMode;

use super::area_lights::without_area_lights;
use super::shadow_maps;
use crate::frame::{FramePlan, MadeBefore, NewPass, PassId, PlanInput, Programs, Traces};

/// Builds the BVH, once a placement.
pub(crate) const BVH: PassId = PassId("bvh");

/// Plans the BVH and the shadow maps.
pub(crate) fn plan(plan: &mut FramePlan, input: &PlanInput<'_>) {
    let facts = input.facts;
    plan.visibility = Some(input.visibility());
    let traced = input.visibility() == ShadowMode::Traced;
    let area = facts.triangles > 0 && without_area_lights(facts).is_none();
    if facts.triangles > 0 && (traced || input.is_corrected() || area) {
        plan_bvh(plan, input);
    } else {
        plan.skip(BVH, "", "no pass traces rays");
    }
    match input.visibility() {
        ShadowMode::Mapped => shadow_maps::plan(plan, input),
        ShadowMode::Traced => plan.skip(shadow_maps::PASS, "", "visibility is traced"),
        ShadowMode::Off => plan.skip(shadow_maps::PASS, "", why_off(input)),
    }
}

/// Plans the BVH of a scene with triangles.
pub(crate) fn plan_bvh(plan: &mut FramePlan, input: &PlanInput<'_>) {
    plan.run(
        NewPass::new(BVH, Programs::None, MadeBefore).traces(Traces::Rays),
        format!("{} triangles, built once", input.facts.triangles),
    );
}

fn why_off(input: &PlanInput<'_>) -> &'static str {
    if input.lights() == 0 {
        "no lights"
    } else if input.facts.triangles == 0 {
        "no surfaces that could cast a shadow"
    } else if input.facts.shadow_casters == 0 {
        "no light casts shadows"
    } else {
        "shadows are off"
    }
}
