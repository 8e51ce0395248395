//! Phase functions of media.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use ts_rs::TS;

use super::tagged::tagged_union;
use crate::scene::PhaseFunction;

tagged_union! {
    /// `phase` of a medium: into which directions it scatters.
    pub enum PhaseDescription {
        /// One lobe, as `g` of the medium gives it.
        "henyey_greenstein" => HenyeyGreenstein(HenyeyGreensteinPhase),
        /// The sum of two such lobes, as clouds have: one forward, one backward.
        "two_lobes" => TwoLobes(TwoLobesPhase),
    }
}

/// One lobe.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema, TS)]
#[serde(deny_unknown_fields)]
pub struct HenyeyGreensteinPhase {
    /// Mean cosine, +1 forward. Range: −0.999 to 0.999.
    pub g: f64,
}

/// Two lobes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema, TS)]
#[serde(deny_unknown_fields)]
pub struct TwoLobesPhase {
    /// Mean cosine of the forward lobe. Range: −0.999 to 0.999.
    pub g_forward: f64,
    /// Mean cosine of the backward lobe. Range: −0.999 to 0.999.
    pub g_backward: f64,
    /// Share of the light that the forward lobe scatters. Range: 0 to 1.
    pub forward_share: f64,
}

impl From<&PhaseDescription> for PhaseFunction {
    fn from(description: &PhaseDescription) -> Self {
        match description {
            PhaseDescription::HenyeyGreenstein(phase) => {
                Self::HenyeyGreenstein { g: phase.g as f32 }
            }
            PhaseDescription::TwoLobes(phase) => Self::TwoLobes {
                g_forward: phase.g_forward as f32,
                g_backward: phase.g_backward as f32,
                forward_share: phase.forward_share as f32,
            },
        }
    }
}
