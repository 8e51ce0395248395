//! How to render: technique, size, when to stop.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use ts_rs::TS;

pub use crate::scene::{
    CorrectionMode, LevelFetch, MediumOrder, ReferenceSettings, ScreenSpaceFilter,
    ScreenSpaceSettings, ShadowMode, ShadowSettings, SingleScatteringSettings, SpreadModel,
    Technique,
};

/// How to render.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema, TS)]
#[serde(deny_unknown_fields, default)]
#[ts(optional_fields)]
pub struct RenderDescription {
    /// What transports the light.
    pub technique: Technique,
    /// Unit: pixel. Range: 1 to 16384.
    pub width: u32,
    /// Unit: pixel. Range: 1 to 16384.
    pub height: u32,
    /// Finished after so many samples a pixel. Range: 1 to 65536. 64 if no rule is given; at most
    /// one of `samples`, `time_seconds` and `relative_error`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub samples: Option<u32>,
    /// Finished after so many seconds of rendering. Unit: s. Range: 0.001 to 1e6.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub time_seconds: Option<f64>,
    /// Finished when the estimated relative error falls below this. Range: 1e−5 to 1.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub relative_error: Option<f64>,
    /// When traced samples correct the technique's picture. If left out: `always`, but `off` for the
    /// `reference`, which they are all of.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub correction: Option<CorrectionMode>,
    /// Seed of every random number. Range: 0 to 2⁵³ − 1, which every JSON reader keeps exactly.
    #[ts(type = "number")]
    pub seed: u64,
    /// Settings of the `single_scattering` march.
    pub single_scattering: SingleScatteringSettings,
    /// Settings of the `screen_space` filter.
    pub screen_space: ScreenSpaceSettings,
    /// Which paths the `reference` counts.
    pub reference: ReferenceSettings,
    /// How visibility toward lights is found.
    pub shadows: ShadowSettings,
}

impl Default for RenderDescription {
    fn default() -> Self {
        Self {
            technique: Technique::Auto,
            width: 1280,
            height: 720,
            samples: None,
            time_seconds: None,
            relative_error: None,
            correction: None,
            seed: 0,
            single_scattering: SingleScatteringSettings::default(),
            screen_space: ScreenSpaceSettings::default(),
            reference: ReferenceSettings::default(),
            shadows: ShadowSettings::default(),
        }
    }
}
