//! Light sources other than emissive surfaces.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use ts_rs::TS;

use super::tagged::tagged_union;
use super::values::Rgb;

tagged_union! {
    /// One entry of `lights`.
    pub enum LightDescription {
        /// Radiates alike in all directions.
        "point" => Point(PointLightDescription),
        /// Radiates into a cone.
        "spot" => Spot(SpotLightDescription),
        /// Arrives from infinity along one direction.
        "directional" => Directional(DirectionalLightDescription),
        /// Arrives from infinity from everywhere. At most one.
        "environment" => Environment(EnvironmentDescription),
    }
}

/// Defines a light kind with the members that all kinds have.
macro_rules! light_kind {
    ($(#[$meta:meta])* pub struct $name:ident { $($fields:tt)* }) => {
        $(#[$meta])*
        #[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema, TS)]
        #[serde(deny_unknown_fields)]
        #[ts(optional_fields)]
        pub struct $name {
            /// Name for people and messages. At most 200 characters.
            #[serde(default, skip_serializing_if = "Option::is_none")]
            pub name: Option<String>,
            $($fields)*
        }
    };
}

light_kind! {
    /// Isotropic point light.
    pub struct PointLightDescription {
        /// Unit: m.
        pub position: [f64; 3],
        /// Unit: W·sr⁻¹. Range: 0 to 1e12.
        pub intensity: Rgb,
        /// Distances below this count as this in 1/d². Unit: m. Range: 1e−4 to 1000.
        #[serde(default = "radius")]
        pub radius: f64,
        /// Whether surfaces block this light.
        #[serde(default = "yes")]
        pub casts_shadows: bool,
        /// Where it is at which time, in order of time; replaces the pose above.
        #[serde(default, skip_serializing_if = "Vec::is_empty")]
        #[ts(optional, as = "Option<Vec<PositionKeyframe>>")]
        pub keyframes: Vec<PositionKeyframe>,
    }
}

light_kind! {
    /// Point light restricted to a cone, with glTF's angular falloff.
    pub struct SpotLightDescription {
        /// Unit: m.
        pub position: [f64; 3],
        /// Axis of the cone, along propagation; any length above 1e−6.
        pub direction: [f64; 3],
        /// On the axis. Unit: W·sr⁻¹. Range: 0 to 1e12.
        pub intensity: Rgb,
        /// Full intensity inside. Unit: degree. Range: 0 to `outer_angle_degrees` − 0.01.
        #[serde(default)]
        pub inner_angle_degrees: f64,
        /// Dark outside. Unit: degree. Range: 0.1 to 89.9.
        #[serde(default = "outer_angle_degrees")]
        pub outer_angle_degrees: f64,
        /// Distances below this count as this in 1/d². Unit: m. Range: 1e−4 to 1000.
        #[serde(default = "radius")]
        pub radius: f64,
        /// Whether surfaces block this light.
        #[serde(default = "yes")]
        pub casts_shadows: bool,
        /// Where it is at which time, in order of time; replaces the pose above.
        #[serde(default, skip_serializing_if = "Vec::is_empty")]
        #[ts(optional, as = "Option<Vec<SpotKeyframe>>")]
        pub keyframes: Vec<SpotKeyframe>,
    }
}

light_kind! {
    /// Parallel light from infinity.
    pub struct DirectionalLightDescription {
        /// In which the light travels; any length above 1e−6.
        pub direction: [f64; 3],
        /// On a plane perpendicular to `direction`. Unit: W·m⁻². Range: 0 to 1e9.
        pub irradiance: Rgb,
        /// Whether surfaces block this light.
        #[serde(default = "yes")]
        pub casts_shadows: bool,
        /// Where it is at which time, in order of time; replaces the pose above.
        #[serde(default, skip_serializing_if = "Vec::is_empty")]
        #[ts(optional, as = "Option<Vec<DirectionKeyframe>>")]
        pub keyframes: Vec<DirectionKeyframe>,
    }
}

light_kind! {
    /// Radiance from infinity.
    pub struct EnvironmentDescription {
        /// Multiplies the map, or is the radiance itself. Unit: W·m⁻²·sr⁻¹. Range: 0 to 1e9.
        #[serde(default = "one")]
        pub radiance: Rgb,
        /// Equirectangular `.hdr` or `.exr`, relative to the scene's folder and inside it.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        pub map: Option<String>,
        /// Rotation of the map about +Y. Unit: degree. Range: −360 to 360.
        #[serde(default)]
        pub rotation_degrees: f64,
    }
}

/// A light's position at one time.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema, TS)]
#[serde(deny_unknown_fields)]
pub struct PositionKeyframe {
    /// Later than the keyframe before. Unit: s. Range: 0 to 1e6.
    pub time_seconds: f64,
    /// Unit: m. Linear in between.
    pub position: [f64; 3],
}

/// A spot light's pose at one time.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema, TS)]
#[serde(deny_unknown_fields)]
pub struct SpotKeyframe {
    /// Later than the keyframe before. Unit: s. Range: 0 to 1e6.
    pub time_seconds: f64,
    /// Unit: m. Linear in between.
    pub position: [f64; 3],
    /// Axis of the cone, along propagation; any length above 1e−6. Turns along the shortest arc;
    /// not opposite to the keyframe before.
    pub direction: [f64; 3],
}

/// A light's direction at one time.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema, TS)]
#[serde(deny_unknown_fields)]
pub struct DirectionKeyframe {
    /// Later than the keyframe before. Unit: s. Range: 0 to 1e6.
    pub time_seconds: f64,
    /// In which the light travels; any length above 1e−6. Turns along the shortest arc; not
    /// opposite to the keyframe before.
    pub direction: [f64; 3],
}

fn radius() -> f64 {
    0.01
}

fn outer_angle_degrees() -> f64 {
    45.0
}

fn yes() -> bool {
    true
}

fn one() -> Rgb {
    Rgb::grey(1.0)
}
