//! What every technique answers.

use tyndall_scene::{Scene, SceneFacts};

use super::claim::Claim;
use super::rung::Rung;
use crate::frame::{FramePlan, PlanInput, PlanLimits};

/// A way of making a picture.
pub(crate) trait Technique: Sync {
    /// Which of the scene description's techniques it is.
    fn key(&self) -> tyndall_scene::Technique;

    /// Which paths its picture shows, and how it is biased.
    fn claim(&self) -> Claim;

    /// What of a scene it cannot render: JSON paths with a remark each.
    fn unsupported(&self, scene: &Scene) -> Vec<String>;

    /// Why the device cannot run it, if so.
    fn device_refusal(&self, facts: &SceneFacts, limits: PlanLimits) -> Option<String> {
        let _ = (facts, limits);
        None
    }

    /// Plans its passes, up to the mean of its samples.
    fn plan(&self, input: &PlanInput<'_>, plan: &mut FramePlan);

    /// Whether its own samples are the traced ones, so that no others correct them.
    fn is_traced(&self) -> bool {
        false
    }

    /// Settings that are worth measuring, cheapest first; fewer if `quick`.
    fn ladder(&self, quick: bool) -> Vec<Rung>;
}
