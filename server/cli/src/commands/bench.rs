//! `tyndall bench`: run time against error, of frames in motion and of pictures at rest.

use std::io::{IsTerminal as _, Write as _};
use std::path::{Path, PathBuf};

use anyhow::{Context as _, bail};
use clap::Args;
use indicatif::{ProgressBar, ProgressStyle};
use serde_json::json;
use tyndall_bench::{
    Budget, FrameBench, Machine, PeerOptions, Row, SceneResult, Subject, Suite, TruthOptions,
    default_cache, efficiencies, table,
};
use tyndall_render::{Device, Renderer};
use tyndall_scene::description::render::Technique;
use tyndall_scene::presets;

use crate::one_line;
use crate::scene_argument::{self, DeviceArguments};

/// Another renderer to measure beside.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum Peer {
    /// Mitsuba 3, `volpath` (`PyPI` mitsuba, Debian libllvm19).
    Mitsuba,
}

/// Measure run time against error: scenes × techniques × settings.
#[derive(Debug, Args)]
#[allow(clippy::struct_excessive_bools, reason = "flags of a command line")]
pub struct Bench {
    /// Presets, scene files or pm-ref/1 files; all presets without any.
    scenes: Vec<String>,
    /// Small pictures, short ladders and little time for each: the presets in less than 5 minutes on a
    /// software driver.
    #[arg(long)]
    quick: bool,
    /// Techniques to measure, by their JSON names.
    #[arg(long, value_delimiter = ',', value_parser = scene_argument::technique,
          default_value = "single_scattering,reference")]
    techniques: Vec<Technique>,
    /// Largest width in pixels; scenes keep their shape. 640, quick: 128.
    #[arg(long)]
    width: Option<u32>,
    /// Largest height in pixels. 360, quick: 96.
    #[arg(long)]
    height: Option<u32>,
    /// Longest time of a row: 10, 10s, 500ms or 2m. 60s, quick: 2s at most.
    #[arg(long, value_parser = scene_argument::seconds)]
    row_time: Option<f64>,
    /// What makes the truth; anything but reference only knows the paths that it claims.
    #[arg(long, value_parser = scene_argument::technique, default_value = "reference")]
    truth_technique: Technique,
    /// Samples of a truth. 4096, quick: 512.
    #[arg(long)]
    truth_samples: Option<u32>,
    /// Longest time of a truth. 10m, quick: 5s at most.
    #[arg(long, value_parser = scene_argument::seconds)]
    truth_time: Option<f64>,
    /// Judge pm-ref scenes by their published images (`../data/ref_NAME_full.npz` and `_single.npz`).
    #[arg(long)]
    published_truth: bool,
    /// Folder that keeps truths; `$XDG_CACHE_HOME/tyndall/truth` without it.
    #[arg(long)]
    cache: Option<PathBuf>,
    /// Frames of a moving camera to time, too; 0 for none. 100, quick: 20.
    #[arg(long)]
    frames: Option<u32>,
    /// Write the rows as CSV.
    #[arg(long)]
    csv: Option<PathBuf>,
    /// Write everything as JSON; - for standard output instead of the table.
    #[arg(long)]
    json: Option<PathBuf>,
    /// Write a report with plots and pictures.
    #[arg(long)]
    html: Option<PathBuf>,
    /// Measure another renderer on the same scenes.
    #[arg(long, value_enum)]
    peer: Option<Peer>,
    /// Python that has the peer's packages.
    #[arg(long, env = "TYNDALL_PYTHON", default_value = "python3")]
    peer_python: PathBuf,
    /// Mitsuba's variant.
    #[arg(long, default_value = "llvm_ad_rgb")]
    peer_variant: String,
    /// Denoise the peer's pictures, too (`PyPI` pyoidn).
    #[arg(long)]
    peer_denoise: bool,
    /// No progress bar.
    #[arg(short, long)]
    quiet: bool,
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
        let mut failures = Vec::new();
        let mut subjects = Vec::new();
        for name in &names {
            match subject(name) {
                Ok(subject) => subjects.push(subject),
                Err(error) => self.fail(&mut failures, name, &error)?,
            }
        }
        if subjects.is_empty() {
            bail!(
                "none of the scenes could be measured: {}",
                failures.join("; ")
            );
        }
        let budget = if self.quick {
            Budget::quick(subjects.len())
        } else {
            Budget::thorough()
        };
        let suite = self.suite(&budget);
        let mut renderer = Renderer::new(Device::open(&self.device.options())?)?;
        let bar = self.bar(suite.steps() * subjects.len() as u64)?;
        let mut results = Vec::new();
        for subject in &subjects {
            bar.set_message(format!("{}: frames in motion", subject.name));
            let (motion, refused) = match self.motion(&mut renderer, subject, &budget) {
                Ok(motion) => (motion, None),
                Err(error) => (None, Some(format!("frames in motion: {error}"))),
            };
            let measured = suite.run(&mut renderer, subject, &mut |what| {
                bar.set_message(what.to_owned());
                bar.inc(1);
            });
            let mut result = match measured {
                Ok(result) => result,
                Err(error) => {
                    let told = || self.fail(&mut failures, &subject.name, &error.into());
                    bar.suspend(told)?;
                    continue;
                }
            };
            result.remarks.extend(refused);
            if self.to_stdout() {
                let mut text = table(&result);
                if let Some(row) = &motion {
                    text += &format!("  in motion: {row}\n");
                }
                bar.suspend(|| write!(std::io::stdout().lock(), "{text}"))?;
            }
            results.push((motion, result));
        }
        bar.finish_and_clear();
        self.write(&Machine::of(&renderer), &results)?;
        if !failures.is_empty() {
            bail!(
                "{} of {} scenes could not be measured: {}",
                failures.len(),
                names.len(),
                failures.join("; ")
            );
        }
        Ok(())
    }

    /// Notes a scene that cannot be measured, in the place of its table; the others go on.
    fn fail(
        &self,
        failures: &mut Vec<String>,
        name: &str,
        error: &anyhow::Error,
    ) -> anyhow::Result<()> {
        let why = one_line(error);
        let why = if why.contains(name) {
            why
        } else {
            format!("{name}: {why}")
        };
        if self.to_stdout() {
            writeln!(std::io::stdout().lock(), "{name}: not measured: {why}")?;
        }
        failures.push(why);
        Ok(())
    }

    fn suite(&self, budget: &Budget) -> Suite {
        let row_seconds = self.row_time.unwrap_or(budget.row);
        let largest = (
            self.width.unwrap_or(if self.quick { 128 } else { 640 }),
            self.height.unwrap_or(if self.quick { 96 } else { 360 }),
        );
        let peer = self.peer.map(|Peer::Mitsuba| PeerOptions {
            python: self.peer_python.clone(),
            variant: self.peer_variant.clone(),
            samples: if self.quick {
                vec![4, 16, 64]
            } else {
                vec![1, 4, 16, 64, 256]
            },
            denoise: self.peer_denoise,
            row_seconds,
        });
        Suite {
            largest,
            techniques: self.techniques.clone(),
            quick: self.quick,
            row_seconds,
            truth: TruthOptions {
                technique: self.truth_technique,
                samples: self
                    .truth_samples
                    .unwrap_or(if self.quick { 512 } else { 4096 }),
                seconds: self.truth_time.unwrap_or(budget.truth),
                cache: self.cache.clone().or_else(default_cache),
                published: self.published_truth,
            },
            peer,
        }
    }

    fn motion(
        &self,
        renderer: &mut Renderer,
        subject: &Subject,
        budget: &Budget,
    ) -> anyhow::Result<Option<Row>> {
        let frames = self.frames.unwrap_or(if self.quick { 20 } else { 100 });
        if frames == 0 {
            return Ok(None);
        }
        let bench = FrameBench {
            width: self.width.unwrap_or(if self.quick { 128 } else { 640 }),
            height: self.height.unwrap_or(if self.quick { 72 } else { 360 }),
            frames,
            frames_seconds: budget.frames,
            rest_samples: 64,
            rest_seconds: budget.rest,
            truth_samples: 256,
            truth_seconds: budget.motion_truth,
        };
        Ok(Some(bench.run(
            renderer,
            &subject.name,
            &subject.loaded.scene,
        )?))
    }

    fn to_stdout(&self) -> bool {
        self.json.as_deref() != Some(Path::new("-"))
    }

    fn write(
        &self,
        machine: &Machine,
        results: &[(Option<Row>, SceneResult)],
    ) -> anyhow::Result<()> {
        let save = |path: &Path, text: &str| {
            std::fs::write(path, text).with_context(|| format!("cannot write {}", path.display()))
        };
        let scenes: Vec<SceneResult> = results.iter().map(|(_, result)| result.clone()).collect();
        if let Some(path) = &self.csv {
            let rows: Vec<_> = scenes.iter().flat_map(|scene| scene.rows.clone()).collect();
            save(path, &tyndall_bench::csv(&rows)?)?;
        }
        if let Some(path) = &self.html {
            save(path, &tyndall_bench::html(machine, &scenes)?)?;
        }
        if let Some(path) = &self.json {
            let scenes: Vec<_> = results
                .iter()
                .map(|(motion, scene)| {
                    let efficiency: Vec<_> = efficiencies(&scene.rows)
                        .into_iter()
                        .map(|e| {
                            json!({"technique": e.technique, "claim": e.claim,
                                "efficiency": e.efficiency, "of_mitsuba": e.of_peer})
                        })
                        .collect();
                    let truths: Vec<_> = scene
                        .truths
                        .iter()
                        .map(|(claim, _, origin)| json!({"claim": claim, "origin": origin}))
                        .collect();
                    json!({"scene": scene.name, "truths": truths, "remarks": scene.remarks,
                        "motion": motion, "rows": scene.rows, "efficiency": efficiency})
                })
                .collect();
            let text = serde_json::to_string_pretty(&json!({
                "machine": machine,
                "scenes": scenes,
            }))?;
            if self.to_stdout() {
                save(path, &text)?;
            } else {
                writeln!(std::io::stdout().lock(), "{text}")?;
            }
        }
        Ok(())
    }

    fn bar(&self, steps: u64) -> anyhow::Result<ProgressBar> {
        if self.quiet || !std::io::stderr().is_terminal() {
            return Ok(ProgressBar::hidden());
        }
        Ok(
            ProgressBar::new(steps).with_style(ProgressStyle::with_template(
                "{bar:30} {pos}/{len}  {elapsed}  {msg}",
            )?),
        )
    }
}

/// A preset, a scene file or a reference scene.
fn subject(name: &str) -> anyhow::Result<Subject> {
    let path = Path::new(name);
    if presets::description(name).is_none()
        && let Some(subject) = Subject::pm_ref(path).with_context(|| name.to_owned())?
    {
        return Ok(subject);
    }
    let loaded = scene_argument::load(name)?;
    let folder = path
        .parent()
        .filter(|folder| !folder.as_os_str().is_empty());
    let folder = folder.unwrap_or(Path::new("."));
    let file = presets::description(name).is_none();
    Ok(Subject::new(name, loaded, file.then_some(folder)))
}
