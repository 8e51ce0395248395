//! Participating media.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use ts_rs::TS;

use super::phase::PhaseDescription;
use super::tagged::tagged_union;
use super::values::{Bounds, Rgb, Transform};

tagged_union! {
    /// One entry of `media`.
    pub enum MediumDescription {
        /// Equal everywhere inside its bounds, or in all of space.
        "homogeneous" => Homogeneous(HomogeneousMedium),
        /// Density `exp(−falloff · ⟨x − origin, up⟩)`.
        "height_fog" => HeightFog(HeightFogMedium),
        /// Density `1 − r²/R²` inside a sphere.
        "sphere" => Sphere(SphereMedium),
        /// A voxel grid in a file.
        "grid" => Grid(GridMedium),
        /// A voxel grid made from noise; no file.
        "procedural" => Procedural(ProceduralMedium),
    }
}

/// Defines a medium kind with the coefficients that all kinds have.
macro_rules! medium_kind {
    ($(#[$meta:meta])* pub struct $name:ident { $($fields:tt)* }) => {
        $(#[$meta])*
        #[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema, TS)]
        #[serde(deny_unknown_fields)]
        #[ts(optional_fields)]
        pub struct $name {
            /// Name for people and messages. At most 200 characters.
            #[serde(default, skip_serializing_if = "Option::is_none")]
            pub name: Option<String>,
            /// Scattering coefficient at density 1, together with `sigma_a`. Unit: m⁻¹.
            /// Range: 0 to 1e6.
            #[serde(default, skip_serializing_if = "Option::is_none")]
            pub sigma_s: Option<Rgb>,
            /// Absorption coefficient at density 1, together with `sigma_s`. Unit: m⁻¹.
            /// Range: 0 to 1e6.
            #[serde(default, skip_serializing_if = "Option::is_none")]
            pub sigma_a: Option<Rgb>,
            /// Extinction coefficient at density 1, together with `albedo`, instead of `sigma_s`
            /// and `sigma_a`. Unit: m⁻¹. Range: 0 to 1e6.
            #[serde(default, skip_serializing_if = "Option::is_none")]
            pub sigma_t: Option<Rgb>,
            /// Scattered share of `sigma_t`. Range: 0 to 1.
            #[serde(default, skip_serializing_if = "Option::is_none")]
            pub albedo: Option<Rgb>,
            /// Henyey–Greenstein mean cosine, +1 forward. Range: −0.999 to 0.999.
            #[serde(default)]
            pub g: f64,
            /// Phase function, instead of `g`.
            #[serde(default, skip_serializing_if = "Option::is_none")]
            pub phase: Option<PhaseDescription>,
            /// Emitted radiance per metre at density 1. Unit: W·m⁻³·sr⁻¹. Range: 0 to 1e9.
            #[serde(default = "zero")]
            pub emission: Rgb,
            /// Factor on all coefficients and the emission. Range: 0 to 1e6.
            #[serde(default = "one")]
            pub density_scale: f64,
            $($fields)*
        }

        impl $name {
            /// What all kinds of media have.
            fn coefficients(&self) -> Coefficients<'_> {
                Coefficients {
                    name: self.name.as_deref(),
                    sigma_s: self.sigma_s,
                    sigma_a: self.sigma_a,
                    sigma_t: self.sigma_t,
                    albedo: self.albedo,
                    g: self.g,
                    phase: self.phase.as_ref(),
                    emission: self.emission,
                    density_scale: self.density_scale,
                }
            }
        }
    };
}

medium_kind! {
    /// Equal everywhere inside its bounds, or in all of space.
    pub struct HomogeneousMedium {
        /// Where it is; all of space if left out.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        pub bounds: Option<Bounds>,
    }
}

medium_kind! {
    /// Exponential height fog.
    pub struct HeightFogMedium {
        /// In which the density falls; any length above 1e−6.
        #[serde(default = "super::camera::up")]
        pub up: [f64; 3],
        /// Unit: m⁻¹. Range: 0 to 1000.
        pub falloff: f64,
        /// A point where the density is 1. Unit: m.
        #[serde(default)]
        pub origin: [f64; 3],
        /// Where it is; all of space if left out.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        pub bounds: Option<Bounds>,
    }
}

medium_kind! {
    /// A soft ball.
    pub struct SphereMedium {
        /// Unit: m.
        pub center: [f64; 3],
        /// Unit: m. Range: 1e−6 to 1e6.
        pub radius: f64,
    }
}

medium_kind! {
    /// A voxel grid in a file. Formats that carry no placement fill the unit cube [0, 1]³ before
    /// `transform`.
    pub struct GridMedium {
        /// `.vdb`, `.nvdb`, `.vol`, `.npy`, `.npz` or `.raw`, relative to the scene's folder and
        /// inside it.
        pub path: String,
        /// Name of the grid in the file, where it holds several; `density` or the first one if
        /// left out. At most 200 characters.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        pub grid: Option<String>,
        /// Applied after the file's own placement; identity if left out.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        pub transform: Option<Transform>,
    }
}

medium_kind! {
    /// A voxel grid made from noise, with values from 0 to 1. Before `transform` it stands on
    /// y = 0, centred over the origin, and its longest side is 1 m.
    pub struct ProceduralMedium {
        /// What is made.
        pub pattern: ProceduralPattern,
        /// Another seed, another plume or cloud. Range: 0 to 2⁵³ − 1.
        #[serde(default)]
        #[ts(type = "number")]
        pub seed: u64,
        /// Voxels along the longest side. Range: 8 to 256.
        #[serde(default = "resolution")]
        pub resolution: u32,
        /// Octaves of noise, each of twice the frequency of the one before. Range: 1 to 8.
        #[serde(default = "octaves")]
        pub octaves: u32,
        /// Placement; identity if left out.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        pub transform: Option<Transform>,
    }
}

/// What a procedural grid shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema, TS)]
#[serde(rename_all = "snake_case")]
#[ts(rename_all = "snake_case")]
pub enum ProceduralPattern {
    /// Smoke that rises, widens and rolls: 2/3 × 1 × 2/3 m.
    SmokePlume,
    /// A cumulus with a flat base: 1 × 5/8 × 1 m.
    Cloud,
}

/// The members that all kinds of media have.
#[derive(Debug, Clone, Copy)]
#[allow(missing_docs, reason = "documented where the kinds are defined")]
pub struct Coefficients<'a> {
    pub name: Option<&'a str>,
    pub sigma_s: Option<Rgb>,
    pub sigma_a: Option<Rgb>,
    pub sigma_t: Option<Rgb>,
    pub albedo: Option<Rgb>,
    pub g: f64,
    pub phase: Option<&'a PhaseDescription>,
    pub emission: Rgb,
    pub density_scale: f64,
}

impl MediumDescription {
    /// What all kinds of media have.
    pub fn coefficients(&self) -> Coefficients<'_> {
        match self {
            Self::Homogeneous(medium) => medium.coefficients(),
            Self::HeightFog(medium) => medium.coefficients(),
            Self::Sphere(medium) => medium.coefficients(),
            Self::Grid(medium) => medium.coefficients(),
            Self::Procedural(medium) => medium.coefficients(),
        }
    }
}

fn zero() -> Rgb {
    Rgb::grey(0.0)
}

fn one() -> f64 {
    1.0
}

fn resolution() -> u32 {
    128
}

fn octaves() -> u32 {
    5
}
