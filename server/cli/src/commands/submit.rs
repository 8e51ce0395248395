//! `tyndall submit`: a scene with its files to a server, its pictures back.

use std::fs::File;
use std::io::{self, Cursor, IsTerminal as _, Read, Write as _};
use std::path::{Path, PathBuf};
use std::time::Duration;

use anyhow::{Context as _, bail};
use clap::Args;
use indicatif::{ProgressBar, ProgressStyle};
use serde_json::{Value, json};
use tyndall_picture::hash_bytes;
use tyndall_scene::description::render::{CorrectionMode, Technique};
use tyndall_scene::presets;
use ureq::SendBody;
use ureq::http::Response;

use crate::{output, scene_argument};

/// How often the server is asked how the job stands.
const ASK_EVERY: Duration = Duration::from_millis(200);
/// Longest answer besides results. Unit: byte.
const LONGEST_ANSWER: u64 = 16 << 20;
/// Between the parts of a form; file names and JSON have no such line.
const BOUNDARY: &str = "tyndall-8f2c1e5a90b74d36";

/// Render a scene on a server and fetch the pictures.
#[derive(Debug, Args)]
pub struct Submit {
    /// Preset, .json scene, or bare .gltf, .glb or .obj model; its files are uploaded.
    scene: String,
    /// Where the server is, such as <http://127.0.0.1:8080>.
    #[arg(long, env = "TYNDALL_SERVER", value_name = "URL")]
    server: String,
    /// Secret that the server asks for.
    #[arg(long, env = "TYNDALL_TOKEN", hide_env_values = true)]
    token: Option<String>,
    /// File to write, .exr, .png or .jpg; with --frames a folder, whose pictures are --format.
    #[arg(short, long)]
    output: PathBuf,
    /// Format of the pictures of an animation: png, exr or jpeg.
    #[arg(long, default_value = "png")]
    format: String,
    /// Frames of an animation, such as 0..47.
    #[arg(long, value_parser = frames)]
    frames: Option<(u32, u32)>,
    /// Frames a second.
    #[arg(long, default_value_t = 24.0, requires = "frames")]
    per_second: f64,
    /// Make a video of the frames as well, where the server can.
    #[arg(long, requires = "frames")]
    video: bool,
    /// Width in pixels; the scene's without it.
    #[arg(long)]
    width: Option<u32>,
    /// Height in pixels; the scene's without it.
    #[arg(long)]
    height: Option<u32>,
    /// What transports the light, by its JSON name; the scene's without it.
    #[arg(long, value_parser = scene_argument::technique)]
    technique: Option<Technique>,
    /// When traced samples correct the picture: `off`, `at_rest` or `always`.
    #[arg(long, value_parser = scene_argument::correction)]
    correction: Option<CorrectionMode>,
    /// Samples a pixel.
    #[arg(long, group = "stop")]
    samples: Option<u32>,
    /// Time of rendering: 10, 10s, 500ms or 2m.
    #[arg(long, group = "stop", value_parser = scene_argument::seconds)]
    time: Option<f64>,
    /// Estimated relative error to reach, 0.01 for 1 %.
    #[arg(long, group = "stop")]
    error: Option<f64>,
    /// Time that the scene is shown at, in seconds.
    #[arg(long, value_name = "SECONDS", conflicts_with = "frames")]
    at: Option<f64>,
    /// Seed of every random number.
    #[arg(long)]
    seed: Option<u64>,
    /// Jobs of higher priority are begun first; -10 to 10.
    #[arg(long, default_value_t = 0, allow_negative_numbers = true)]
    priority: i32,
    /// No progress bar.
    #[arg(short, long)]
    quiet: bool,
}

/// The scene's file, and those that it refers to, by their names in the upload.
type Files = Vec<(String, PathBuf)>;

impl Submit {
    pub fn run(self) -> anyhow::Result<()> {
        if self.frames.is_none() {
            output::format(&self.output)?;
        }
        let server = Server::new(&self.server, self.token.clone())?;
        let (scene, files) = self.scene()?;
        let job = self.job(scene)?;
        let accepted = if files.is_empty() {
            server.post_json(&job)?
        } else {
            server.post_form(&job, &files)?
        };
        let id = accepted["id"].as_str().context("the server named no job")?;
        if !self.quiet {
            writeln!(io::stderr().lock(), "job {id}")?;
        }
        let bar = self.bar()?;
        let path = format!("/v1/jobs/{id}");
        let status = loop {
            let status = server.get(&path)?;
            bar.set_position((1000.0 * status["fraction"].as_f64().unwrap_or(0.0)) as u64);
            if !matches!(status["state"].as_str(), Some("queued" | "running")) {
                break status;
            }
            std::thread::sleep(ASK_EVERY);
        };
        bar.finish_and_clear();
        if status["state"] != "done" {
            let state = status["state"].as_str().unwrap_or("lost");
            let why = status["error"].as_str().unwrap_or("nobody said why");
            bail!("job {id} is {state}: {why}");
        }
        self.fetch(&server, &format!("{path}/results"))
    }

    /// How the job names its scene, and what has to be uploaded for it.
    fn scene(&self) -> anyhow::Result<(Value, Files)> {
        if presets::description(&self.scene).is_some() {
            return Ok((json!({ "preset": self.scene }), Vec::new()));
        }
        let path = Path::new(&self.scene);
        // What the server would refuse is found here, before anything is sent.
        let loaded = scene_argument::load(&self.scene)?;
        let folder = path.parent().unwrap_or(Path::new(""));
        let file = path.file_name().and_then(|name| name.to_str());
        let file = file.context("the name of the scene's file is not UTF-8")?;
        let mut files = vec![(file.to_owned(), path.to_owned())];
        let others = loaded.files.into_iter().filter(|name| name != file);
        files.extend(others.map(|name| {
            let path = folder.join(&name);
            (name, path)
        }));
        Ok((json!({ "scene_file": file }), files))
    }

    fn job(&self, scene: Value) -> anyhow::Result<Value> {
        let mut job = scene;
        let format = match self.frames {
            Some(_) => self.format.clone(),
            None => serde_json::to_value(output::format(&self.output)?)?
                .as_str()
                .unwrap_or_default()
                .to_owned(),
        };
        job["output"] = json!({ "format": format });
        job["priority"] = self.priority.into();
        job["video"] = self.video.into();
        if let Some((first, last)) = self.frames {
            job["frames"] = json!({ "first": first, "last": last, "per_second": self.per_second });
        }
        if let Some(at) = self.at {
            job["at_seconds"] = at.into();
        }
        let render = [
            ("width", json!(self.width)),
            ("height", json!(self.height)),
            ("technique", json!(self.technique)),
            ("correction", json!(self.correction)),
            ("samples", json!(self.samples)),
            ("time_seconds", json!(self.time)),
            ("relative_error", json!(self.error)),
            ("seed", json!(self.seed)),
        ];
        let given = render.into_iter().filter(|(_, value)| !value.is_null());
        job["render"] = given
            .map(|(name, value)| (name.to_owned(), value))
            .collect();
        Ok(job)
    }

    fn fetch(&self, server: &Server, path: &str) -> anyhow::Result<()> {
        let results = server.get(path)?;
        let results = results.as_array().context("the server listed no results")?;
        if self.frames.is_some() {
            std::fs::create_dir_all(&self.output)
                .with_context(|| format!("cannot make {}", self.output.display()))?;
        }
        for result in results {
            let text = |name: &str| result[name].as_str().unwrap_or_default();
            let (name, url, sha256) = (text("name"), text("url"), text("sha256"));
            let plain = |c: char| c.is_ascii_alphanumeric() || c == '.' || c == '_';
            if name.is_empty() || !name.chars().all(plain) {
                bail!("the server named a result {name:?}");
            }
            let bytes = server.get_bytes(url, result["bytes"].as_u64().unwrap_or(0))?;
            if !sha256.starts_with(&hash_bytes(&bytes)) {
                bail!("{name} arrived broken");
            }
            let target = match self.frames {
                Some(_) => self.output.join(name),
                None => self.output.clone(),
            };
            output::write(&target, &bytes)
                .with_context(|| format!("cannot write {}", target.display()))?;
            if !self.quiet {
                writeln!(io::stderr().lock(), "{}", target.display())?;
            }
        }
        Ok(())
    }

    fn bar(&self) -> anyhow::Result<ProgressBar> {
        if self.quiet || !io::stderr().is_terminal() {
            return Ok(ProgressBar::hidden());
        }
        let style = ProgressStyle::with_template("{bar:40} {percent} %  {elapsed}, left {eta}")?;
        Ok(ProgressBar::new(1000).with_style(style))
    }
}

/// A server that takes jobs.
struct Server {
    agent: ureq::Agent,
    root: String,
    token: Option<String>,
}

impl Server {
    fn new(url: &str, token: Option<String>) -> anyhow::Result<Self> {
        let root = url.trim_end_matches('/').to_owned();
        if !root.starts_with("http://") {
            bail!(
                "{url}: the address of a server begins with http://; for https put a tunnel before it"
            );
        }
        let config = ureq::Agent::config_builder().http_status_as_error(false);
        Ok(Self {
            agent: config.build().into(),
            root,
            token,
        })
    }

    fn authorization(&self) -> String {
        let token = self.token.as_ref();
        token.map_or_else(String::new, |token| format!("Bearer {token}"))
    }

    fn get(&self, path: &str) -> anyhow::Result<Value> {
        let request = self.agent.get(format!("{}{path}", self.root));
        answer(
            request
                .header("Authorization", self.authorization())
                .call()?,
        )
    }

    fn get_bytes(&self, path: &str, bytes: u64) -> anyhow::Result<Vec<u8>> {
        let request = self.agent.get(format!("{}{path}", self.root));
        let response = request
            .header("Authorization", self.authorization())
            .call()?;
        if !response.status().is_success() {
            answer(response)?;
            bail!("{path}: the server gave no file");
        }
        let mut found = Vec::new();
        let mut body = response.into_body().into_reader().take(bytes + 1);
        body.read_to_end(&mut found)?;
        Ok(found)
    }

    fn post_json(&self, job: &Value) -> anyhow::Result<Value> {
        let request = self.agent.post(format!("{}/v1/jobs", self.root));
        let request = request.header("Authorization", self.authorization());
        answer(
            request
                .header("Content-Type", "application/json")
                .send(job.to_string())?,
        )
    }

    /// Sends the job and its files as a form, a file after the other.
    fn post_form(&self, job: &Value, files: &Files) -> anyhow::Result<Value> {
        let head = |disposition: &str| {
            format!("--{BOUNDARY}\r\nContent-Disposition: form-data; {disposition}\r\n\r\n")
        };
        let mut body: Box<dyn Read> =
            Box::new(Cursor::new(format!("{}{job}\r\n", head("name=\"job\""))));
        for (name, path) in files {
            if name.contains(['"', '\r', '\n']) {
                bail!("{name:?}: a file with such a name cannot be uploaded");
            }
            let file = File::open(path).with_context(|| path.display().to_string())?;
            let start = head(&format!("name=\"file\"; filename=\"{name}\""));
            let part = Cursor::new(start).chain(file).chain(Cursor::new("\r\n"));
            body = Box::new(body.chain(part));
        }
        let mut body = body.chain(Cursor::new(format!("--{BOUNDARY}--\r\n")));
        let request = self.agent.post(format!("{}/v1/jobs", self.root));
        let request = request.header("Authorization", self.authorization());
        let kind = format!("multipart/form-data; boundary={BOUNDARY}");
        let request = request.header("Content-Type", kind);
        answer(request.send(SendBody::from_reader(&mut body))?)
    }
}

/// The JSON of an answer, or what the server says is wrong.
fn answer(response: Response<ureq::Body>) -> anyhow::Result<Value> {
    let status = response.status();
    let mut text = String::new();
    let mut body = response.into_body().into_reader().take(LONGEST_ANSWER);
    body.read_to_string(&mut text)?;
    let value: Value = serde_json::from_str(&text).unwrap_or(Value::Null);
    if status.is_success() {
        return Ok(value);
    }
    let detail = value["detail"].as_str().unwrap_or("it said nothing more");
    bail!("the server answers {status}: {detail}");
}

/// Frames as `0..47`, both ends included.
fn frames(text: &str) -> Result<(u32, u32), String> {
    let wrong = || format!("{text}: frames are written like 0..47");
    let (first, last) = text.split_once("..").ok_or_else(wrong)?;
    let number = |text: &str| text.parse::<u32>().map_err(|_not_a_number| wrong());
    Ok((number(first)?, number(last)?))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_have_two_ends() {
        assert_eq!(frames("0..47"), Ok((0, 47)));
        for text in ["", "3", "a..b", "1..", "-1..2"] {
            assert!(frames(text).is_err(), "{text}");
        }
    }
}
