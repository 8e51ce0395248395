//! Participating media: coefficients, and where they are.

use glam::{DAffine3, DVec3, Vec3};

use super::grid::SharedGrid;
use super::phase::PhaseFunction;
use super::space::Aabb;

/// One participating medium.
#[derive(Debug, Clone, PartialEq)]
pub struct Medium {
    /// Name given by the user, or empty.
    pub name: String,
    /// Scattering coefficient where the relative density is 1. Unit: m⁻¹ per channel; ≥ 0.
    pub sigma_s: [f32; 3],
    /// Absorption coefficient where the relative density is 1. Unit: m⁻¹ per channel; ≥ 0.
    pub sigma_a: [f32; 3],
    /// Into which directions it scatters.
    pub phase: PhaseFunction,
    /// Emitted radiance per metre where the relative density is 1. Unit: W·m⁻³·sr⁻¹.
    pub emission: [f32; 3],
    /// Where it is and how its relative density varies.
    pub shape: MediumShape,
}

/// Spatial distribution of a medium's relative density.
#[derive(Debug, Clone, PartialEq)]
pub enum MediumShape {
    /// Density 1 inside the bounds, or everywhere.
    Homogeneous {
        /// `None` fills space.
        bounds: Option<Aabb>,
    },
    /// Density `exp(−falloff · ⟨x − origin, up⟩)` inside the bounds, or everywhere.
    HeightFog {
        /// Unit direction in which the density falls.
        up: Vec3,
        /// Unit: m⁻¹; ≥ 0.
        falloff: f32,
        /// A point where the density is 1. Unit: m.
        origin: DVec3,
        /// `None` fills space.
        bounds: Option<Aabb>,
    },
    /// Density `1 − r²/R²` inside the sphere.
    Sphere {
        /// Unit: m.
        center: DVec3,
        /// R. Unit: m; > 0.
        radius: f64,
    },
    /// Density of a voxel grid, trilinear between its samples, 0 outside its clip box.
    Grid {
        /// Samples. Compared by identity, not by content.
        grid: SharedGrid,
        /// From lattice points to the world: the description's transform after the grid's own
        /// placement. Unit: m. Invertible.
        world_from_lattice: DAffine3,
    },
}
