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
    }
}

/// One lobe.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema, TS)]
#[serde(deny_unknown_fields)]
pub struct HenyeyGreensteinPhase {
    /// Mean cosine, +1 forward. Range: −0.999 to 0.999.
    pub g: f64,
}

impl From<&PhaseDescription> for PhaseFunction {
    fn from(description: &PhaseDescription) -> Self {
        match description {
            PhaseDescription::HenyeyGreenstein(phase) => {
                Self::HenyeyGreenstein { g: phase.g as f32 }
            }
        }
    }
}
