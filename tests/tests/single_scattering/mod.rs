//! The single-scattering march: against published images and closed forms, and against itself where
//! a cheaper way must not change the picture.

#![allow(clippy::print_stdout, reason = "tests print what they measure")]

mod culling;
mod equiangular_grids;
mod interleaving;
mod phases;
mod skips;
mod stress;
mod truth;
mod voxels;
