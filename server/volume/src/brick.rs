//! Cubes of voxels.

/// Voxels along an edge of a brick.
pub const BRICK_SIDE: u32 = 8;
/// Voxels of a brick.
pub const BRICK_VOXELS: usize = 512;

/// Values of 8³ voxels, x fastest: voxel (x, y, z) is entry `x + 8·(y + 8·z)`.
pub type Brick = [f32; BRICK_VOXELS];

/// Entry of voxel (x, y, z), each below 8.
pub(crate) fn voxel_index(voxel: [u32; 3]) -> usize {
    (voxel[0] + BRICK_SIDE * (voxel[1] + BRICK_SIDE * voxel[2])) as usize
}
