//! The unbiased reference: volumetric path tracing.
//!
//! Transports everything, or the orders that `render.reference` asks for. Free flight is analytic in
//! homogeneous media, height fog and spheres and by null collisions with majorants over coarse cells
//! in density grids (Woodcock 1965; Novák et al. 2014 for transmittance); chromatic coefficients use
//! throughput-aware spectral probabilities (Kutz et al. 2017). Light scattered once more is gathered
//! along whole segments: equiangular and free-flight distances to every source share one resampled
//! candidate (Kulla and Fajardo 2012; Talbot et al. 2005). Emissive triangles and environment maps are
//! also found by scattering, by the balance heuristic. Bias: none. Cost: paths until they leave or
//! the roulette ends them. Planned as a technique of its own, and to correct any other.

pub(crate) mod paths;

use tyndall_scene::{RenderSettings, Scene, SceneFacts};

use super::technique::Technique;
use super::{Claim, Paths, Rung};
use crate::frame::{FramePlan, PassId, PlanInput, PlanLimits};
use crate::stages::{area_lights, film, light_volume, shadow_maps, surfaces, visibility};

/// The technique.
pub(super) struct Reference;

impl Technique for Reference {
    fn key(&self) -> tyndall_scene::Technique {
        tyndall_scene::Technique::Reference
    }

    fn claim(&self) -> Claim {
        Claim {
            paths: Paths::Whole,
            bias: "none",
        }
    }

    fn unsupported(&self, _scene: &Scene) -> Vec<String> {
        Vec::new()
    }

    fn device_refusal(&self, _facts: &SceneFacts, limits: PlanLimits) -> Option<String> {
        let cap = limits.loop_cap?;
        Some(format!(
            "this driver silently stops a shader after {cap} loop iterations, which cuts the reference's paths short: a newer driver (Mesa 23.1 or later) is needed"
        ))
    }

    /// The path tracer needs no other pass's picture.
    fn plan(&self, input: &PlanInput<'_>, plan: &mut FramePlan) {
        if input.facts.triangles > 0 {
            visibility::plan_bvh(plan, input);
        } else {
            plan.skip(visibility::BVH, "", "no triangles to intersect");
        }
        // The last two are passes of the march, which techniques that light media by points share.
        for (pass, why) in [
            (shadow_maps::PASS, "visibility is traced"),
            (surfaces::GBUFFER, "paths start at the camera"),
            (surfaces::SHADE, "paths light surfaces"),
            (light_volume::PASS, "paths track through grids"),
            (
                PassId("single_scattering"),
                "paths scatter any number of times",
            ),
            (PassId("gather"), "paths are not interleaved"),
            (area_lights::PASS, "paths find area lights"),
        ] {
            plan.skip(pass, "", why);
        }
        paths::plan(plan, input);
        plan.skip(film::PASS, "", "the path tracer keeps the mean");
    }

    fn is_traced(&self) -> bool {
        true
    }

    fn ladder(&self, quick: bool) -> Vec<Rung> {
        let counts: &[u32] = if quick {
            &[1, 4, 16]
        } else {
            &[1, 4, 16, 64, 256]
        };
        let rung = |samples, corrected| Rung {
            technique: self.key(),
            variant: "",
            steps: None,
            samples,
            corrected,
            configure: |_: &mut RenderSettings, _: &Rung| {},
        };
        let own = counts.iter().map(|samples| rung(*samples, false));
        let corrected = counts.iter().map(|samples| rung(*samples, true));
        own.chain(corrected).collect()
    }
}
