//! The picture's light, attenuated and spread over the picture as the media between would spread it.
//!
//! Source: Iser 2018, on Elek, Ritschel and Seidel 2013, with the corrections of `shaders/wesl/techniques/
//! screen_space/`: density integrals without divisions, spreads seen from the surface's distance in pixels,
//! and a splat pyramid, which loses no light, beside the paper's hierarchical filter. Light of lights that the
//! media scatter once is marched as in `single_scattering`, while the filter spreads what leaves surfaces and
//! the sky. Where emitters' and the sky's light that is scattered once is added, the filter leaves that out.
//! Bias: scattering is taken to be forward, so none of the surfaces' light is turned away from the eye; one
//! Gaussian stands for all orders, by densities along the camera ray alone; what lies outside the picture or
//! behind something else adds nothing; light that lights scatter more than once in the media is missing, and
//! surfaces are lit directly. Cost: a few reads a pixel whatever the scene holds, and the march. Planned where
//! media scatter; otherwise attenuation is exact and nothing is filtered.

mod filter;
mod ladder;
mod levels;
mod passes;

use tyndall_scene::{Scene, ScreenSpaceFilter, ShadowMode};

use super::technique::Technique;
use super::{Claim, Paths, Rung};
use crate::frame::{FramePlan, PlanInput};
use crate::stages::surfaces::Place;
use crate::stages::{area_lights, film, in_scatter, light_volume, surfaces, visibility};

/// The technique.
pub(super) struct ScreenSpace;

impl Technique for ScreenSpace {
    fn key(&self) -> tyndall_scene::Technique {
        tyndall_scene::Technique::ScreenSpace
    }

    fn claim(&self) -> Claim {
        Claim {
            paths: Paths::Whole,
            bias: "scattering is forward and Gaussian, of what the picture shows; lights scatter once",
        }
    }

    fn unsupported(&self, scene: &Scene) -> Vec<String> {
        let mut fields = Vec::new();
        let materials = &scene.geometry.materials;
        let masked = materials.iter().any(|m| m.alpha_cutoff.is_some());
        if masked && scene.render.shadows.mode == ShadowMode::Traced {
            fields.push("render.shadows.mode: traced, with alpha-masked materials".into());
        }
        let [width, height] = [scene.render.width, scene.render.height];
        let gathers = scene.render.screen_space.filter == ScreenSpaceFilter::Gather;
        if gathers && u64::from(width) * u64::from(height) > levels::MOST_GATHERED {
            fields.push(format!(
                "render.screen_space.filter: gather, for more than {} pixels",
                levels::MOST_GATHERED
            ));
        }
        fields
    }

    fn plan(&self, input: &PlanInput<'_>, plan: &mut FramePlan) {
        visibility::plan(plan, input);
        surfaces::plan_gbuffer(plan, input);
        light_volume::plan(plan, input);
        let place = match passes::nothing_to_filter(input) {
            None => Place::Surface,
            Some(why) => {
                plan.skip(filter::PASS, "", why);
                Place::Eye
            }
        };
        surfaces::plan_shade(plan, input, place);
        let area = area_lights::plan(plan, input, place);
        let scatters_lights = input.settings.screen_space.in_scatter;
        // What the film adds of area lights: all of it, or what the media scatter of them.
        let area = if place == Place::Surface {
            let wanted = scatters_lights.then(|| area_lights::plan_media(plan, input));
            let in_media = wanted.flatten();
            passes::plan(plan, input, area, in_media.is_some());
            in_media
        } else {
            area
        };
        let of_lights = if scatters_lights {
            in_scatter::plan(plan, input)
        } else {
            plan.skip(filter::PASS, "in_scatter", "off: media only glow");
            None
        };
        let layers: Vec<_> = of_lights.into_iter().chain(area).collect();
        film::plan(plan, film::of_technique(input), &layers);
    }

    fn ladder(&self, quick: bool) -> Vec<Rung> {
        ladder::rungs(quick)
    }
}
