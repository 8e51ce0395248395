//! What a plan follows from.

use tyndall_scene::{RenderSettings, SceneFacts, ShadowMode};

/// What the device and the picture's size allow.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[allow(
    clippy::struct_excessive_bools,
    reason = "independent facts about a device and a picture"
)]
pub struct PlanLimits {
    /// The driver stops an invocation after so many loop iterations.
    pub loop_cap: Option<u32>,
    /// The picture has more pixels than the correction's buffers may hold.
    pub beyond_correction: bool,
    /// Every light is marched along every ray, and every ray takes all strata: to measure what leaving
    /// some out saves.
    pub unskipped: bool,
    /// Whether a processor renders, without a GPU.
    pub software: bool,
    /// Whether long frames are submitted in parts.
    pub in_parts: bool,
}

/// Everything that a plan may depend on: equal inputs give equal plans.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PlanInput<'a> {
    pub facts: &'a SceneFacts,
    pub settings: &'a RenderSettings,
    pub limits: PlanLimits,
    /// Why traced samples don't correct the picture, if they don't.
    pub uncorrected: Option<&'static str>,
}

impl PlanInput<'_> {
    /// Lights with a position or a direction.
    pub fn lights(&self) -> usize {
        self.facts.lights()
    }

    /// Loop iterations that the light of all lights at one point takes at most: their optical depths
    /// through all media, and shadow rays, which visit tens of nodes; the bound leaves room for hundreds.
    pub fn iterations_a_point(&self) -> u64 {
        let ray = if self.settings.shadows.mode == ShadowMode::Traced {
            400
        } else {
            0
        };
        let media = self.facts.media.max(1) as u64;
        let grids = self.facts.grids as u64 * u64::from(self.facts.voxels_across);
        1 + 2 * media + grids + self.lights().max(1) as u64 * (1 + 3 * media + ray)
    }

    /// Whether traced samples correct the picture.
    pub fn is_corrected(&self) -> bool {
        self.uncorrected.is_none()
    }

    /// How visibility toward lights is found: not at all where nothing can stand in the way.
    pub fn visibility(&self) -> ShadowMode {
        if self.facts.shadow_casters == 0 || self.facts.triangles == 0 {
            ShadowMode::Off
        } else {
            self.settings.shadows.mode
        }
    }

    /// The feature of shaders that ask for visibility, if any.
    pub fn visibility_feature(&self) -> Option<&'static str> {
        match self.visibility() {
            ShadowMode::Off => None,
            ShadowMode::Mapped => Some("mapped"),
            ShadowMode::Traced => Some("traced"),
        }
    }
}
