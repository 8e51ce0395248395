//! Surfaces lit directly, and light scattered exactly once in the media.
//!
//! Source: Tóth and Umenhoffer 2009, by `stages/in_scatter`, whose head has the corrections. Transports orders
//! 0 and 1 of the partition. Bias: what the head of each stage says; none with traced shadows and jitter in
//! analytic media. Planned for scenes whose media scatter the light of lights with a position or a direction,
//! or glow.

mod ladder;

use tyndall_scene::{Scene, ShadowMode};

use super::technique::Technique;
use super::{Claim, Paths, Rung};
use crate::frame::{FramePlan, PlanInput};
use crate::stages::surfaces::Place;
use crate::stages::{area_lights, film, in_scatter, light_volume, surfaces, visibility};

/// The technique.
pub(super) struct SingleScattering;

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
        let layers = in_scatter::plan(plan, input)
            .into_iter()
            .chain(area_lights::plan(plan, input, Place::Eye));
        let layers: Vec<_> = layers.collect();
        film::plan(plan, film::of_technique(input), &layers);
    }

    fn ladder(&self, quick: bool) -> Vec<Rung> {
        ladder::rungs(quick)
    }
}
