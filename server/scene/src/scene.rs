//! The validated scene: what the renderer takes.
//!
//! Every value here has passed `validate`: finite, in range, indices in bounds. SI units,
//! right-handed, +Y up, linear Rec. 709 RGB. World positions are `f64` so that the renderer can
//! subtract the camera before it rounds to `f32`; vertices are `f32` in object space.

use std::sync::Arc;

use glam::{DAffine3, DVec3, Vec3};

use crate::environment::EnvironmentMap;
use crate::shared_grid::SharedGrid;

/// A scene ready to be rendered. Cloning is cheap: the geometry is shared.
#[derive(Debug, Clone, PartialEq)]
pub struct Scene {
    /// Name shown to users; empty when the description gives none.
    pub name: String,
    /// The eye.
    pub camera: Camera,
    /// Triangles, materials and textures. Compared by identity, not by content.
    pub geometry: SharedGeometry,
    /// Lights with a position or a direction.
    pub lights: Vec<Light>,
    /// Radiance arriving from infinity, if any.
    pub environment: Option<Environment>,
    /// Participating media; where they overlap their coefficients add up.
    pub media: Vec<Medium>,
    /// How to render.
    pub render: RenderSettings,
    /// JSON paths of keyframes: what an animation job would move.
    pub keyframes: Vec<String>,
}

/// Geometry shared between scenes that differ in camera, lights or media only.
///
/// Equality is identity (`Arc::ptr_eq`): two loads of one file are different geometries.
#[derive(Debug, Clone)]
pub struct SharedGeometry(pub Arc<Geometry>);

impl PartialEq for SharedGeometry {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }
}

impl std::ops::Deref for SharedGeometry {
    type Target = Geometry;

    fn deref(&self) -> &Geometry {
        &self.0
    }
}

/// Perspective pinhole camera.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Camera {
    /// Unit: m.
    pub position: DVec3,
    /// The point looked at; differs from `position`. Unit: m.
    pub target: DVec3,
    /// Not parallel to the view direction; need not be unit.
    pub up: Vec3,
    /// Full vertical field of view. Unit: radian. Range: (0, π).
    pub vertical_fov: f32,
    /// Exposure value: displayed = curve(radiance · 2^`exposure_ev`). Range: [−24, 24].
    pub exposure_ev: f32,
}

/// All triangles of a scene.
#[derive(Debug, Clone, Default)]
pub struct Geometry {
    /// Object-space triangle meshes.
    pub meshes: Vec<Mesh>,
    /// Placed meshes.
    pub instances: Vec<Instance>,
    /// Surface materials, referred to by `Mesh::material`.
    pub materials: Vec<Material>,
    /// Decoded images, referred to by `TextureRef::texture`.
    pub textures: Vec<Texture>,
}

/// An indexed triangle mesh in object space.
///
/// `normals` has one entry a vertex; `texcoords` and `colors` have either none or one a vertex.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Mesh {
    /// Name for messages.
    pub name: String,
    /// Vertex positions. Unit: m (before the instance's transform).
    pub positions: Vec<[f32; 3]>,
    /// Unit vertex normals.
    pub normals: Vec<[f32; 3]>,
    /// Two sets of texture coordinates, each empty or one a vertex.
    pub texcoords: [Vec<[f32; 2]>; 2],
    /// Linear vertex colours, 255 = 1; empty means white.
    pub colors: Vec<[u8; 4]>,
    /// Three a triangle; counter-clockwise seen from the front.
    pub indices: Vec<u32>,
    /// Index into `Geometry::materials`.
    pub material: usize,
}

/// A mesh placed in the world.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Instance {
    /// Index into `Geometry::meshes`.
    pub mesh: usize,
    /// Invertible affine transform.
    pub world_from_object: DAffine3,
}

/// Metallic-roughness surface material (glTF 2.0).
#[derive(Debug, Clone, PartialEq)]
pub struct Material {
    /// Name for messages.
    pub name: String,
    /// Linear RGB reflectance and alpha, each in [0, 1]; multiplies the texture.
    pub base_color: [f32; 4],
    /// sRGB texture of base colour and alpha.
    pub base_color_texture: Option<TextureRef>,
    /// Emitted radiance; multiplies the texture. Unit: W·m⁻²·sr⁻¹. Front side only unless `double_sided`.
    pub emission: [f32; 3],
    /// sRGB texture of emission.
    pub emission_texture: Option<TextureRef>,
    /// Range: [0, 1].
    pub metallic: f32,
    /// Perceptual roughness. Range: [0, 1].
    pub roughness: f32,
    /// Linear texture: roughness in G, metallic in B.
    pub metallic_roughness_texture: Option<TextureRef>,
    /// Linear tangent-space normal map.
    pub normal_texture: Option<TextureRef>,
    /// Scale of the normal map's x and y.
    pub normal_scale: f32,
    /// Alpha below this is a hole; `None` is opaque. Range: [0, 1].
    pub alpha_cutoff: Option<f32>,
    /// Both sides reflect; otherwise triangles seen from behind are culled.
    pub double_sided: bool,
}

impl Default for Material {
    fn default() -> Self {
        Self {
            name: String::new(),
            base_color: [0.8, 0.8, 0.8, 1.0],
            base_color_texture: None,
            emission: [0.0; 3],
            emission_texture: None,
            metallic: 0.0,
            roughness: 1.0,
            metallic_roughness_texture: None,
            normal_texture: None,
            normal_scale: 1.0,
            alpha_cutoff: None,
            double_sided: false,
        }
    }
}

/// A use of a texture by a material.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TextureRef {
    /// Index into `Geometry::textures`.
    pub texture: usize,
    /// Which of `Mesh::texcoords`: 0 or 1.
    pub texcoord_set: u8,
    /// Rows of the 2×3 matrix applied to (u, v, 1): `KHR_texture_transform`.
    pub uv_transform: [[f32; 3]; 2],
}

/// A decoded 8-bit image with its sampler.
#[derive(Debug, Clone, PartialEq)]
pub struct Texture {
    /// Name for messages.
    pub name: String,
    /// Pixels; at least 1.
    pub width: u32,
    /// Pixels; at least 1.
    pub height: u32,
    /// RGBA, row 0 at the top, `4 · width · height` bytes.
    pub pixels: Vec<u8>,
    /// How RGB is encoded; alpha is always linear.
    pub color_space: ColorSpace,
    /// Addressing along u and v.
    pub wrap: [Wrap; 2],
}

/// Encoding of a texture's RGB.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum ColorSpace {
    /// IEC 61966-2-1.
    Srgb,
    /// Values are used as they are.
    Linear,
}

/// Texture addressing outside [0, 1).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Wrap {
    /// Tiles.
    Repeat,
    /// Tiles, every other one mirrored.
    MirroredRepeat,
    /// Repeats the edge texel.
    ClampToEdge,
}

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

    /// Whether it sends anything at all.
    pub fn is_lit(&self) -> bool {
        let power = match self {
            Self::Point(light) => light.intensity,
            Self::Spot(light) => light.intensity,
            Self::Directional(light) => light.irradiance,
        };
        power.iter().any(|channel| *channel > 0.0)
    }
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

/// Radiance from infinity.
#[derive(Debug, Clone, PartialEq)]
pub struct Environment {
    /// Multiplies the map, or is the radiance itself. Unit: W·m⁻²·sr⁻¹.
    pub radiance: [f32; 3],
    /// Equirectangular map, if any.
    pub map: Option<EnvironmentMap>,
    /// Rotation of the map about +Y: a direction of the world is this rotation times a direction of
    /// the map, so a positive angle turns −Z toward −X. Unit: radian.
    pub rotation: f32,
}

/// One participating medium.
#[derive(Debug, Clone, PartialEq)]
pub struct Medium {
    /// Name given by the user, or empty.
    pub name: String,
    /// Scattering coefficient where the relative density is 1. Unit: m⁻¹ per channel; ≥ 0.
    pub sigma_s: [f32; 3],
    /// Absorption coefficient where the relative density is 1. Unit: m⁻¹ per channel; ≥ 0.
    pub sigma_a: [f32; 3],
    /// Henyey–Greenstein mean cosine, +1 forward. Range: [−0.999, 0.999].
    pub g: f32,
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

/// Axis-aligned box, `min < max` in every component. Unit: m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Aabb {
    /// Lowest corner.
    pub min: DVec3,
    /// Highest corner.
    pub max: DVec3,
}

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
    /// Seed of every random number.
    pub seed: u64,
    /// Settings of the `single_scattering` march.
    pub single_scattering: SingleScatteringSettings,
    /// Which paths the `reference` counts.
    pub reference: ReferenceSettings,
    /// How visibility toward lights is found.
    pub shadows: ShadowSettings,
}

/// The techniques of the design; not all are rendered yet (the renderer refuses by name).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[allow(
    missing_docs,
    reason = "the names are the field's and are documented in ARCHITECTURE.md"
)]
pub enum Technique {
    Auto,
    SingleScattering,
    InstantVpl,
    PrincipalOrdinates,
    ScreenSpace,
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
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SingleScatteringSettings {
    /// Strata a ray, each sampled once. Range: [1, 4096].
    pub steps: u32,
    /// Random position inside each stratum; otherwise its midpoint.
    pub jitter: bool,
    /// Side M of the tile of pixels that share the strata of one ray: 1, 2, 4 or 8.
    pub interleave: u32,
    /// Whether half of the strata of lights with a position are equiangular about them.
    pub equiangular: bool,
}

/// Which paths the `reference` counts: those that keep all three rules.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct ReferenceSettings {
    /// Most scatterings of a path on surfaces and in media.
    pub max_scatterings: Option<u32>,
    /// Most scatterings on surfaces.
    pub max_surface_scatterings: Option<u32>,
    /// How often a path scatters in media.
    pub medium_order: MediumOrder,
}

/// How often a path scatters in media.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum MediumOrder {
    /// Any number of times.
    #[default]
    All,
    /// Never.
    None,
    /// Exactly once.
    Single,
    /// At least twice.
    Multiple,
}

/// How visibility toward lights is found.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ShadowSettings {
    /// Method.
    pub mode: ShadowMode,
    /// Side of a shadow map. Unit: texel. Range: [16, 8192].
    pub resolution: u32,
}

/// Method of visibility.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum ShadowMode {
    /// Every light sees everything.
    Off,
    /// Rasterized depth maps.
    Mapped,
    /// Rays through the BVH: exact, slower.
    Traced,
}
