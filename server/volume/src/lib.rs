//! Density grids: sparse voxels, and the files they come from. No GPU, no network.
//!
//! Everything a reader yields is a [`Grid`]: bricks of 8³ voxels where something is, nothing where
//! nothing is. Memory is known and checked before it is allocated.

mod brick;
mod error;
mod grid;
mod limits;

pub use brick::{BRICK_SIDE, BRICK_VOXELS, Brick};
pub use error::VolumeError;
pub use grid::{Grid, GridBuilder, VoxelReport};
pub use limits::VolumeLimits;
