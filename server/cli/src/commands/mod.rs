//! One file a command.

pub mod adapters;
pub mod bench;
pub mod check;
pub mod compare;
pub mod plan;
pub mod render;
pub mod serve;
mod serve_limits;
pub mod submit;
