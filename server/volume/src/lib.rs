//! Density grids: sparse voxels, and the files they come from. No GPU, no network.
//!
//! Everything a reader yields is a [`Grid`]: bricks of 8³ voxels where something is, nothing where
//! nothing is. Memory is known and checked before it is allocated. [`read`] takes any file by its
//! ending; each format's module takes bytes.

mod atlas;
mod brick;
mod compression;
mod cursor;
mod dense;
mod error;
mod file;
mod grid;
mod limits;
mod noise;
pub mod npy;
pub mod npz;
mod number;
pub mod nvdb;
mod placement;
mod procedural;
pub mod raw;
mod select;
mod sparse;
pub mod vdb;
pub mod vol;

pub use atlas::{
    APRON_SIDE, ATLAS_BRICK_SAMPLES, ATLAS_BRICK_WORDS, AtlasLimits, BrickAtlas, EMPTY_BRICK,
    MajorantGrid, decode_sample,
};
pub use brick::{BRICK_SIDE, BRICK_VOXELS, Brick};
pub use error::VolumeError;
pub use file::{ENDINGS, ReadOptions, read};
pub use grid::{Grid, GridBuilder, VoxelReport};
pub use limits::VolumeLimits;
pub use procedural::{Pattern, Procedural};
