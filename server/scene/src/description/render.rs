//! How to render: technique, size, when to stop.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use ts_rs::TS;

use crate::scene;

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
    pub single_scattering: SingleScattering,
    /// Which paths the `reference` counts.
    pub reference: Reference,
    /// How visibility toward lights is found.
    pub shadows: Shadows,
}

/// When unbiased traced samples correct the technique's picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema, TS)]
#[serde(rename_all = "snake_case")]
pub enum CorrectionMode {
    /// Never: the technique's own picture.
    Off,
    /// Where nothing moves.
    AtRest,
    /// In every frame.
    Always,
}

/// Settings of the ray march.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema, TS)]
#[serde(deny_unknown_fields, default)]
pub struct SingleScattering {
    /// Strata a ray, each sampled once. Range: 1 to 4096.
    pub steps: u32,
    /// Random position inside each stratum; otherwise its midpoint.
    pub jitter: bool,
    /// Side of the tile of pixels that share the strata of one ray: 1, 2, 4 or 8. Above 1, each pixel
    /// takes its share of them and gathers the rest from its neighbours.
    pub interleave: u32,
    /// March one of every 2×2 pixels and interpolate between those that end at a pixel's distance; what
    /// has none, or lies at an edge of a shaft, is marched itself. Every sample takes another of the four.
    pub half_resolution: bool,
    /// Half of the strata of lights with a position equiangular about them, weighted by the balance
    /// heuristic: less noise near lights.
    pub equiangular: bool,
}

/// Which paths the `reference` counts; all of them if nothing is said.
///
/// A path from the camera over k points to a light has k scatterings, on surfaces or in media.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema, TS)]
#[serde(deny_unknown_fields, default)]
#[ts(optional_fields)]
pub struct Reference {
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
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema, TS)]
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
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema, TS)]
#[serde(deny_unknown_fields, default)]
pub struct Shadows {
    /// Method.
    pub mode: ShadowMode,
    /// Side of a shadow map. Unit: texel. Range: 16 to 8192.
    pub resolution: u32,
}

/// What transports the light.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema, TS)]
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

/// Method of visibility.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema, TS)]
#[serde(rename_all = "snake_case")]
pub enum ShadowMode {
    /// Every light sees everything.
    Off,
    /// Rasterized depth maps.
    Mapped,
    /// Rays through the geometry: exact, slower.
    Traced,
}

impl Default for RenderDescription {
    fn default() -> Self {
        Self {
            technique: Technique::SingleScattering,
            width: 1280,
            height: 720,
            samples: None,
            time_seconds: None,
            relative_error: None,
            correction: None,
            seed: 0,
            single_scattering: SingleScattering::default(),
            reference: Reference::default(),
            shadows: Shadows::default(),
        }
    }
}

impl Default for SingleScattering {
    fn default() -> Self {
        Self {
            steps: 32,
            jitter: true,
            interleave: 1,
            half_resolution: false,
            equiangular: false,
        }
    }
}

impl Default for Shadows {
    fn default() -> Self {
        Self {
            mode: ShadowMode::Mapped,
            resolution: 1024,
        }
    }
}

impl Technique {
    /// [`scene::Technique::name`].
    pub fn name(self) -> &'static str {
        scene::Technique::from(self).name()
    }
}

impl From<Technique> for scene::Technique {
    fn from(technique: Technique) -> Self {
        match technique {
            Technique::Auto => Self::Auto,
            Technique::SingleScattering => Self::SingleScattering,
            Technique::InstantVpl => Self::InstantVpl,
            Technique::PrincipalOrdinates => Self::PrincipalOrdinates,
            Technique::ScreenSpace => Self::ScreenSpace,
            Technique::Reference => Self::Reference,
        }
    }
}

impl From<CorrectionMode> for scene::CorrectionMode {
    fn from(mode: CorrectionMode) -> Self {
        match mode {
            CorrectionMode::Off => Self::Off,
            CorrectionMode::AtRest => Self::AtRest,
            CorrectionMode::Always => Self::Always,
        }
    }
}

impl From<ShadowMode> for scene::ShadowMode {
    fn from(mode: ShadowMode) -> Self {
        match mode {
            ShadowMode::Off => Self::Off,
            ShadowMode::Mapped => Self::Mapped,
            ShadowMode::Traced => Self::Traced,
        }
    }
}

impl From<MediumOrder> for scene::MediumOrder {
    fn from(order: MediumOrder) -> Self {
        match order {
            MediumOrder::All => Self::All,
            MediumOrder::None => Self::None,
            MediumOrder::Single => Self::Single,
            MediumOrder::Multiple => Self::Multiple,
        }
    }
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
