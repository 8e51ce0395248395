//! Run time against error: every figure is a pair, with device, settings and seed.
//!
//! First form: frames of a moving camera, timed pass by pass on the device's clock, beside the error
//! of one such frame against the same view converged with traced shadows.

mod error;
mod frames;
mod memory;
mod statistics;

pub use error::BenchError;
pub use frames::{FrameBench, Row};
pub use memory::resident_bytes;
pub use statistics::Summary;
