//! Helpers shared by the tests across crates.

pub mod chi_squared;
pub mod conventions;
pub mod estimate;
pub mod gpu;
pub mod grid_file;
pub mod pass_times;
pub mod picture_z;
pub mod probes;
pub use tyndall_bench::pm_ref;
pub mod published;
pub mod shared_folder;
