//! Order 1 of the partition: light of lights that the media scatter exactly once. Techniques that show other
//! orders ask for it here, and none of them for another technique.

use super::single_scattering;
use crate::frame::{FramePlan, PlanInput};
use crate::stages::film::Layer;

/// Plans it; what it adds to the film, if anything. The light of surfaces must be planned before.
pub(super) fn plan(plan: &mut FramePlan, input: &PlanInput<'_>) -> Option<Layer> {
    single_scattering::plan_in_scatter(plan, input)
}
