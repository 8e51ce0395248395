//! Scenes × techniques × settings: renders, times and judges each.

use std::path::PathBuf;
use std::time::Duration;

use tyndall_picture::scene_hash;
use tyndall_quality::Image;
use tyndall_render::{Renderer, Rung, ladder};
use tyndall_scene::description::render::{CorrectionMode, Technique};
use tyndall_scene::{Scene, SceneEdit, apply_edit};

use crate::claim::Claim;
use crate::error::BenchError;
use crate::machine::Machine;
use crate::measures::Measures;
use crate::memory::resident_bytes;
use crate::peer::{self, PeerOptions, PeerPicture};
use crate::row::{LadderRow, mark_pareto};
use crate::shot::{WARM_UP, shoot};
use crate::subject::Subject;
use crate::truth::{Truth, TruthOptions};

/// What is measured and how long it may take.
#[derive(Debug, Clone)]
pub struct Suite {
    /// Unit: pixel. The scene's own size, reduced to fit into this, keeping its shape.
    pub largest: (u32, u32),
    /// Techniques to measure.
    pub techniques: Vec<Technique>,
    /// Fewer rungs.
    pub quick: bool,
    /// Longest time of one row. Unit: s.
    pub row_seconds: f64,
    /// How truths are made.
    pub truth: TruthOptions,
    /// Another renderer to measure beside.
    pub peer: Option<PeerOptions>,
}

/// A picture kept for the report: the best of each technique.
#[derive(Debug, Clone)]
pub struct Exhibit {
    /// Technique and setting.
    pub label: String,
    /// Which paths it claims.
    pub claim: Claim,
    /// The picture.
    pub image: Image,
}

/// One scene's results.
#[derive(Debug, Clone)]
pub struct SceneResult {
    /// Preset or file.
    pub name: String,
    /// For display. Unit: factor of 2.
    pub exposure_ev: f32,
    /// Truths with their claims and how they were made, their own error with it.
    pub truths: Vec<(Claim, Image, String)>,
    /// All rows, in the order of measurement.
    pub rows: Vec<LadderRow>,
    /// The last picture of each technique.
    pub exhibits: Vec<Exhibit>,
    /// What could not be measured and why.
    pub remarks: Vec<String>,
}

impl Suite {
    /// Rows that are planned for one scene, for a progress bar: truths and peer count, too.
    pub fn steps(&self) -> u64 {
        let rungs: usize = self
            .techniques
            .iter()
            .map(|technique| ladder(*technique, self.quick).len())
            .sum();
        (rungs + 2 + usize::from(self.peer.is_some())) as u64
    }

    /// Measures one scene; `progress` is told what starts next.
    ///
    /// # Errors
    /// [`BenchError`] if something breaks. What this program can't render yet, or the peer can't be
    /// given, becomes a remark.
    pub fn run(
        &self,
        renderer: &mut Renderer,
        subject: &Subject,
        progress: &mut dyn FnMut(&str),
    ) -> Result<SceneResult, BenchError> {
        let mut result = SceneResult {
            name: subject.name.clone(),
            exposure_ev: subject.loaded.scene.camera.exposure_ev,
            truths: Vec::new(),
            rows: Vec::new(),
            exhibits: Vec::new(),
            remarks: Vec::new(),
        };
        let size = self.size(subject);
        let mut truths = Vec::new();
        for claim in [Claim::Whole, Claim::OneScattering] {
            progress(&format!("{}: truth, {}", subject.name, claim.label()));
            match self.truth.of(renderer, subject, size, claim) {
                Ok(Some(truth)) => truths.push((claim, truth)),
                Ok(None) => result.remarks.push(format!(
                    "no truth for {}: {} does not know all of these paths",
                    claim.label(),
                    self.truth.technique.name()
                )),
                Err(BenchError::Render(error)) => result
                    .remarks
                    .push(format!("no truth for {}: {error}", claim.label())),
                Err(error) => return Err(error),
            }
        }
        let machine = Machine::of(renderer);
        for technique in &self.techniques {
            for rung in ladder(*technique, self.quick) {
                progress(&format!("{}: {}", subject.name, rung.name()));
                let row = self.measure(renderer, subject, size, &rung, &machine, &truths);
                match row {
                    Ok((row, image)) => {
                        let exhibit = Exhibit {
                            label: format!("{} ({})", row.technique, row.setting()),
                            claim: row.claim,
                            image,
                        };
                        keep_last(&mut result, exhibit, &row.technique);
                        result.rows.push(row);
                    }
                    Err(BenchError::Render(error)) => {
                        result
                            .remarks
                            .push(format!("{}: {error}", technique.name()));
                        break;
                    }
                    Err(error) => return Err(error),
                }
            }
        }
        if let Some(options) = &self.peer {
            progress(&format!("{}: mitsuba", subject.name));
            let scene = Self::scene(subject, size, None)?;
            let pictures = peer::run(options, &scene, &mut result.remarks)?;
            for picture in pictures {
                Self::add_peer(subject, &scene, picture, &truths, &machine, &mut result)?;
            }
        }
        mark_pareto(&mut result.rows);
        let kept = truths
            .into_iter()
            .map(|(claim, truth)| (claim, truth.told(), truth.image))
            .map(|(claim, told, image)| (claim, image, told));
        result.truths = kept.collect();
        Ok(result)
    }

    fn measure(
        &self,
        renderer: &mut Renderer,
        subject: &Subject,
        size: (u32, u32),
        rung: &Rung,
        machine: &Machine,
        truths: &[(Claim, Truth)],
    ) -> Result<(LadderRow, Image), BenchError> {
        let scene = Self::scene(subject, size, Some(rung))?;
        let budget = Duration::from_secs_f64(self.row_seconds);
        let shot = shoot(renderer, &scene, size, rung.samples, budget, WARM_UP)?;
        let claim = Claim::of_rung(rung);
        let mut row = LadderRow {
            technique: rung.name(),
            steps: rung.steps,
            samples: shot.samples,
            cut_short: shot.cut_short,
            seconds: shot.seconds,
            cpu_seconds: shot.cpu_seconds,
            frame_millis: Some(shot.frame_millis),
            pass_millis: shot.pass_millis,
            non_finite: shot.non_finite,
            resident_bytes: resident_bytes(),
            device_bytes: renderer.device_bytes(),
            device: machine.device.clone(),
            driver: machine.driver.clone(),
            ..blank(subject, &scene, claim, machine)?
        };
        judge(&mut row, &shot.image, truths, scene.camera.exposure_ev)?;
        Ok((row, shot.image))
    }

    fn add_peer(
        subject: &Subject,
        scene: &Scene,
        picture: PeerPicture,
        truths: &[(Claim, Truth)],
        machine: &Machine,
        result: &mut SceneResult,
    ) -> Result<(), BenchError> {
        let mut row = LadderRow {
            technique: picture.technique,
            samples: picture.samples,
            seed: picture.seed,
            seconds: picture.seconds,
            cpu_seconds: Some(picture.cpu_seconds),
            non_finite: picture.image.non_finite(),
            resident_bytes: picture.resident_bytes,
            device: format!("CPU, {} threads", machine.threads),
            driver: picture.version,
            ..blank(subject, scene, picture.claim, machine)?
        };
        if row.non_finite > 0 {
            result.remarks.push(format!(
                "{}: {} pixels are not finite",
                row.technique, row.non_finite
            ));
            return Ok(());
        }
        judge(&mut row, &picture.image, truths, scene.camera.exposure_ev)?;
        let exhibit = Exhibit {
            label: format!("{} ({})", row.technique, row.setting()),
            claim: row.claim,
            image: picture.image,
        };
        keep_last(result, exhibit, &row.technique);
        result.rows.push(row);
        Ok(())
    }

    /// The scene's size, reduced to fit; published images keep theirs.
    fn size(&self, subject: &Subject) -> (u32, u32) {
        let render = &subject.loaded.scene.render;
        let (width, height) = (render.width, render.height);
        if self.truth.published && subject.published.is_some() {
            return (width, height);
        }
        let scale = (f64::from(self.largest.0) / f64::from(width))
            .min(f64::from(self.largest.1) / f64::from(height))
            .min(1.0);
        let side = |side: u32| ((f64::from(side) * scale).round() as u32).max(1);
        (side(width), side(height))
    }

    /// The scene with a rung's settings.
    fn scene(
        subject: &Subject,
        (width, height): (u32, u32),
        rung: Option<&Rung>,
    ) -> Result<Scene, BenchError> {
        let mut render = subject.description.render.clone();
        (render.width, render.height) = (width, height);
        if let Some(rung) = rung {
            render.reference = Claim::of_rung(rung).reference();
            render.correction = Some(if rung.corrected {
                CorrectionMode::Always
            } else {
                CorrectionMode::Off
            });
            (render.samples, render.time_seconds) = (Some(rung.samples), None);
            render.relative_error = None;
        }
        let edit = SceneEdit {
            render: Some(render),
            ..SceneEdit::default()
        };
        let mut scene = apply_edit(&subject.description, &subject.loaded.scene, &edit)?.1;
        if let Some(rung) = rung {
            scene.render.technique = rung.technique;
            (rung.configure)(&mut scene.render, rung);
        }
        Ok(scene)
    }
}

/// Default folder of truths: `$XDG_CACHE_HOME/tyndall/truth`, else below `~/.cache`.
pub fn default_cache() -> Option<PathBuf> {
    let set = |name| std::env::var_os(name).filter(|value| !value.is_empty());
    let cache = set("XDG_CACHE_HOME").map(PathBuf::from).or_else(|| {
        let home = PathBuf::from(set("HOME")?);
        Some(home.join(".cache"))
    })?;
    Some(cache.join("tyndall").join("truth"))
}

/// Only the newest picture of each technique is shown: its ladder ends with the best.
fn keep_last(result: &mut SceneResult, exhibit: Exhibit, technique: &str) {
    let prefix = format!("{technique} (");
    result
        .exhibits
        .retain(|known| !known.label.starts_with(&prefix));
    result.exhibits.push(exhibit);
}

/// A row of which only scene and claim are known.
fn blank(
    subject: &Subject,
    scene: &Scene,
    claim: Claim,
    machine: &Machine,
) -> Result<LadderRow, BenchError> {
    Ok(LadderRow {
        scene: subject.name.clone(),
        scene_hash: scene_hash(&subject.description)?,
        technique: String::new(),
        steps: None,
        samples: 0,
        cut_short: false,
        width: scene.render.width,
        height: scene.render.height,
        seed: scene.render.seed,
        claim,
        seconds: 0.0,
        cpu_seconds: None,
        frame_millis: None,
        pass_millis: Vec::new(),
        whole: None,
        claimed: None,
        truth_error: None,
        non_finite: 0,
        resident_bytes: None,
        device_bytes: None,
        pareto_whole: false,
        pareto_claimed: false,
        device: String::new(),
        driver: String::new(),
        commit: machine.commit.to_owned(),
    })
}

fn judge(
    row: &mut LadderRow,
    image: &Image,
    truths: &[(Claim, Truth)],
    exposure_ev: f32,
) -> Result<(), BenchError> {
    for (claim, truth) in truths {
        let measures = Measures::of(image, &truth.image, exposure_ev)?;
        if *claim == row.claim {
            row.claimed = Some(measures.clone());
            row.truth_error = truth.own_error();
        }
        if *claim == Claim::Whole {
            row.whole = Some(measures);
        }
    }
    Ok(())
}
