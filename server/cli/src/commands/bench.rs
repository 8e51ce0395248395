//! `tyndall bench`: time of every pass, noise and memory in one row a scene.

use std::io::Write as _;

use clap::Args;
use tyndall_bench::{FrameBench, Row};
use tyndall_render::{Device, Renderer};
use tyndall_scene::presets;

use crate::scene_argument::{self, DeviceArguments};

/// Measure frames: time of every pass, noise, memory.
#[derive(Debug, Args)]
pub struct Bench {
    /// Presets or files; all presets without any.
    scenes: Vec<String>,
    /// Frames of a moving camera to time, after a warm-up.
    #[arg(long, default_value_t = 100)]
    frames: u32,
    /// Width in pixels.
    #[arg(long, default_value_t = 640)]
    width: u32,
    /// Height in pixels.
    #[arg(long, default_value_t = 360)]
    height: u32,
    /// Samples of the picture that a single frame's error is measured against.
    #[arg(long, default_value_t = 256)]
    truth_samples: u32,
    /// JSON instead of a table.
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    device: DeviceArguments,
}

impl Bench {
    pub fn run(self) -> anyhow::Result<()> {
        let names = if self.scenes.is_empty() {
            presets::names()
                .iter()
                .map(|preset| preset.name.to_owned())
                .collect()
        } else {
            self.scenes.clone()
        };
        let mut renderer = Renderer::new(Device::open(&self.device.options())?)?;
        let bench = FrameBench {
            width: self.width,
            height: self.height,
            frames: self.frames,
            truth_samples: self.truth_samples,
        };
        let mut rows = Vec::new();
        for name in names {
            let loaded = scene_argument::load(&name)?;
            let row = bench.run(&mut renderer, &name, &loaded.scene)?;
            if !self.json {
                let mut out = std::io::stdout().lock();
                writeln!(out, "{row}")?;
            }
            rows.push(row);
        }
        if self.json {
            let mut out = std::io::stdout().lock();
            writeln!(out, "{}", serde_json::to_string_pretty::<Vec<Row>>(&rows)?)?;
        }
        Ok(())
    }
}
