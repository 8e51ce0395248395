//! Light of emissive triangles and of the environment, scattered exactly once toward the eye.
//!
//! Source: directions uniform over the solid angle of an emissive triangle (Arvo 1995; Peters 2021), the
//! best of several by what they would bring (Talbot et al. 2005), equiangular distances (Kulla and
//! Fajardo 2012), collisions and ratio tracking in grids (Woodcock 1965; Novák et al. 2014), joined by
//! the balance heuristic (Veach and Guibas 1995).
//! Transports the part of orders 0 and 1 of the partition that `surfaces` and `single_scattering` leave
//! out: area lights on surfaces and in the media. Bias: none; every frame is a sample of the
//! running mean. Cost: a shadow ray for each of the strata a kind of light and medium, half as many
//! where media without grids scatter emitters' light, and up to three on the surface.

use tyndall_scene::{CorrectionMode, SceneFacts, ShadowMode};

use super::film::Layer;
use super::surfaces::{Place, base_color, depth, normal};
use crate::engine::{Constants, Permutation, ResourceSpec};
use crate::frame::{Dispatch, FramePlan, NewPass, PassId, PlanInput, Programs, Reach, Traces};

/// Light of emissive triangles and the environment, scattered once.
pub(crate) const PASS: PassId = PassId("area_lights");

/// Radiance (W·m⁻²·sr⁻¹); alpha is not used.
const AREA_RADIANCE: ResourceSpec =
    ResourceSpec::texture("area_radiance", wgpu::TextureFormat::Rgba32Float);

/// The media's part of that by itself.
pub(crate) const MEDIA_PASS: PassId = PassId("area_lights_in_media");
const MEDIA_RADIANCE: ResourceSpec = ResourceSpec::texture(
    "area_in_scattered_radiance",
    wgpu::TextureFormat::Rgba32Float,
);

/// Points of a ray, of each kind, at which area lights are looked at.
const AREA_STRATA: u32 = 8;
/// Directions toward emitters that a shadow ray is the best of.
const CANDIDATES: u64 = 4;

/// Whether light comes from emissive triangles or from infinity.
pub(crate) fn has_area_lights(facts: &SceneFacts) -> bool {
    facts.emissive_triangles > 0 || facts.environment
}

/// Why area lights light nothing, if so.
pub(super) fn without_area_lights(facts: &SceneFacts) -> Option<&'static str> {
    if !has_area_lights(facts) {
        Some("no emissive triangles and no environment")
    } else if facts.triangles == 0 && !facts.scatters {
        Some("nothing reflects or scatters the environment's light")
    } else {
        None
    }
}

/// As many points as the march has strata, but few: each costs a shadow ray. Even: half of them are
/// of one kind where there are two.
fn strata(input: &PlanInput<'_>) -> u32 {
    let cap = input.limits.loop_cap;
    let most = cap.map_or(u32::MAX, |cap| cap / per_point(input) as u32);
    let wanted = input.settings.single_scattering.steps.min(AREA_STRATA);
    (wanted.min(most) / 2 * 2).max(2)
}

/// Loop iterations of one point. A shadow ray visits tens of nodes; the bound leaves room for hundreds.
/// Each point may lie in any medium, and there are two kinds of lights.
fn per_point(input: &PlanInput<'_>) -> u64 {
    let media = 12 * input.facts.media.max(1) as u64;
    2 * (2 * (400 + media) + CANDIDATES * (32 + media))
}

/// Whether traced samples bring their light beside that of other lights. It is smooth, and a few points of
/// a ray are as noisy as a path: at one to 16 samples the corrected hall, smoke and cloud are 10 to 40 %
/// closer to the truth without this pass, in two thirds of the time.
fn left_to_paths(input: &PlanInput<'_>) -> bool {
    input.is_corrected()
        && input.settings.correction == CorrectionMode::Always
        && input.lights() > 0
}

/// Plans the pass; what it adds to the film, if it runs. At [`Place::Surface`] it is what leaves surfaces, and
/// nothing of the media.
pub(crate) fn plan(plan: &mut FramePlan, input: &PlanInput<'_>, place: Place) -> Option<Layer> {
    let surfaceless = place == Place::Surface && input.facts.triangles == 0;
    if let Some(why) = without(
        input,
        surfaceless,
        "no surface that could reflect their light",
    ) {
        plan.skip(PASS, "", why);
        return None;
    }
    run(
        plan,
        input,
        PASS,
        place.constants().flag("MEDIA_ALONE", false),
        AREA_RADIANCE,
    );
    Some(("area", AREA_RADIANCE.read()))
}

/// Plans the media's part by itself; what it adds to the film, if it runs.
pub(crate) fn plan_media(plan: &mut FramePlan, input: &PlanInput<'_>) -> Option<Layer> {
    if let Some(why) = without(input, !input.facts.scatters, "no medium scatters") {
        plan.skip(MEDIA_PASS, "", why);
        return None;
    }
    let constants = Place::Eye.constants().flag("MEDIA_ALONE", true);
    run(plan, input, MEDIA_PASS, constants, MEDIA_RADIANCE);
    Some(("area", MEDIA_RADIANCE.read_as("area_radiance")))
}

/// Why nothing is looked for, if so; `nothing` says that it would find nothing, and why.
fn without(input: &PlanInput<'_>, nothing: bool, why: &'static str) -> Option<&'static str> {
    without_area_lights(input.facts)
        .or(nothing.then_some(why))
        .or(left_to_paths(input).then_some("traced samples bring the light of areas and the sky"))
}

fn run(
    plan: &mut FramePlan,
    input: &PlanInput<'_>,
    pass: PassId,
    constants: Constants,
    written: ResourceSpec,
) {
    let facts = input.facts;
    let surfaces = facts.triangles > 0;
    let permutation = Permutation::of("area_lights")
        .with_if(surfaces, "surfaces")
        .with_if(surfaces && facts.textures > 0, "textured")
        .with_if(surfaces && facts.glossy_materials > 0, "glossy")
        .with_if(facts.grids > 0, "grids")
        .with_if(facts.environment_map, "environment_map");
    let sky = match (facts.environment, facts.environment_map) {
        (false, _) => "no sky",
        (true, false) => "a constant sky",
        (true, true) => "an environment map",
    };
    let strata = strata(input);
    let shadowed = input.settings.shadows.mode != ShadowMode::Off;
    plan.run(
        NewPass::new(pass, Programs::One(permutation), Dispatch(Reach::Picture))
            .iterations(u64::from(strata) * per_point(input))
            .constants(
                constants
                    .number("AREA_STRATA", strata)
                    .flag("SHADOWED", shadowed),
            )
            .traces(if surfaces {
                Traces::Triangles
            } else {
                Traces::Nothing
            })
            .accesses([
                depth(facts).read(),
                base_color(facts).read(),
                normal(facts).read(),
                written.written_as("area_radiance"),
            ]),
        format!(
            "{} emissive triangles and {sky}; {strata} points of a ray for each",
            facts.emissive_triangles
        ),
    );
}
