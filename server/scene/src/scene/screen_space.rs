//! Settings of the technique that filters the picture.
//!
//! What a description says word for word stands here once, with the names and texts of the format.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use ts_rs::TS;

/// Settings of the `screen_space` filter.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema, TS)]
#[serde(rename = "ScreenSpace", deny_unknown_fields, default)]
#[allow(
    clippy::struct_excessive_bools,
    reason = "independent remedies, not the states of a machine"
)]
pub struct ScreenSpaceSettings {
    /// How scattered light is spread over the picture.
    pub filter: ScreenSpaceFilter,
    /// How widely a pixel's light is spread.
    pub spread: SpreadModel,
    /// Side of the kernel between two levels of the picture. Range: 2, 4 or 6. Unit: pixel.
    pub kernel: u32,
    /// How `hierarchical` reads its levels.
    pub fetch: LevelFetch,
    /// `hierarchical`: spreads are averaged by the luminance of what is spread.
    pub luminance_weighting: bool,
    /// `hierarchical`: light that is spread little stays out of coarse levels.
    pub masking: bool,
    /// `hierarchical`: the spreads themselves are blurred, which softens edges of depth.
    pub density_blur: bool,
    /// `hierarchical`: bright pixels that are spread little are filtered apart.
    pub separation: bool,
    /// Luminance above which they count as bright. Unit: W·m⁻²·sr⁻¹. Range: 0 to 1e6.
    pub separation_luminance: f64,
    /// Scattering depth below which they are spread little. Range: 0 to 100.
    pub separation_depth: f64,
    /// Light of lights that the media scatter once toward the eye is added, with its shadows, as
    /// `single_scattering` marches it. Otherwise the media only glow.
    pub in_scatter: bool,
    /// Radiance that arrives in the media from everywhere, beside what the picture shows.
    /// Unit: W·m⁻²·sr⁻¹. Range: 0 to 1e6.
    pub ambient: [f64; 3],
}

impl Default for ScreenSpaceSettings {
    fn default() -> Self {
        Self {
            filter: ScreenSpaceFilter::Splat,
            spread: SpreadModel::ExactMoments,
            kernel: 4,
            fetch: LevelFetch::LinearBicubic,
            luminance_weighting: true,
            masking: true,
            density_blur: true,
            separation: false,
            separation_luminance: 4.0,
            separation_depth: 0.5,
            in_scatter: true,
            ambient: [0.0; 3],
        }
    }
}

/// How scattered light is spread over the picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize, JsonSchema, TS)]
#[serde(rename_all = "snake_case")]
pub enum ScreenSpaceFilter {
    /// Each pixel's light goes to the two levels of a pyramid between which its spread lies: nothing is
    /// lost, and what is near does not leak into what is far.
    Splat,
    /// Each pixel reads the level of the picture that its own spread asks for (Iser 2018).
    Hierarchical,
    /// Each pixel gathers every other one's light by its exact kernel: slow, to check the others.
    Gather,
}

/// How widely a pixel's light is spread.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize, JsonSchema, TS)]
#[serde(rename_all = "snake_case")]
pub enum SpreadModel {
    /// Premože et al. 2004, as Elek et al. 2013 and Iser 2018 have it.
    Premoze,
    /// The variance of scattered light by the exact moments of multiple scattering (Lewis 1950).
    ExactMoments,
}

/// How levels of the picture are read: between levels, and between the pixels of one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize, JsonSchema, TS)]
#[serde(rename_all = "snake_case")]
pub enum LevelFetch {
    /// Two levels of four pixels.
    LinearBilinear,
    /// Two levels of 4×4 pixels, by the cubic B-spline.
    LinearBicubic,
    /// Four levels of 4×4 pixels.
    CubicBicubic,
}
