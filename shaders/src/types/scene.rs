//! The scene: lights, media, surfaces, materials.

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
/// `TextureSlot::wrap_u`: tiles.
pub const WRAP_REPEAT: u32 = 0;
/// `TextureSlot::wrap_u`: tiles, every other one mirrored.
pub const WRAP_MIRRORED: u32 = 1;
/// `TextureSlot::wrap_u`: repeats the edge texel.
pub const WRAP_CLAMP: u32 = 2;

mirrors! {
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
}
