//! `tyndall plan`: why each pass runs or doesn't, without a device.

use std::io::Write as _;

use clap::Args;
use tyndall_render::{PlanLimits, check_supported, plan};
use tyndall_scene::facts;

use crate::scene_argument;

/// Print which passes a scene needs and why, and which are skipped.
#[derive(Debug, Args)]
pub struct Plan {
    /// Preset, .json scene, or bare .gltf, .glb or .obj model.
    scene: String,
    /// JSON instead of a table.
    #[arg(long)]
    json: bool,
}

impl Plan {
    pub fn run(self) -> anyhow::Result<()> {
        let loaded = scene_argument::load(&self.scene)?;
        check_supported(&loaded.scene)?;
        let plan = plan(
            &facts(&loaded.scene),
            &loaded.scene.render,
            &PlanLimits::default(),
        )?;
        let mut out = std::io::stdout().lock();
        if self.json {
            writeln!(out, "{}", serde_json::to_string_pretty(&plan)?)?;
        } else {
            write!(out, "{plan}")?;
        }
        Ok(())
    }
}
