//! How large a scene may be before it is refused.

use crate::error::SceneError;

/// Upper bounds on what one scene may make this process read, decode or hold.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Limits {
    /// A scene's JSON text. Unit: byte.
    pub scene_bytes: u64,
    /// One model, buffer or image file. Unit: byte.
    pub file_bytes: u64,
    /// All files of a scene together, decoded `data:` URIs included. Unit: byte.
    pub total_bytes: u64,
    /// Triangles over all instances.
    pub triangles: u64,
    /// Vertices over all meshes, each counted once.
    pub vertices: u64,
    /// Placed meshes.
    pub instances: u64,
    /// One side of a texture. Unit: pixel.
    pub texture_side: u32,
    /// Pixels over all textures.
    pub texture_pixels: u64,
    /// Pixels of the environment map.
    pub environment_pixels: u64,
    /// One file of a grid. Unit: byte. Grids don't count in `file_bytes` and `total_bytes`.
    pub grid_file_bytes: u64,
    /// Voxels of all grids in memory, those used twice counted once. Unit: byte.
    pub grid_bytes: u64,
    /// Depth of a glTF node tree.
    pub node_depth: usize,
    /// Lights, those of glTF files included.
    pub lights: u64,
    /// Media.
    pub media: u64,
    /// Entries of `geometry`.
    pub geometry_entries: u64,
}

impl Default for Limits {
    fn default() -> Self {
        Self {
            scene_bytes: 16 << 20,
            file_bytes: 512 << 20,
            total_bytes: 1 << 30,
            triangles: 20_000_000,
            vertices: 20_000_000,
            instances: 200_000,
            texture_side: 8192,
            texture_pixels: 256 << 20,
            environment_pixels: 32 << 20,
            grid_file_bytes: 4 << 30,
            grid_bytes: 4 << 30,
            node_depth: 64,
            lights: 4096,
            media: 256,
            geometry_entries: 20_000,
        }
    }
}

/// Refuses more than the limit.
pub(crate) fn limit(
    path: &str,
    what: &'static str,
    found: u64,
    limit: u64,
) -> Result<(), SceneError> {
    if found <= limit {
        return Ok(());
    }
    Err(SceneError::Limit {
        path: path.to_owned(),
        what,
        found,
        limit,
    })
}
