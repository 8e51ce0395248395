//! Lights other than emissive surfaces and the environment.

use glam::{DVec3, Vec3};

/// A light with a position or a direction.
#[derive(Debug, Clone, PartialEq)]
pub enum Light {
    /// Radiates alike in all directions.
    Point(PointLight),
    /// Radiates into a cone.
    Spot(SpotLight),
    /// Arrives from infinity along one direction.
    Directional(DirectionalLight),
}

impl Light {
    /// Name given by the user, or empty.
    pub fn name(&self) -> &str {
        match self {
            Self::Point(light) => &light.name,
            Self::Spot(light) => &light.name,
            Self::Directional(light) => &light.name,
        }
    }

    /// Whether surfaces block this light.
    pub fn casts_shadows(&self) -> bool {
        match self {
            Self::Point(light) => light.casts_shadows,
            Self::Spot(light) => light.casts_shadows,
            Self::Directional(light) => light.casts_shadows,
        }
    }

    /// Where its light comes from.
    pub fn place(&self) -> LightPlace {
        match self {
            Self::Point(light) => LightPlace::At(light.position),
            Self::Spot(light) => LightPlace::At(light.position),
            Self::Directional(light) => LightPlace::Infinity(light.direction),
        }
    }

    /// Where it is; `None` at infinity. Unit: m.
    pub fn position(&self) -> Option<DVec3> {
        match self.place() {
            LightPlace::At(position) => Some(position),
            LightPlace::Infinity(_) => None,
        }
    }

    /// Distances below this count as this in 1/d²; 0 at infinity. Unit: m.
    pub fn radius(&self) -> f32 {
        match self {
            Self::Point(light) => light.radius,
            Self::Spot(light) => light.radius,
            Self::Directional(_) => 0.0,
        }
    }

    /// Its intensity (W·sr⁻¹), or the irradiance of a light at infinity (W·m⁻²), per channel.
    pub fn strength(&self) -> [f32; 3] {
        match self {
            Self::Point(light) => light.intensity,
            Self::Spot(light) => light.intensity,
            Self::Directional(light) => light.irradiance,
        }
    }

    /// Whether it sends anything at all.
    pub fn is_lit(&self) -> bool {
        self.strength().iter().any(|channel| *channel > 0.0)
    }
}

/// Where a light's rays start.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LightPlace {
    /// At a point. Unit: m.
    At(DVec3),
    /// Infinitely far away, travelling along this unit direction.
    Infinity(Vec3),
}

/// Isotropic point light.
#[derive(Debug, Clone, PartialEq)]
pub struct PointLight {
    /// Name given by the user, or empty.
    pub name: String,
    /// Unit: m.
    pub position: DVec3,
    /// Unit: W·sr⁻¹ per channel; ≥ 0.
    pub intensity: [f32; 3],
    /// Distances below this count as this in 1/d². Unit: m; > 0.
    pub radius: f32,
    /// Whether surfaces block this light.
    pub casts_shadows: bool,
}

/// Point light restricted to a cone, glTF's angular falloff:
/// `clamp((cosθ − cos_outer) / (cos_inner − cos_outer), 0, 1)²`.
#[derive(Debug, Clone, PartialEq)]
pub struct SpotLight {
    /// Name given by the user, or empty.
    pub name: String,
    /// Unit: m.
    pub position: DVec3,
    /// Unit axis of the cone, along propagation.
    pub direction: Vec3,
    /// On the axis. Unit: W·sr⁻¹ per channel; ≥ 0.
    pub intensity: [f32; 3],
    /// Full intensity inside. Unit: radian. 0 ≤ inner < outer.
    pub inner_angle: f32,
    /// Dark outside. Unit: radian. Range: (0, π/2).
    pub outer_angle: f32,
    /// Distances below this count as this in 1/d². Unit: m; > 0.
    pub radius: f32,
    /// Whether surfaces block this light.
    pub casts_shadows: bool,
}

/// Parallel light from infinity.
#[derive(Debug, Clone, PartialEq)]
pub struct DirectionalLight {
    /// Name given by the user, or empty.
    pub name: String,
    /// Unit direction in which the light travels.
    pub direction: Vec3,
    /// On a plane perpendicular to `direction`. Unit: W·m⁻² per channel; ≥ 0.
    pub irradiance: [f32; 3],
    /// Whether surfaces block this light.
    pub casts_shadows: bool,
}
