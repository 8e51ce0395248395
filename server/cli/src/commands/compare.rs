//! `tyndall compare`: how far one picture is from another.

use std::io::Write as _;
use std::path::{Path, PathBuf};

use anyhow::{Context as _, bail};
use clap::Args;
use serde_json::{Map, Value, json};
use tyndall_picture::{Picture, Range, read, write_png};
use tyndall_quality::{Comparison, FlipMap, Image, PIXELS_PER_DEGREE, hdr_flip, ldr_flip, magma};

/// Print every error measure of a picture against a reference.
///
/// Variance is used where a file has it: `variance` layers of .exr, `stderr` of .npz. Displayed
/// pictures (.png, .jpg) have no radiance: only what a person would see differ is measured.
#[derive(Debug, Args)]
pub struct Compare {
    /// Picture to judge: .exr, .hdr, .npy, .npz, .png or .jpg.
    image: PathBuf,
    /// Picture that counts as the truth.
    reference: PathBuf,
    /// Write FLIP's errors as a picture: black where no difference is seen, yellow at 1.
    #[arg(long)]
    error_image: Option<PathBuf>,
    /// One JSON object instead of lines.
    #[arg(long)]
    json: bool,
}

impl Compare {
    pub fn run(self) -> anyhow::Result<()> {
        let picture = load(&self.image)?;
        let reference = load(&self.reference)?;
        if picture.range != reference.range {
            bail!(
                "{} and {}: one holds radiance, the other displayed values; compare two of a kind",
                self.image.display(),
                self.reference.display()
            );
        }
        let (measures, map) = match picture.range {
            Range::Hdr => radiance(&picture.image, &reference.image)?,
            Range::Ldr => displayed(&picture.image, &reference.image)?,
        };
        if let Some(path) = &self.error_image {
            let pixels: Vec<[u8; 3]> = map.errors.iter().map(|error| magma(*error)).collect();
            write_png(path, map.width, map.height, &pixels)?;
        }
        let mut out = std::io::stdout().lock();
        if self.json {
            writeln!(out, "{}", serde_json::to_string_pretty(&measures)?)?;
        } else {
            print(&mut out, "", &measures)?;
        }
        Ok(())
    }
}

/// A picture of finite values.
fn load(path: &Path) -> anyhow::Result<Picture> {
    let picture = read(path)?;
    let bad = picture.image.non_finite();
    if bad > 0 {
        bail!("{}: {bad} pixels are not finite", path.display());
    }
    Ok(picture)
}

fn radiance(image: &Image, reference: &Image) -> anyhow::Result<(Map<String, Value>, FlipMap)> {
    let Value::Object(mut measures) = serde_json::to_value(Comparison::of(image, reference)?)?
    else {
        bail!("the measures are no object");
    };
    let flip = hdr_flip(image, reference, PIXELS_PER_DEGREE).context("FLIP")?;
    measures.insert(
        "hdr_flip_exposures".into(),
        json!([flip.start_exposure, flip.stop_exposure, flip.exposures]),
    );
    Ok((measures, flip.map))
}

fn displayed(image: &Image, reference: &Image) -> anyhow::Result<(Map<String, Value>, FlipMap)> {
    let map = ldr_flip(image, reference, PIXELS_PER_DEGREE)?;
    let mut measures = Map::new();
    measures.insert("ldr_flip".into(), map.mean().into());
    Ok((measures, map))
}

/// One line a number; what is not known is said to be so.
fn print(
    out: &mut impl std::io::Write,
    prefix: &str,
    measures: &Map<String, Value>,
) -> std::io::Result<()> {
    for (name, value) in measures {
        let name = format!("{prefix}{name}");
        match value {
            Value::Object(inner) => print(out, &format!("{name}."), inner)?,
            Value::Null => writeln!(
                out,
                "{name:<48} needs a variance that neither or only the other file has"
            )?,
            Value::Number(number) => {
                let number = number.as_f64().unwrap_or(f64::NAN);
                writeln!(out, "{name:<48} {number:.6}")?;
            }
            other => writeln!(out, "{name:<48} {other}")?,
        }
    }
    Ok(())
}
