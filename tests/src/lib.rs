//! Helpers shared by the tests across crates.

pub mod conventions;
pub mod pm_ref;
