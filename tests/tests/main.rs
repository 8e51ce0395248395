//! The tests across crates, as modules of one binary: each binary more would link the renderer again.
//!
//! A file that is not named here is not built; a convention finds it.

mod animation;
mod area_lights;
mod conventions;
mod conventions_imports;
mod conventions_names;
mod conventions_recipes;
mod conventions_test_files;
mod correction;
mod engine;
mod glossy_surfaces;
mod import_pm_ref;
mod noop_pipelines;
mod optical_depth;
mod plan;
mod reference_closed_forms;
mod reference_grid_forms;
mod reference_grids;
mod reference_invariants;
mod reference_robustness;
mod reference_truth;
mod reference_variance;
mod rendering;
mod samplers;
mod screen_space;
mod shader_functions;
mod shader_geometry;
mod single_scattering;
mod stills;
mod surface_truths;
