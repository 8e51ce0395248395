//! A scene named on the command line: a preset or a file, with the overrides of the flags.

use std::path::Path;

use anyhow::{Context as _, bail};
use clap::Args;
use tyndall_render::{DeviceOptions, approximations};
use tyndall_scene::{Loaded, presets};

/// Which adapter renders.
#[derive(Debug, Clone, Args)]
pub struct DeviceArguments {
    /// Part of the adapter's name (see `tyndall adapters`); the best one without it.
    #[arg(long, env = "TYNDALL_ADAPTER")]
    pub adapter: Option<String>,
    /// Fail rather than render on the CPU.
    #[arg(long)]
    pub require_gpu: bool,
}

impl DeviceArguments {
    pub fn options(&self) -> DeviceOptions {
        DeviceOptions {
            adapter: self.adapter.clone(),
            require_gpu: self.require_gpu,
        }
    }
}

/// Loads a preset or a file; prints the file's warnings.
pub fn load(name: &str) -> anyhow::Result<Loaded> {
    let loaded = if let Some(description) = presets::description(name) {
        tyndall_scene::build(description, None).with_context(|| format!("preset {name}"))?
    } else {
        let path = Path::new(name);
        if !path.exists() {
            let known: Vec<_> = presets::names().iter().map(|preset| preset.name).collect();
            bail!("{name}: neither a file nor a preset ({})", known.join(", "));
        }
        tyndall_scene::load(path).with_context(|| name.to_owned())?
    };
    for warning in &loaded.warnings {
        tracing::warn!("{name}: {warning}");
    }
    for remark in approximations(&loaded.scene) {
        tracing::warn!("{name}: {remark}");
    }
    Ok(loaded)
}
