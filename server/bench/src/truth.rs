//! The picture that counts as the truth: rendered once, kept with its variance, used by hash.

use std::path::{Path, PathBuf};
use std::time::Duration;

use serde_json::json;
use tyndall_picture::{Layers, Metadata, hash_bytes, hash_json, read_exr, scene_hash, write_exr};
use tyndall_quality::{Image, estimated_error};
use tyndall_render::Renderer;
use tyndall_scene::description::render::{CorrectionMode, ShadowMode, Technique};
use tyndall_scene::{Scene, SceneDescription, SceneEdit, apply_edit};

use crate::claim::Claim;
use crate::error::BenchError;
use crate::shot::{WARM_UP, shoot};
use crate::subject::Subject;

/// A truth is the mean of so many pictures of different seeds; how they scatter gives its variance. All
/// have the same positions inside a pixel, so the error that these leave at edges is not in the variance.
const BATCHES: u32 = 8;
/// March steps of a truth that is marched.
const STEPS: u32 = 64;
/// Raised whenever the same settings give another truth than before: kept ones are then made anew.
const FORMAT: u32 = 2;

/// How truths are made.
#[derive(Debug, Clone, PartialEq)]
pub struct TruthOptions {
    /// `reference`, or a stand-in that can only speak for its own claim.
    pub technique: Technique,
    /// Samples a pixel. At least 16.
    pub samples: u32,
    /// Longest time for one truth. Unit: s.
    pub seconds: f64,
    /// Where truths are kept.
    pub cache: Option<PathBuf>,
    /// Use a reference scene's published images where there are any of the same size.
    pub published: bool,
}

/// The picture that counts as the truth.
#[derive(Debug, Clone)]
pub(crate) struct Truth {
    /// With the variance of its mean.
    pub image: Image,
    /// How it was made, for people.
    pub origin: String,
}

impl Truth {
    /// Its own relative error without the worst 0.1 % of pixels.
    pub fn own_error(&self) -> Option<f64> {
        let error = estimated_error(&self.image).ok()?;
        Some(error.relative_error_trim)
    }

    /// How it was made and how far it may be off.
    pub fn told(&self) -> String {
        match self.own_error() {
            Some(error) => format!("{}; its own error {error:.4} is taken off", self.origin),
            None => self.origin.clone(),
        }
    }
}

impl TruthOptions {
    /// The truth of `claim`; `None` if the truth's technique does not know these paths.
    pub(crate) fn of(
        &self,
        renderer: &mut Renderer,
        subject: &Subject,
        (width, height): (u32, u32),
        claim: Claim,
    ) -> Result<Option<Truth>, BenchError> {
        if self.published
            && let Some(image) = subject.published(claim)?
            && (image.width(), image.height()) == (width, height)
        {
            return Ok(Some(Truth {
                image,
                origin: "published reference image".into(),
            }));
        }
        if self.technique != Technique::Reference && Claim::of(self.technique) != claim {
            return Ok(None);
        }
        let (description, scene) = self.scene(subject, (width, height), claim)?;
        let samples = self.samples.max(2 * BATCHES);
        let key = hash_json(&json!({
            "format": FORMAT,
            "scene": scene_hash(&description)?,
            "files": files(&description, subject.folder.as_deref())?,
            "samples": samples,
            "seconds": self.seconds,
            "version": env!("CARGO_PKG_VERSION"),
        }));
        let file = self
            .cache
            .as_ref()
            .map(|folder| folder.join(format!("{}-{}.exr", self.technique.name(), key)));
        if let Some(file) = &file
            && let Ok((layers, metadata)) = read_exr(file)
        {
            let origin = format!("{}, {} samples, kept", metadata.technique, metadata.samples);
            let image = layers.image()?;
            return Ok(Some(Truth { image, origin }));
        }
        let budget = Duration::from_secs_f64(self.seconds);
        let (image, taken) = settle(renderer, &scene, (width, height), samples, budget)?;
        if let Some(file) = &file {
            let metadata = Metadata {
                scene: subject.name.clone(),
                scene_hash: scene_hash(&description)?,
                technique: self.technique.name().to_owned(),
                seed: scene.render.seed,
                samples: taken,
                version: env!("CARGO_PKG_VERSION").to_owned(),
                adapter: renderer.adapter().name.clone(),
            };
            keep(file, &image, &metadata)?;
        }
        let origin = format!("{}, {taken} samples", self.technique.name());
        Ok(Some(Truth { image, origin }))
    }

    /// The scene with the settings of a truth.
    fn scene(
        &self,
        subject: &Subject,
        (width, height): (u32, u32),
        claim: Claim,
    ) -> Result<(SceneDescription, Scene), BenchError> {
        let mut render = subject.description.render.clone();
        (render.width, render.height) = (width, height);
        (render.samples, render.time_seconds) = (Some(self.samples), None);
        render.relative_error = None;
        render.technique = self.technique;
        render.correction = Some(CorrectionMode::Off);
        render.reference = claim.reference();
        render.single_scattering.steps = STEPS;
        render.single_scattering.jitter = true;
        let materials = &subject.loaded.scene.geometry.materials;
        let masked = materials.iter().any(|m| m.alpha_cutoff.is_some());
        if !masked && render.shadows.mode != ShadowMode::Off {
            render.shadows.mode = ShadowMode::Traced;
        }
        render.seed = another_seed(render.seed);
        let edit = SceneEdit {
            render: Some(render),
            ..SceneEdit::default()
        };
        Ok(apply_edit(
            &subject.description,
            &subject.loaded.scene,
            &edit,
        )?)
    }
}

/// Mean of batches of different seeds, with the variance of that mean from their scatter, and the samples
/// it took.
pub(crate) fn settle(
    renderer: &mut Renderer,
    scene: &Scene,
    size: (u32, u32),
    samples: u32,
    budget: Duration,
) -> Result<(Image, u32), BenchError> {
    let mut batches = Vec::new();
    let mut taken = 0;
    for batch in 0..BATCHES {
        let mut scene = scene.clone();
        scene.render.seed = scene.render.seed.wrapping_add(u64::from(batch) * 2);
        // Pipelines stand after the first batch, and no batch is timed.
        let warm_up = if batch == 0 { WARM_UP } else { 0 };
        let samples = samples.div_ceil(BATCHES);
        let shot = shoot(renderer, &scene, size, samples, budget / BATCHES, warm_up)?;
        taken += shot.samples;
        batches.push(shot.image);
    }
    Ok((mean_of_batches(&batches)?, taken))
}

/// Mean of independent pictures and its variance, s²/n.
fn mean_of_batches(batches: &[Image]) -> Result<Image, BenchError> {
    let n = batches.len() as f64;
    let pixels = batches[0].rgb().len();
    let mut mean = Vec::with_capacity(pixels);
    let mut variance = Vec::with_capacity(pixels);
    for i in 0..pixels {
        let values = |c: usize| batches.iter().map(move |b| f64::from(b.rgb()[i][c]));
        let m: [f64; 3] = std::array::from_fn(|c| values(c).sum::<f64>() / n);
        let v: [f64; 3] = std::array::from_fn(|c| {
            values(c).map(|value| (value - m[c]).powi(2)).sum::<f64>() / ((n - 1.0).max(1.0) * n)
        });
        mean.push(m.map(|value| value as f32));
        variance.push(v.map(|value| value as f32));
    }
    let image = Image::new(batches[0].width(), batches[0].height(), mean)?;
    Ok(image.with_variance(variance)?)
}

/// Never the seed of what is judged: shared noise would hide error.
pub(crate) fn another_seed(seed: u64) -> u64 {
    seed.wrapping_add(0x7472_7574) & ((1 << 53) - 1)
}

/// Hashes of the files that the description names. Files that those name in turn (the buffers of a
/// glTF) are not looked at.
fn files(description: &SceneDescription, folder: Option<&Path>) -> Result<Vec<String>, BenchError> {
    let text = description.to_json()?;
    let value: serde_json::Value = serde_json::from_str(&text).unwrap_or_default();
    let mut names = Vec::new();
    gather(&value, &mut names);
    let Some(folder) = folder else {
        return Ok(Vec::new());
    };
    names
        .into_iter()
        .map(|name| {
            let file = folder.join(&name);
            let bytes = std::fs::read(&file).map_err(|source| BenchError::io(file, source))?;
            Ok(hash_bytes(&bytes))
        })
        .collect()
}

/// Values of all members called `path` or `map`.
fn gather(value: &serde_json::Value, names: &mut Vec<String>) {
    match value {
        serde_json::Value::Object(members) => {
            for (name, value) in members {
                match value.as_str() {
                    Some(file) if name == "path" || name == "map" => names.push(file.to_owned()),
                    _ => gather(value, names),
                }
            }
        }
        serde_json::Value::Array(values) => values.iter().for_each(|value| gather(value, names)),
        _ => {}
    }
}

/// Writes a truth; it appears under its name only when it is complete.
fn keep(file: &Path, image: &Image, metadata: &Metadata) -> Result<(), BenchError> {
    if let Some(folder) = file.parent() {
        std::fs::create_dir_all(folder).map_err(|source| BenchError::io(folder, source))?;
    }
    let partial = file.with_extension(format!("partial-{}", std::process::id()));
    write_exr(&partial, &Layers::from_image(image), metadata)?;
    std::fs::rename(&partial, file).map_err(|source| BenchError::io(file, source))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_variance_of_a_mean_is_the_scatter_over_n() {
        let batch = |value: f32| Image::new(1, 1, vec![[value; 3]]).unwrap();
        let image = mean_of_batches(&[batch(1.0), batch(3.0)]).unwrap();
        assert_eq!(image.rgb()[0], [2.0; 3]);
        assert_eq!(image.variance().unwrap()[0], [1.0; 3]);
    }

    #[test]
    fn a_scenes_files_count_by_content() {
        let folder = std::env::temp_dir().join(format!("tyndall-truth-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let value = json!({"media": [{"path": "x.vdb"}], "lights": [{"map": "y.hdr"}]});
        let mut names = Vec::new();
        gather(&value, &mut names);
        names.sort();
        assert_eq!(names, ["x.vdb", "y.hdr"]);
        std::fs::remove_dir_all(&folder).unwrap();
    }
}
