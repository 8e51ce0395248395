//! What of the path tracer runs.

use tyndall_scene::{CorrectionMode, RenderSettings, SceneFacts};

use super::correction::plan_correction;
use super::{FramePlan, PassKind};

/// The path tracer needs no other pass's picture.
pub(super) fn plan_reference(facts: &SceneFacts, settings: &RenderSettings) -> FramePlan {
    let mut plan = FramePlan::default();
    let surfaces = facts.triangles > 0;
    if surfaces {
        plan.run(
            PassKind::Bvh,
            "",
            format!("{} triangles, built once", facts.triangles),
        );
    } else {
        plan.skip(PassKind::Bvh, "", "no triangles to intersect");
    }
    plan.skip(PassKind::ShadowMaps, "", "visibility is traced");
    plan.skip(PassKind::Gbuffer, "", "paths start at the camera");
    plan.skip(PassKind::Shade, "", "paths light surfaces");
    plan.skip(PassKind::LightVolume, "", "paths track through grids");
    plan.skip(
        PassKind::SingleScattering,
        "",
        "paths scatter any number of times",
    );
    plan.skip(PassKind::Gather, "", "paths are not interleaved");
    plan.skip(PassKind::AreaLights, "", "paths find area lights");
    plan_paths(&mut plan, facts);
    plan.skip(PassKind::Film, "", "the path tracer keeps the mean");
    if settings.correction == CorrectionMode::Off {
        plan.skip(PassKind::Correction, "", "off: the traced picture as it is");
        plan.run(
            PassKind::Estimate,
            "estimate+tiles",
            "error of the mean from its two halves",
        );
    } else {
        plan_correction(&mut plan, facts, settings, false);
    }
    plan.run(PassKind::Tonemap, "tonemap", "8-bit picture for the screen");
    plan
}

/// The paths themselves, for a picture of their own or to correct another.
pub(super) fn plan_paths(plan: &mut FramePlan, facts: &SceneFacts) {
    let mut variant = String::from("reference");
    if facts.triangles > 0 {
        variant.push_str("+surfaces");
        if facts.textures + facts.data_textures > 0 {
            variant.push_str("+textured");
        }
    }
    if facts.grids > 0 {
        variant.push_str("+grids");
    }
    if facts.environment_map {
        variant.push_str("+environment_map");
    }
    let lights = facts.lights();
    plan.run(
        PassKind::Reference,
        &variant,
        format!(
            "{lights} lights, {} emissive triangles, {} media of which {} grids",
            facts.emissive_triangles, facts.media, facts.grids
        ),
    );
}
