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
/// `TextureSlot::wrap_u`: tiles.
pub const WRAP_REPEAT: u32 = 0;
/// `TextureSlot::wrap_u`: tiles, every other one mirrored.
pub const WRAP_MIRRORED: u32 = 1;
/// `TextureSlot::wrap_u`: repeats the edge texel.
pub const WRAP_CLAMP: u32 = 2;

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
        march_steps: u32,
        march_jitter: u32,
        exposure_scale: f32,
        statistics_scale: f32,
        accumulated: u32,
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

    /// One participating medium.
    struct Medium {
        sigma_s: [f32; 3],
        shape: u32,
        sigma_t: [f32; 3],
        g: f32,
        emission: [f32; 3],
        falloff: f32,
        up: [f32; 3],
        camera_height: f32,
        center: [f32; 3],
        radius: f32,
        bounds_min: [f32; 3],
        bounded: u32,
        bounds_max: [f32; 3],
        padding: u32,
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
        padding: [u32; 7],
        base_color_slot: TextureSlot,
        emission_slot: TextureSlot,
    }

    /// A node of the binary BVH.
    struct BvhNode {
        min: [f32; 3],
        primitive_count: u32,
        max: [f32; 3],
        first_index: u32,
    }

    /// Counted on the device each frame.
    struct Statistics {
        non_finite: u32,
        negative: u32,
        clamped: u32,
        transmittance: u32,
        displayed: u32,
    }
}
