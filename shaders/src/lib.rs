//! Shaders: WESL sources linked at build time to WGSL, and the Rust mirrors of the shared structs.
//!
//! A `permutations.txt` in each folder lists its shaders; `link/` links, validates and reflects them; [`shader`]
//! finds one by name. No device is needed.

mod table;
pub mod types;

pub use table::{Binding, EntryPoint, Override, Shader, Stage, all, shader};
