//! `tyndall render`: a scene to a file.

use std::io::{IsTerminal as _, Write as _};
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Instant;

use anyhow::{Context as _, bail};
use clap::Args;
use indicatif::{ProgressBar, ProgressStyle};
use tyndall_render::{Device, Renderer};
use tyndall_scene::StopRule;
use tyndall_scene::description::render::{CorrectionMode, Technique};
use tyndall_still::{FinishedStill, Output, StillTask};

use crate::output;
use crate::scene_argument::{self, DeviceArguments};

/// Render a scene to an EXR, PNG or JPEG file.
#[derive(Debug, Args)]
pub struct Render {
    /// Preset, .json scene, or bare .gltf, .glb or .obj model.
    scene: String,
    /// File to write: .exr holds linear radiance and all other layers, .png and .jpg the displayed picture.
    #[arg(short, long)]
    output: PathBuf,
    /// Width in pixels; the scene's without it.
    #[arg(long)]
    width: Option<u32>,
    /// Height in pixels; the scene's without it.
    #[arg(long)]
    height: Option<u32>,
    /// What transports the light, by its JSON name; the scene's without it.
    #[arg(long, value_parser = scene_argument::technique)]
    technique: Option<Technique>,
    /// When traced samples correct the picture: `off`, `at_rest` or `always`; the scene's without it.
    #[arg(long, value_parser = scene_argument::correction)]
    correction: Option<CorrectionMode>,
    /// Samples a pixel.
    #[arg(long, group = "stop")]
    samples: Option<u32>,
    /// Time of rendering: 10, 10s, 500ms or 2m.
    #[arg(long, group = "stop", allow_negative_numbers = true, value_parser = scene_argument::seconds)]
    time: Option<f64>,
    /// Estimated relative error to reach, 0.01 for 1 %.
    #[arg(long, group = "stop", allow_negative_numbers = true)]
    error: Option<f64>,
    /// Time that the scene is shown at, in seconds; 0 without it.
    #[arg(long, value_name = "SECONDS", allow_negative_numbers = true)]
    at: Option<f64>,
    /// Seed of every random number.
    #[arg(long)]
    seed: Option<u64>,
    /// No progress bar.
    #[arg(short, long)]
    quiet: bool,
    #[command(flatten)]
    device: DeviceArguments,
}

impl Render {
    pub fn run(self) -> anyhow::Result<()> {
        let format = output::format(&self.output)?;
        if let Some(folder) = self.output.parent()
            && !folder.as_os_str().is_empty()
            && !folder.is_dir()
        {
            bail!("{}: its folder does not exist", self.output.display());
        }
        let loaded = scene_argument::load(&self.scene)?;
        let loaded = self.with_overrides(loaded)?;
        let scene = Arc::new(loaded.scene);
        let (width, height) = (scene.render.width, scene.render.height);
        let mut renderer = Renderer::new(Device::open(&self.device.options())?)?;
        let bar = self.bar(scene.render.stop)?;
        let started = Instant::now();
        let task = StillTask::new(Arc::clone(&scene));
        let still = task.run(&mut renderer, |progress| {
            bar.set_position(progress.samples.into());
        })?;
        let seconds = started.elapsed().as_secs_f64();
        bar.finish_and_clear();
        let adapter = renderer.adapter();
        let names = (adapter.name.as_str(), adapter.driver.as_str());
        let finished = FinishedStill::new(still, &loaded.description, &scene, names)?;
        let bytes = tyndall_still::encode(&finished, &Output::whole(format))?;
        output::write(&self.output, &bytes)
            .with_context(|| format!("cannot write {}", self.output.display()))?;
        let still = finished.still;
        if !self.quiet {
            let mut err = std::io::stderr().lock();
            writeln!(
                err,
                "{}: {width}×{height}, {} samples in {seconds:.2} s on {}; mean transmittance {:.4}, {} non-finite and {} negative samples",
                self.output.display(),
                still.frame.samples,
                renderer.adapter().name,
                still.frame.stats.mean_transmittance,
                still.non_finite,
                still.negative,
            )?;
        }
        if still.non_finite > 0 {
            bail!("{} samples were not finite", still.non_finite);
        }
        if still.truncated > 0 {
            bail!(
                "{} paths were given up after too many segments: the picture is too dark",
                still.truncated
            );
        }
        Ok(())
    }

    /// The overrides go through the description, so they meet the same checks as a file's values.
    fn with_overrides(
        &self,
        loaded: tyndall_scene::Loaded,
    ) -> anyhow::Result<tyndall_scene::Loaded> {
        let mut render = loaded.description.render.clone();
        render.width = self.width.unwrap_or(render.width);
        render.height = self.height.unwrap_or(render.height);
        render.seed = self.seed.unwrap_or(render.seed);
        render.technique = self.technique.unwrap_or(render.technique);
        render.correction = self.correction.or(render.correction);
        if self.samples.is_some() || self.time.is_some() || self.error.is_some() {
            render.samples = self.samples;
            render.time_seconds = self.time;
            render.relative_error = self.error;
        }
        let edit = tyndall_scene::SceneEdit {
            render: Some(render),
            time_seconds: self.at,
            ..Default::default()
        };
        let (description, scene) =
            tyndall_scene::apply_edit(&loaded.description, &loaded.scene, &edit)?;
        Ok(tyndall_scene::Loaded {
            description,
            scene,
            warnings: loaded.warnings,
            files: loaded.files,
        })
    }

    fn bar(&self, stop: StopRule) -> anyhow::Result<ProgressBar> {
        if self.quiet || !std::io::stderr().is_terminal() {
            return Ok(ProgressBar::hidden());
        }
        Ok(match stop {
            StopRule::Samples(samples) => {
                ProgressBar::new(samples.into()).with_style(ProgressStyle::with_template(
                    "{bar:40} {pos}/{len} samples  {elapsed} of {duration}",
                )?)
            }
            StopRule::Seconds(_) | StopRule::RelativeError(_) => ProgressBar::new_spinner()
                .with_style(ProgressStyle::with_template(
                    "{spinner} {pos} samples  {elapsed}",
                )?),
        })
    }
}
