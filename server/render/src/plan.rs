//! What one frame does, and why: the technique's passes, then what every picture gets. Pure: equal
//! inputs give equal plans.

use tyndall_scene::{RenderSettings, SceneFacts};

use crate::correction;
use crate::error::NotRenderedYet;
use crate::frame::{FramePlan, PlanInput, PlanLimits};
use crate::stages::film::FILM;
use crate::stages::{estimate, tonemap};
use crate::techniques;
use crate::techniques::reference::paths;

/// Decides what a frame of a scene with these facts does.
///
/// # Errors
/// [`NotRenderedYet`] for a technique that is not rendered yet.
pub fn plan(
    facts: &SceneFacts,
    settings: &RenderSettings,
    limits: &PlanLimits,
) -> Result<FramePlan, NotRenderedYet> {
    let technique = techniques::of(settings.technique)
        .ok_or_else(|| NotRenderedYet::technique(settings.technique))?;
    let traced = technique.is_traced();
    let input = PlanInput {
        facts,
        settings,
        limits: *limits,
        uncorrected: correction::without_correction(facts, settings, *limits, traced),
    };
    let mut plan = FramePlan::default();
    technique.plan(&input, &mut plan);
    match input.uncorrected {
        None => {
            if !traced {
                paths::plan(&mut plan, &input);
            }
            correction::plan(&mut plan, &input, !traced);
        }
        Some(why) => plan_uncorrected(&mut plan, traced, why),
    }
    tonemap::plan(&mut plan);
    Ok(plan)
}

/// Plans the estimate of the error of traced samples by themselves; no other technique knows its own.
fn plan_uncorrected(plan: &mut FramePlan, traced: bool, why: &str) {
    if !traced {
        plan.skip(paths::PASS, "", "no correction");
    }
    plan.skip(correction::PASS, "", why);
    if traced {
        estimate::plan(
            plan,
            false,
            [FILM.read(), paths::MOMENTS.read(), paths::EVEN_MEANS.read()],
            "error of the mean from its two halves",
        );
    } else {
        plan.skip(estimate::PASS, "", "the technique does not know its error");
    }
}
