//! Rust mirrors of `wesl/types.wesl` and `wesl/constants.wesl`: same names, same order.
//!
//! `tests/layout.rs` compares every field's name and offset and every struct's size with what naga
//! reflects, so that the two cannot drift.

use bytemuck::{Pod, Zeroable};

/// No shadow view: see `Light::shadow_view`.
pub const NO_SHADOW: u32 = 0xffff_ffff;
/// No texture: see `TextureSlot::array`.
pub const NO_TEXTURE: u32 = 0xffff_ffff;
/// `Light::kind` of a point light.
pub const LIGHT_POINT: u32 = 0;
/// `Light::kind` of a spot light.
pub const LIGHT_SPOT: u32 = 1;
/// `Light::kind` of a directional light.
pub const LIGHT_DIRECTIONAL: u32 = 2;
/// `Medium::shape` of a homogeneous medium.
pub const MEDIUM_HOMOGENEOUS: u32 = 0;
/// `Medium::shape` of exponential height fog.
pub const MEDIUM_HEIGHT_FOG: u32 = 1;
/// `Medium::shape` of a sphere with quadratic falloff.
pub const MEDIUM_SPHERE: u32 = 2;
/// `Medium::shape` of a density grid.
pub const MEDIUM_GRID: u32 = 3;
/// `PathRules::medium_order`: any number of scatterings in media.
pub const ORDER_ALL: u32 = 0;
/// `PathRules::medium_order`: none.
pub const ORDER_NONE: u32 = 1;
/// `PathRules::medium_order`: exactly one.
pub const ORDER_SINGLE: u32 = 2;
/// `PathRules::medium_order`: at least two.
pub const ORDER_MULTIPLE: u32 = 3;
/// `TextureSlot::wrap_u`: tiles.
pub const WRAP_REPEAT: u32 = 0;
/// `TextureSlot::wrap_u`: tiles, every other one mirrored.
pub const WRAP_MIRRORED: u32 = 1;
/// `TextureSlot::wrap_u`: repeats the edge texel.
pub const WRAP_CLAMP: u32 = 2;
/// Side of a tile over which new samples are compared with carried ones. Unit: pixel.
pub const HISTORY_TILE: u32 = 16;

macro_rules! mirrors {
    ($($(#[$meta:meta])* struct $name:ident { $($field:ident: $kind:ty,)* })*) => {
        $(
            $(#[$meta])*
            #[repr(C)]
            #[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
            #[allow(missing_docs, reason = "the fields are documented in wesl/types.wesl")]
            pub struct $name { $(pub $field: $kind,)* }

            impl Default for $name {
                fn default() -> Self {
                    Zeroable::zeroed()
                }
            }
        )*

        /// Name, size and (field, offset) of every mirror, for the layout test.
        pub fn layouts() -> Vec<Layout> {
            vec![$(Layout {
                name: stringify!($name),
                size: size_of::<$name>(),
                fields: vec![$((stringify!($field), std::mem::offset_of!($name, $field)),)*],
            },)*]
        }
    };
}

/// Layout of one mirror.
#[derive(Debug)]
pub struct Layout {
    /// Name of the struct.
    pub name: &'static str,
    /// Unit: byte.
    pub size: usize,
    /// Field names with offsets in bytes.
    pub fields: Vec<(&'static str, usize)>,
}

mirrors! {
    /// What one frame needs to know.
    struct Frame {
        clip_from_relative: [[f32; 4]; 4],
        right: [f32; 3],
        width: u32,
        up: [f32; 3],
        height: u32,
        forward: [f32; 3],
        near: f32,
        camera_from_anchor: [f32; 3],
        far: f32,
        pixel_offset: [f32; 2],
        sample_index: u32,
        seed: u32,
        background: [f32; 3],
        exposure_scale: f32,
        statistics_scale: f32,
        accumulated: u32,
        environment_size: [u32; 2],
        environment_rotation: [f32; 2],
        restart: u32,
        padding: u32,
    }

    /// The part of a pass that one dispatch does.
    struct Band {
        first: [u32; 3],
        padding: u32,
    }

    /// How camera rays are marched.
    struct MarchSettings {
        steps: u32,
        jitter: u32,
    }

    /// Which paths the reference counts.
    struct PathRules {
        max_scatterings: u32,
        max_surface_scatterings: u32,
        medium_order: u32,
        max_events: u32,
    }

    /// The part of the picture that one dispatch of the reference works on.
    struct Slice {
        first_row: u32,
        rows: u32,
        first_sample: u32,
        samples: u32,
        segments: u32,
        cleared: u32,
        stride: u32,
        offset_x: u32,
        offset_y: u32,
        shares_places: u32,
    }

    /// A level of the residual's pyramid, the next coarser one, and the one after that.
    struct PyramidLevel {
        width: u32,
        height: u32,
        first: u32,
        coarsest: u32,
        coarse_width: u32,
        coarse_height: u32,
        coarse_first: u32,
        window_width: u32,
        window_height: u32,
        window_first: u32,
        enough: f32,
    }

    /// The camera of the last picture.
    struct HistoryView {
        right: [f32; 3],
        most: f32,
        up: [f32; 3],
        most_base: f32,
        forward: [f32; 3],
        changed: u32,
        moved: [f32; 3],
        base_samples: f32,
        same_place: f32,
        spread: f32,
        padding: [u32; 2],
    }

    /// What new samples say against carried ones, in a tile of pixels.
    struct TileChange {
        a: [f32; 4],
        b: [f32; 4],
        cells: [f32; 4],
    }

    /// Box and samples of the grids' optical depth toward each light.
    struct LightVolume {
        low: [f32; 3],
        lights: u32,
        high: [f32; 3],
        padding: u32,
        size: [u32; 3],
        padding_end: u32,
    }

    /// A light with a position or a direction.
    struct Light {
        position: [f32; 3],
        kind: u32,
        direction: [f32; 3],
        radius: f32,
        intensity: [f32; 3],
        cos_outer: f32,
        spot_scale: f32,
        shadow_view: u32,
        shadow_texel: f32,
        padding: u32,
    }

    /// A phase function.
    struct Phase {
        parameters: [f32; 3],
        kind: u32,
    }

    /// One participating medium.
    struct Medium {
        sigma_s: [f32; 3],
        shape: u32,
        sigma_t: [f32; 3],
        falloff: f32,
        emission: [f32; 3],
        camera_height: f32,
        up: [f32; 3],
        radius: f32,
        center: [f32; 3],
        bounded: u32,
        bounds_min: [f32; 3],
        grid: u32,
        bounds_max: [f32; 3],
        padding: u32,
        phase: Phase,
    }

    /// A density grid's place in the shared buffers, and its lattice.
    struct Grid {
        row_x: [f32; 4],
        row_y: [f32; 4],
        row_z: [f32; 4],
        clip_min: [f32; 3],
        cell_side: f32,
        clip_max: [f32; 3],
        first_table: u32,
        samples: [u32; 3],
        first_slot: u32,
        bricks: [u32; 3],
        first_cell: u32,
        cells: [u32; 3],
        near_radius: f32,
        extent: f32,
        padding: [u32; 3],
    }

    /// Attributes of a triangle's corners.
    struct TriangleSurface {
        normal0: [f32; 3],
        material: u32,
        normal1: [f32; 3],
        color0: u32,
        normal2: [f32; 3],
        color1: u32,
        texcoords_a: [f32; 4],
        texcoords_b: [f32; 4],
        texcoords_c: [f32; 4],
        emitter_density: f32,
        color2: u32,
        padding: [u32; 2],
    }

    /// An emissive triangle.
    struct Emitter {
        cumulative: f32,
        triangle: u32,
    }

    /// One depth map seen from a light.
    struct ShadowView {
        clip_from_relative: [[f32; 4]; 4],
    }

    /// A placed mesh.
    struct Instance {
        row_x: [f32; 4],
        row_y: [f32; 4],
        row_z: [f32; 4],
        material: u32,
        winding: f32,
        padding: [u32; 2],
    }

    /// A use of a texture by a material.
    struct TextureSlot {
        transform_u: [f32; 3],
        array: u32,
        transform_v: [f32; 3],
        layer: u32,
        wrap_u: u32,
        wrap_v: u32,
        texcoord_set: u32,
        padding: u32,
    }

    /// A surface material.
    struct Material {
        base_color: [f32; 4],
        emission: [f32; 3],
        alpha_cutoff: f32,
        double_sided: u32,
        metallic: f32,
        roughness: f32,
        normal_scale: f32,
        diffuse_only: u32,
        padding: [u32; 3],
        base_color_slot: TextureSlot,
        emission_slot: TextureSlot,
        metallic_roughness_slot: TextureSlot,
        normal_slot: TextureSlot,
    }

    /// Counted on the device each frame.
    struct Statistics {
        non_finite: u32,
        negative: u32,
        clamped: u32,
        transmittance: u32,
        displayed: u32,
        truncated: u32,
        unfinished: u32,
        variance_of_halves: f32,
        variance_of_samples: f32,
        radiance: f32,
        measured_pixels: f32,
    }
}
