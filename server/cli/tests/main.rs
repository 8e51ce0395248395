//! The binary as a user runs it, as modules of one binary.

mod cli;
mod serve;
mod submit;
