//! How to render: technique, size, when to stop.
//!
//! What a description says word for word stands here once, with the names and texts of the format.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use ts_rs::TS;

use super::screen_space::ScreenSpaceSettings;

/// How to render: technique, size, when to stop.
#[derive(Debug, Clone, PartialEq)]
pub struct RenderSettings {
    /// What transports the light.
    pub technique: Technique,
    /// Pixels. Range: [1, 16384].
    pub width: u32,
    /// Pixels. Range: [1, 16384].
    pub height: u32,
    /// When a still picture is finished.
    pub stop: StopRule,
    /// When traced samples correct the technique's picture.
    pub correction: CorrectionMode,
    /// Seed of every random number.
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

/// What transports the light.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize, JsonSchema, TS)]
#[serde(rename_all = "snake_case")]
pub enum Technique {
    /// The planner picks.
    Auto,
    /// Surfaces direct and exactly one scattering in the medium.
    SingleScattering,
    /// Virtual point lights on surfaces and in the medium.
    InstantVpl,
    /// Propagation grids aligned with light directions.
    PrincipalOrdinates,
    /// Filtering of scattered radiance in the picture.
    ScreenSpace,
    /// The unbiased path tracer.
    Reference,
}

impl Technique {
    /// The technique's one name: JSON key, file, metric label.
    pub fn name(self) -> &'static str {
        match self {
            Self::Auto => "auto",
            Self::SingleScattering => "single_scattering",
            Self::InstantVpl => "instant_vpl",
            Self::PrincipalOrdinates => "principal_ordinates",
            Self::ScreenSpace => "screen_space",
            Self::Reference => "reference",
        }
    }
}

/// When unbiased traced samples correct the technique's picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize, JsonSchema, TS)]
#[serde(rename_all = "snake_case")]
pub enum CorrectionMode {
    /// Never: the technique's own picture.
    Off,
    /// Where nothing moves.
    AtRest,
    /// In every frame.
    Always,
}

/// When a still picture is finished.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum StopRule {
    /// After so many accumulated samples a pixel. Range: [1, 65536].
    Samples(u32),
    /// After so many seconds of rendering.
    Seconds(f32),
    /// When the estimated relative error falls below this.
    RelativeError(f32),
}

/// Settings of the ray march.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema, TS)]
#[serde(rename = "SingleScattering", deny_unknown_fields, default)]
pub struct SingleScatteringSettings {
    /// Strata a ray, each sampled once. Range: 1 to 4096.
    pub steps: u32,
    /// Random position inside each stratum; otherwise its midpoint.
    pub jitter: bool,
    /// Side of the tile of pixels that share the strata of one ray: 1, 2, 4 or 8. Above 1, each pixel
    /// takes its share of them and gathers the rest from its neighbours. 0 is what is faster on the device: 4
    /// on a software driver, which errs by less than 1 % more, 1 on a GPU.
    pub interleave: u32,
    /// March one of every 2×2 pixels and interpolate between those that end at a pixel's distance; what
    /// has none, or lies at an edge of a shaft, is marched itself. Every sample takes another of the four.
    pub half_resolution: bool,
    /// Half of the strata of lights with a position equiangular about them, weighted by the balance
    /// heuristic: less noise near lights.
    pub equiangular: bool,
}

impl Default for SingleScatteringSettings {
    fn default() -> Self {
        Self {
            steps: 32,
            jitter: true,
            interleave: 0,
            half_resolution: false,
            equiangular: false,
        }
    }
}

/// Which paths the `reference` counts; all of them if nothing is said.
///
/// A path from the camera over k points to a light has k scatterings, on surfaces or in media.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema, TS)]
#[serde(rename = "Reference", deny_unknown_fields, default)]
#[ts(optional_fields)]
pub struct ReferenceSettings {
    /// Most scatterings of a path, k; unlimited if left out. Range: 0 to 65535.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub max_scatterings: Option<u32>,
    /// Most scatterings on surfaces; unlimited if left out. Range: 0 to 65535.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub max_surface_scatterings: Option<u32>,
    /// How often a path scatters in media.
    pub medium_order: MediumOrder,
}

/// How often a path scatters in media.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize, JsonSchema, TS,
)]
#[serde(rename_all = "snake_case")]
pub enum MediumOrder {
    /// Any number of times.
    #[default]
    All,
    /// Never: what surfaces and emission send, attenuated.
    None,
    /// Exactly once.
    Single,
    /// At least twice.
    Multiple,
}

/// How visibility toward lights is found.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema, TS)]
#[serde(rename = "Shadows", deny_unknown_fields, default)]
pub struct ShadowSettings {
    /// Method.
    pub mode: ShadowMode,
    /// Side of a shadow map. Unit: texel. Range: 16 to 8192.
    pub resolution: u32,
}

impl Default for ShadowSettings {
    fn default() -> Self {
        Self {
            mode: ShadowMode::Mapped,
            resolution: 1024,
        }
    }
}

/// Method of visibility.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize, JsonSchema, TS)]
#[serde(rename_all = "snake_case")]
pub enum ShadowMode {
    /// Every light sees everything.
    Off,
    /// Rasterized depth maps.
    Mapped,
    /// Rays through the geometry: exact, slower.
    Traced,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn techniques_are_called_as_in_json() {
        for technique in [
            Technique::Auto,
            Technique::SingleScattering,
            Technique::InstantVpl,
            Technique::PrincipalOrdinates,
            Technique::ScreenSpace,
            Technique::Reference,
        ] {
            let name = technique.name();
            assert_eq!(serde_json::to_value(technique).unwrap(), name);
        }
    }
}
