//! Rules of phase functions.

use super::rules;
use crate::description::phase::PhaseDescription;
use crate::error::SceneError;
use crate::json_path::JsonPath;

/// Largest magnitude of a lobe's mean cosine; beyond it the lobe is a spike that no sampler resolves.
pub(super) const G: f64 = 0.999;

pub(super) fn check(phase: &PhaseDescription, path: &JsonPath) -> Result<(), SceneError> {
    match phase {
        PhaseDescription::HenyeyGreenstein(phase) => rules::range(&path.field("g"), phase.g, -G, G),
        PhaseDescription::TwoLobes(phase) => {
            rules::range(&path.field("g_forward"), phase.g_forward, -G, G)?;
            rules::range(&path.field("g_backward"), phase.g_backward, -G, G)?;
            rules::range(&path.field("forward_share"), phase.forward_share, 0.0, 1.0)
        }
    }
}
