//! Light of lights that the media scatter exactly once toward the eye, by marching the camera ray.
//!
//! Source: Tóth and Umenhoffer 2009, with the corrections of `wesl/stages/in_scatter/march.wesl`.
//! Transports order 1 of the partition from point, spot and directional lights, and the media's own
//! emission. Bias: none with jitter in analytic media (unbiased in the ray parameter); without it the
//! midpoint rule's, second order in the step. Density grids add the trapezoid rule of their optical
//! depth and the spacing of the light volume, both second order; interleaving adds what is left of
//! its window's blur, of the fourth order but at edges; half resolution what is left of a parabola
//! between marched pixels, of the fourth order but at edges; shadow maps their resolution's. Cost: steps ×
//! lights × media a pixel, a M²-th of it interleaved, a quarter at half resolution. The technique
//! `single_scattering` is this and the light of surfaces; others show it beside orders of their own.

mod gather;
mod march;

use tyndall_shaders::types::MarchSettings;

use super::film::Layer;
use super::surfaces::depth;
use crate::engine::{Bytes, Permutation, ResourceSpec};
use crate::frame::{Dispatch, FramePlan, NewPass, PassId, PlanInput, Programs, Reach};
use gather::Gather;
use march::March;

/// Light scattered once in the media.
pub(crate) const MARCH: PassId = PassId("single_scattering");

/// Radiance (W·m⁻²·sr⁻¹), whole; alpha as in `low_resolution/distance_share.wesl`.
const IN_SCATTER: ResourceSpec =
    ResourceSpec::texture("in_scattered_radiance", wgpu::TextureFormat::Rgba32Float);

/// The march's settings on the device.
const SETTINGS: ResourceSpec = ResourceSpec::buffer(
    "march_settings",
    Bytes::Fixed(size_of::<MarchSettings>() as u64),
)
.kept();

/// Plans what there is to march; what it adds to the film, if anything.
pub(crate) fn plan(plan: &mut FramePlan, input: &PlanInput<'_>) -> Option<Layer> {
    if let Some(reason) = nothing_to_march(input) {
        plan.skip(MARCH, "", reason);
        plan.skip(gather::PASS, "", "nothing is marched");
        return None;
    }
    let facts = input.facts;
    if !facts.anisotropic {
        plan.skip(MARCH, "phase function", "g = 0 everywhere: 1/4π");
    }
    if !facts.medium_emits {
        plan.skip(MARCH, "emission", "no medium emits");
    }
    let march = March::of(input);
    let features = |permutation: Permutation| {
        input
            .visibility_feature()
            .into_iter()
            .fold(permutation, Permutation::with)
            .with_if(facts.grids > 0, "grids")
    };
    let whole = features(Permutation::of("single_scattering"));
    let shared = gather::Shared::of(march);
    let marched = shared.map_or(IN_SCATTER, gather::Shared::marched);
    plan.run(
        NewPass::new(
            MARCH,
            Programs::One(whole),
            Dispatch(Reach::Blocks {
                side: march.spacing,
                // Groups of the same rank fill blocks of 8 tiles a side: see `interleave.wesl`.
                multiple: 8 * march.interleave,
            }),
        )
        .constants(march.constants())
        .iterations(march.iterations(input))
        .sorts_lights(march.culls)
        .values(
            SETTINGS,
            &MarchSettings {
                steps: march.steps,
                jitter: march.jitter.into(),
            },
        )
        .accesses([depth(facts).read(), marched.written_as("marched_radiance")]),
        march.reason(input),
    );
    if let Some(shared) = shared {
        let listed = features(Permutation::of("single_scattering").with("list"));
        let restoring = Permutation::of("gather")
            .with(if march.spacing > 1 {
                "spread"
            } else {
                "reject"
            })
            .with_if(march.spacing > 1 && facts.grids > 0, "grids");
        plan.run(
            NewPass::new(
                gather::PASS,
                Programs::One(listed),
                Gather { shared, restoring },
            )
            .constants(march.constants())
            .listed_iterations(march.full_iterations(input))
            .values(gather::EMPTY, &gather::EMPTY_LIST)
            .accesses(shared.accesses())
            .accesses([
                depth(facts).read(),
                SETTINGS.read(),
                IN_SCATTER.written_as("in_scattered_radiance_written"),
            ]),
            march.sharing(),
        );
    } else {
        plan.skip(gather::PASS, "", "every pixel takes all strata");
    }
    Some(("in_scatter", IN_SCATTER.read()))
}

fn nothing_to_march(input: &PlanInput<'_>) -> Option<&'static str> {
    let facts = input.facts;
    if facts.media == 0 {
        Some("no media")
    } else if !facts.scatters && !facts.medium_emits {
        Some("no medium scatters or emits: transmittance only")
    } else if input.lights() == 0 && !facts.medium_emits {
        Some("no light to scatter")
    } else {
        None
    }
}
