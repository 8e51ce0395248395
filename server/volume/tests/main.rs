//! Density grids and their files, as modules of one binary. `hostile.rs` is another: it measures the
//! memory of its process.

mod dense;
mod fixtures;
mod real_files;
mod refusals;
