//! `tyndall check`: everything `render` would refuse, without a device.

use std::io::Write as _;

use clap::Args;
use serde_json::json;
use tyndall_render::check_supported;
use tyndall_scene::facts;

use crate::scene_argument;

/// Validate a scene without rendering it.
#[derive(Debug, Args)]
pub struct Check {
    /// Preset, .json scene, or bare .gltf, .glb or .obj model.
    scene: String,
    /// Print the scene's facts as JSON.
    #[arg(long)]
    json: bool,
}

impl Check {
    pub fn run(self) -> anyhow::Result<()> {
        let loaded = scene_argument::load(&self.scene)?;
        let facts = facts(&loaded.scene);
        let bounds = facts.bounds;
        let mut out = std::io::stdout().lock();
        if self.json {
            let mut printed = serde_json::to_value(&facts)?;
            printed["bounds"] = json!({"min": bounds.min.to_array(), "max": bounds.max.to_array()});
            writeln!(out, "{}", serde_json::to_string_pretty(&printed)?)?;
        } else {
            let lights = facts.lights();
            writeln!(
                out,
                "{}: valid; {} triangles in {} instances, {} textures, {lights} lights, {} media, optical thickness {:.3}",
                self.scene,
                facts.triangles,
                facts.instances,
                facts.textures,
                facts.media,
                facts.optical_thickness
            )?;
            writeln!(
                out,
                "everything lies between {:.3} and {:.3} m",
                bounds.min, bounds.max
            )?;
        }
        check_supported(&loaded.scene)?;
        Ok(())
    }
}
