//! Surfaces: model files, inline meshes and primitives.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use ts_rs::TS;

use super::tagged::tagged_union;
use super::values::{Rgb, Transform};

tagged_union! {
    /// One entry of `geometry`.
    pub enum GeometryDescription {
        /// A glTF 2.0 file, `.gltf` or `.glb`.
        "gltf" => Gltf(GltfGeometry),
        /// A Wavefront OBJ file with its MTL materials.
        "obj" => Obj(ObjGeometry),
        /// A triangle mesh written into the scene.
        "mesh" => Mesh(MeshGeometry),
        /// An axis-aligned box: 12 triangles facing outward.
        "box" => Box(BoxGeometry),
        /// A sphere, tessellated into 960 triangles with smooth normals.
        "sphere" => Sphere(SphereGeometry),
        /// A parallelogram: 2 triangles, front along `edge_u` × `edge_v`.
        "quad" => Quad(QuadGeometry),
    }
}

/// Defines a geometry kind with the members that all kinds have.
macro_rules! geometry_kind {
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
            /// Placement; identity if left out.
            #[serde(default, skip_serializing_if = "Option::is_none")]
            pub transform: Option<Transform>,
            /// Placement at which time, in order of time; replaces `transform`.
            #[serde(default, skip_serializing_if = "Vec::is_empty")]
            #[ts(optional, as = "Option<Vec<TransformKeyframe>>")]
            pub keyframes: Vec<TransformKeyframe>,
        }
    };
}

/// A placement at one time.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema, TS)]
#[serde(deny_unknown_fields)]
pub struct TransformKeyframe {
    /// Later than the keyframe before. Unit: s. Range: 0 to 1e6.
    pub time_seconds: f64,
    /// Placement at that time. In between translation and scale are linear and the rotation turns
    /// along the shortest arc. No factor of the scale changes its sign from one to the next.
    pub transform: Transform,
}

geometry_kind! {
    /// A glTF 2.0 file.
    pub struct GltfGeometry {
        /// `.gltf` or `.glb`, relative to the scene's folder and inside it.
        pub path: String,
        /// Candela and lux of `KHR_lights_punctual` are divided by this. Unit: lm/W. Range: 1e−3 to
        /// 1e6.
        #[serde(default = "luminous_efficacy")]
        pub luminous_efficacy: f64,
        /// Whether the file's lights are taken. Once loaded they stand in `lights`, and this is
        /// false.
        #[serde(default = "yes")]
        pub import_lights: bool,
    }
}

geometry_kind! {
    /// A Wavefront OBJ file.
    pub struct ObjGeometry {
        /// `.obj`, relative to the scene's folder and inside it.
        pub path: String,
    }
}

geometry_kind! {
    /// A triangle mesh written into the scene.
    pub struct MeshGeometry {
        /// Unit: m.
        pub positions: Vec<[f64; 3]>,
        /// Three indices into `positions` a triangle, counter-clockwise seen from the front.
        pub indices: Vec<[u32; 3]>,
        /// One a position, any length above zero; flat normals if left out.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        pub normals: Option<Vec<[f64; 3]>>,
        /// One a position; (0, 0) is the image's upper left corner.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        pub texcoords: Option<Vec<[f64; 2]>>,
        /// Surface.
        #[serde(default)]
        pub material: MaterialDescription,
    }
}

geometry_kind! {
    /// An axis-aligned box.
    pub struct BoxGeometry {
        /// Lowest corner. Unit: m.
        pub min: [f64; 3],
        /// Highest corner; above `min` in every component. Unit: m.
        pub max: [f64; 3],
        /// Surface.
        #[serde(default)]
        pub material: MaterialDescription,
    }
}

geometry_kind! {
    /// A tessellated sphere.
    pub struct SphereGeometry {
        /// Unit: m.
        pub center: [f64; 3],
        /// Unit: m. Range: 1e−6 to 1e6.
        pub radius: f64,
        /// Surface.
        #[serde(default)]
        pub material: MaterialDescription,
    }
}

geometry_kind! {
    /// A parallelogram.
    pub struct QuadGeometry {
        /// Unit: m.
        pub corner: [f64; 3],
        /// From `corner` along texture u. Unit: m.
        pub edge_u: [f64; 3],
        /// From `corner` along texture v, upward in the image. Not parallel to `edge_u`. Unit: m.
        pub edge_v: [f64; 3],
        /// Surface.
        #[serde(default)]
        pub material: MaterialDescription,
    }
}

/// Metallic-roughness surface.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema, TS)]
#[serde(deny_unknown_fields, default)]
#[ts(optional_fields)]
pub struct MaterialDescription {
    /// Linear reflectance; multiplies the texture. Range: 0 to 1.
    pub base_color: Rgb,
    /// Range: 0 to 1.
    pub metallic: f64,
    /// Perceptual roughness. Range: 0 to 1.
    pub roughness: f64,
    /// Emitted radiance. Unit: W·m⁻²·sr⁻¹. Range: 0 to 1e9. Front only unless `double_sided`.
    pub emission: Rgb,
    /// Both sides reflect and emit; otherwise triangles seen from behind are holes.
    pub double_sided: bool,
    /// Alpha of the texture below this is a hole. Range: 0 to 1.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub alpha_cutoff: Option<f64>,
    /// sRGB image (`.png`, `.jpg`), relative to the scene's folder and inside it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub base_color_texture: Option<String>,
}

impl Default for MaterialDescription {
    fn default() -> Self {
        Self {
            base_color: Rgb::grey(0.8),
            metallic: 0.0,
            roughness: 1.0,
            emission: Rgb::grey(0.0),
            double_sided: true,
            alpha_cutoff: None,
            base_color_texture: None,
        }
    }
}

/// Calls for the common members of every kind.
macro_rules! of_every_kind {
    ($self:ident, $entry:ident => $value:expr) => {
        match $self {
            Self::Gltf($entry) => $value,
            Self::Obj($entry) => $value,
            Self::Mesh($entry) => $value,
            Self::Box($entry) => $value,
            Self::Sphere($entry) => $value,
            Self::Quad($entry) => $value,
        }
    };
}

impl GeometryDescription {
    /// Name given by the user, if any.
    pub fn name(&self) -> Option<&str> {
        of_every_kind!(self, entry => entry.name.as_deref())
    }

    /// Placement, if given.
    pub fn transform(&self) -> Option<&Transform> {
        of_every_kind!(self, entry => entry.transform.as_ref())
    }

    /// Animated placement; empty if it stands still.
    pub fn keyframes(&self) -> &[TransformKeyframe] {
        of_every_kind!(self, entry => &entry.keyframes)
    }

    /// Surface, of the kinds that don't bring their own.
    pub fn material(&self) -> Option<&MaterialDescription> {
        match self {
            Self::Gltf(_) | Self::Obj(_) => None,
            Self::Mesh(entry) => Some(&entry.material),
            Self::Box(entry) => Some(&entry.material),
            Self::Sphere(entry) => Some(&entry.material),
            Self::Quad(entry) => Some(&entry.material),
        }
    }
}

fn luminous_efficacy() -> f64 {
    683.0
}

fn yes() -> bool {
    true
}
