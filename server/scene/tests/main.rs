//! Descriptions, files and what becomes of them, as modules of one binary: linking is most of its cost.

mod animation;
mod bad_files;
mod build;
mod environments;
mod gltf_files;
mod grids;
mod guide;
mod hostile;
mod mutations;
mod presets;
mod schema;
mod support;
mod validation;
