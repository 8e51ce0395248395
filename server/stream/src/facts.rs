//! What the planner knows about a scene, as clients see it.

use serde::{Deserialize, Serialize};
use ts_rs::TS;

/// What the planner knows about a scene; see `SceneFacts` for the exact meanings.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, TS)]
#[allow(missing_docs, reason = "named and documented as in `SceneFacts`")]
#[allow(
    clippy::struct_excessive_bools,
    reason = "they are independent facts, not states"
)]
pub struct Facts {
    pub triangles: u64,
    pub instances: u64,
    pub textures: u64,
    pub data_textures: u64,
    pub alpha_masked_instances: u64,
    pub emissive_triangles: u64,
    pub point_lights: u64,
    pub spot_lights: u64,
    pub directional_lights: u64,
    pub shadow_casters: u64,
    pub environment: bool,
    pub environment_map: bool,
    pub media: u64,
    pub grids: u64,
    pub heterogeneous: bool,
    pub scatters: bool,
    pub medium_emits: bool,
    pub anisotropic: bool,
    pub max_abs_g: f32,
    pub max_albedo: f32,
    /// An infinite thickness is the largest finite number: JSON knows no infinity.
    pub optical_thickness: f64,
}

impl From<&tyndall_scene::SceneFacts> for Facts {
    fn from(facts: &tyndall_scene::SceneFacts) -> Self {
        // Taken apart in full, so that a new fact is a compile error here.
        let tyndall_scene::SceneFacts {
            triangles,
            instances,
            textures,
            data_textures,
            alpha_masked_instances,
            emissive_triangles,
            point_lights,
            spot_lights,
            directional_lights,
            shadow_casters,
            environment,
            environment_map,
            media,
            grids,
            heterogeneous,
            scatters,
            medium_emits,
            anisotropic,
            max_abs_g,
            max_albedo,
            optical_thickness,
            voxels_across: _,
            bounds: _,
            surface_bounds: _,
            swept_bounds: _,
            glossy_materials: _,
        } = *facts;
        Self {
            triangles,
            instances: instances as u64,
            textures: textures as u64,
            data_textures: data_textures as u64,
            alpha_masked_instances: alpha_masked_instances as u64,
            emissive_triangles,
            point_lights: point_lights as u64,
            spot_lights: spot_lights as u64,
            directional_lights: directional_lights as u64,
            shadow_casters: shadow_casters as u64,
            environment,
            environment_map,
            media: media as u64,
            grids: grids as u64,
            heterogeneous,
            scatters,
            medium_emits,
            anisotropic,
            max_abs_g,
            max_albedo,
            optical_thickness: optical_thickness.min(f64::MAX),
        }
    }
}
