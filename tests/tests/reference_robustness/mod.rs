//! The path tracer's pictures do not depend on how the work is cut, and no valid scene makes them
//! non-finite, negative or endless.

#![allow(clippy::print_stdout, reason = "helper functions of tests")]

mod determinism;
mod stress;
