//! Light scattered exactly once in the media, by marching the camera ray.
//!
//! Source: Tóth and Umenhoffer 2009, with the corrections of `wesl/techniques/single_scattering/march.wesl`.
//! Transports order 1 of the partition from point, spot and directional lights, and the media's own
//! emission. Bias: none with jitter in analytic media (unbiased in the ray parameter); without it the
//! midpoint rule's, second order in the step. Density grids add the trapezoid rule of their optical
//! depth and the spacing of the light volume, both second order; interleaving adds what is left of
//! its window's blur, of the fourth order but at edges; half resolution what is left of a parabola
//! between marched pixels, of the fourth order but at edges; shadow maps their resolution's. Cost: steps ×
//! lights × media a pixel, a M²-th of it interleaved, a quarter at half resolution. Planned for scenes
//! whose media scatter the light of lights with a position or a direction, or glow.

mod gather;
mod ladder;
mod march;
mod passes;

use tyndall_scene::{Scene, ShadowMode};

use super::technique::Technique;
use super::{Claim, Paths, Rung};
use crate::frame::{FramePlan, PlanInput};
use crate::stages::film::Layer;
use crate::stages::surfaces::Place;
use crate::stages::{area_lights, film, light_volume, surfaces, visibility};

/// The technique.
pub(super) struct SingleScattering;

/// Plans the light of lights that the media scatter exactly once, for a picture that has it beside other light;
/// what it adds to the film, if anything.
pub(super) fn plan_in_scatter(plan: &mut FramePlan, input: &PlanInput<'_>) -> Option<Layer> {
    passes::plan(plan, input)
}

impl Technique for SingleScattering {
    fn key(&self) -> tyndall_scene::Technique {
        tyndall_scene::Technique::SingleScattering
    }

    fn claim(&self) -> Claim {
        Claim {
            paths: Paths::AtMostOneScattering,
            bias: "shadow maps, density grids and shared strata; otherwise none with jitter",
        }
    }

    fn unsupported(&self, scene: &Scene) -> Vec<String> {
        let materials = &scene.geometry.materials;
        let masked = materials.iter().any(|m| m.alpha_cutoff.is_some());
        if masked && scene.render.shadows.mode == ShadowMode::Traced {
            vec!["render.shadows.mode: traced, with alpha-masked materials".into()]
        } else {
            Vec::new()
        }
    }

    fn plan(&self, input: &PlanInput<'_>, plan: &mut FramePlan) {
        visibility::plan(plan, input);
        surfaces::plan_gbuffer(plan, input);
        light_volume::plan(plan, input);
        surfaces::plan_shade(plan, input, Place::Eye);
        let layers = passes::plan(plan, input)
            .into_iter()
            .chain(area_lights::plan(plan, input, Place::Eye));
        let layers: Vec<_> = layers.collect();
        film::plan(plan, film::of_technique(input), &layers);
    }

    fn ladder(&self, quick: bool) -> Vec<Rung> {
        ladder::rungs(quick)
    }
}
