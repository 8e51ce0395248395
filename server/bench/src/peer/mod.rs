//! Another renderer, given the same scene: Mitsuba 3 as a `python3` process.
//!
//! Needs the `PyPI` packages `mitsuba` (and `pyoidn` to denoise) and Debian's `libllvm19`; LLVM 14 is
//! refused and 15 aborts. Kernels are compiled before timing starts. Surfaces with metal or gloss are a
//! BSDF of our own there, written from glTF's specification: they need one of its compiled variants.

mod export;

use std::io::{BufRead as _, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use serde::Deserialize;
use serde_json::{Value, json};
use tyndall_picture::read_npy;
use tyndall_quality::Image;
use tyndall_scene::Scene;

use crate::claim::Claim;
use crate::error::BenchError;

/// The script, and what it imports, as they are run.
const SCRIPTS: [(&str, &str); 2] = [
    ("mitsuba_job.py", include_str!("mitsuba.py")),
    ("surfaces.py", include_str!("surfaces.py")),
];
/// Name in messages.
const PEER: &str = "mitsuba";
/// Lines of the script's standard error that a message shows.
const SHOWN: usize = 4;

/// How the peer is run.
#[derive(Debug, Clone, PartialEq)]
pub struct PeerOptions {
    /// Python with the packages.
    pub python: PathBuf,
    /// Mitsuba's variant.
    pub variant: String,
    /// Samples a pixel, ascending.
    pub samples: Vec<u32>,
    /// Denoise each picture, too.
    pub denoise: bool,
    /// No rung is started that is expected to take longer. Unit: s.
    pub row_seconds: f64,
}

/// A picture by the peer.
#[derive(Debug, Clone)]
pub(crate) struct PeerPicture {
    /// `mitsuba_volpath`, or with `+oidn`.
    pub technique: String,
    pub claim: Claim,
    pub samples: u32,
    pub seed: u64,
    /// Unit: s.
    pub seconds: f64,
    /// Unit: s.
    pub cpu_seconds: f64,
    /// Program and variant.
    pub version: String,
    /// Largest so far. Unit: byte.
    pub resident_bytes: Option<u64>,
    pub image: Image,
}

/// What the script says.
#[derive(Debug, Deserialize)]
#[serde(tag = "event", rename_all = "snake_case")]
enum Event {
    Picture {
        technique: String,
        claim: String,
        samples: u32,
        seed: u64,
        file: PathBuf,
        seconds: f64,
        cpu_seconds: f64,
        version: String,
        resident_bytes: Option<u64>,
    },
    Remark {
        what: String,
    },
    Error {
        what: String,
    },
    Done,
}

/// Renders `scene` at its size; what the peer can't be given becomes a remark and no picture.
pub(crate) fn run(
    options: &PeerOptions,
    scene: &Scene,
    remarks: &mut Vec<String>,
) -> Result<Vec<PeerPicture>, BenchError> {
    let folder = tempfile::tempdir().map_err(|source| BenchError::io("temporary", source))?;
    let exported = match export::export(scene, folder.path())? {
        Ok(exported) => exported,
        Err(what) => {
            remarks.push(format!("{PEER}: skipped, it can't be given {what}"));
            return Ok(Vec::new());
        }
    };
    let differences = exported.remarks.into_iter();
    remarks.extend(differences.map(|remark| format!("{PEER}: {remark}")));
    let mut job = exported.json;
    let settings = json!({
        "width": scene.render.width,
        "height": scene.render.height,
        "variant": options.variant,
        "samples": options.samples,
        "claims": ["whole", "one_scattering"],
        "denoise": options.denoise,
        "row_seconds": options.row_seconds,
        // Mitsuba takes 32 bits.
        "seed": scene.render.seed % (1 << 31),
    });
    if let (Value::Object(job), Value::Object(settings)) = (&mut job, settings) {
        job.extend(settings);
    }
    let job = job.to_string();
    for (name, text) in SCRIPTS.into_iter().chain([("job.json", job.as_str())]) {
        let file = folder.path().join(name);
        std::fs::write(&file, text).map_err(|source| BenchError::io(file, source))?;
    }
    let script = folder.path().join(SCRIPTS[0].0);
    talk(options, &script, &folder.path().join("job.json"), remarks)
}

fn talk(
    options: &PeerOptions,
    script: &Path,
    job: &Path,
    remarks: &mut Vec<String>,
) -> Result<Vec<PeerPicture>, BenchError> {
    let failed = |what: String| BenchError::Peer { peer: PEER, what };
    let errors = job.with_extension("stderr");
    let stderr =
        std::fs::File::create(&errors).map_err(|source| BenchError::io(&errors, source))?;
    let mut process = Command::new(&options.python)
        .arg(script)
        .arg(job)
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(stderr)
        .spawn()
        .map_err(|error| failed(format!("{}: {error}", options.python.display())))?;
    let mut pictures = Vec::new();
    let mut ended = false;
    if let Some(output) = process.stdout.take() {
        for line in BufReader::new(output).lines() {
            let line = line.map_err(|error| failed(error.to_string()))?;
            // Its libraries print, too.
            match serde_json::from_str::<Event>(&line) {
                Err(_) => note(&line, remarks),
                Ok(Event::Done) => ended = true,
                Ok(Event::Remark { what }) => remarks.push(format!("{PEER}: {what}")),
                Ok(Event::Error { what }) => {
                    process.wait().map_err(|error| failed(error.to_string()))?;
                    return Err(failed(what));
                }
                Ok(Event::Picture {
                    technique,
                    claim,
                    samples,
                    seed,
                    file,
                    seconds,
                    cpu_seconds,
                    version,
                    resident_bytes,
                }) => {
                    let claim = match claim.as_str() {
                        "whole" => Claim::Whole,
                        _ => Claim::OneScattering,
                    };
                    pictures.push(PeerPicture {
                        technique: match claim {
                            Claim::Whole => technique,
                            Claim::OneScattering => format!("{technique}_depth_2"),
                        },
                        claim,
                        samples,
                        seed,
                        seconds,
                        cpu_seconds,
                        version,
                        resident_bytes,
                        image: read_npy(&file)?,
                    });
                }
            }
        }
    }
    let status = process.wait().map_err(|error| failed(error.to_string()))?;
    if !ended {
        let text = std::fs::read_to_string(&errors).unwrap_or_default();
        let lines: Vec<&str> = text.lines().collect();
        let last = lines[lines.len().saturating_sub(SHOWN)..].join(" | ");
        return Err(failed(format!("the script ended early ({status}): {last}")));
    }
    Ok(pictures)
}

/// A line that is no event: kept where the report shows it, unless it is empty.
fn note(line: &str, remarks: &mut Vec<String>) {
    let line = line.trim();
    if !line.is_empty() {
        remarks.push(format!("{PEER} says: {line}"));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_python_that_is_not_there_is_named() {
        let options = PeerOptions {
            python: PathBuf::from("/no/such/python"),
            variant: "scalar_rgb".into(),
            samples: vec![1],
            denoise: false,
            row_seconds: 1.0,
        };
        let description = tyndall_scene::SceneDescription::from_json(
            "{\"version\": 1, \"camera\": {\"position\": [0, 0, 0], \"target\": [0, 0, -1]}}",
        )
        .unwrap();
        let scene = tyndall_scene::build(description, None).unwrap().scene;
        let error = run(&options, &scene, &mut Vec::new()).unwrap_err();
        assert!(error.to_string().contains("/no/such/python"), "{error}");
    }
}
