//! What is posted: a scene, how to render it, and what file is wanted.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use tyndall_picture::{Format, Output};
use tyndall_scene::description::CameraDescription;
use tyndall_scene::description::render::{CorrectionMode, RenderDescription, Technique};
use tyndall_scene::{SceneDescription, SceneError};

/// Most frames of one job.
pub const MOST_FRAMES: u32 = 10_000;
/// Longest name of a job. Unit: character.
pub const LONGEST_NAME: usize = 200;
/// Priorities reach from minus this to this.
pub const MOST_PRIORITY: i32 = 10;
/// Latest time of a scene that can be shown. Unit: s.
const LATEST: f64 = 1e6;

/// A job as it is posted. The scene comes by exactly one of `scene`, `preset` and `scene_file`.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct JobRequest {
    /// The scene itself; it may refer to files only if they are uploaded with it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub scene: Option<Box<SceneDescription>>,
    /// The name of a built-in scene.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub preset: Option<String>,
    /// Which of the uploaded files is the scene: a `.json` scene or a bare model.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub scene_file: Option<String>,
    /// Another camera than the scene's.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub camera: Option<CameraDescription>,
    /// The time that a still shows; 0 if left out. Unit: s. Range: 0 to 1e6.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub at_seconds: Option<f64>,
    /// What differs from the scene's own render settings.
    pub render: RenderOverrides,
    /// Frames of an animation; a still if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub frames: Option<Frames>,
    /// The file of each picture.
    pub output: Output,
    /// Whether the frames become an MP4 as well; only where the server has ffmpeg, and not of `exr`.
    pub video: bool,
    /// Jobs of higher priority are begun first and get more of the device. Range: −10 to 10.
    pub priority: i32,
    /// For people. At most 200 characters.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
}

/// Render settings that replace the scene's; at most one of `samples`, `time_seconds` and
/// `relative_error`.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct RenderOverrides {
    /// What transports the light.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub technique: Option<Technique>,
    /// When traced samples correct the technique's picture.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub correction: Option<CorrectionMode>,
    /// Unit: pixel. Range: 1 to 16384.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub width: Option<u32>,
    /// Unit: pixel. Range: 1 to 16384.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub height: Option<u32>,
    /// Finished after so many samples a pixel. Range: 1 to 65536.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub samples: Option<u32>,
    /// Finished after so many seconds of rendering. Unit: s. Range: 0.001 to 1e6.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub time_seconds: Option<f64>,
    /// Finished when the estimated relative error falls below this. Range: 1e−5 to 1.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub relative_error: Option<f64>,
    /// Seed of every random number. Range: 0 to 2⁵³ − 1.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub seed: Option<u64>,
}

impl RenderOverrides {
    /// The scene's settings with these in their place.
    pub fn applied_to(&self, render: &RenderDescription) -> RenderDescription {
        let mut render = render.clone();
        render.technique = self.technique.unwrap_or(render.technique);
        render.correction = self.correction.or(render.correction);
        render.width = self.width.unwrap_or(render.width);
        render.height = self.height.unwrap_or(render.height);
        render.seed = self.seed.unwrap_or(render.seed);
        let stops = (self.samples, self.time_seconds, self.relative_error);
        if stops != (None, None, None) {
            (render.samples, render.time_seconds, render.relative_error) = stops;
        }
        render
    }
}

/// Frames of an animation, each a picture.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Frames {
    /// Number of the first frame; frame n shows the time n / `per_second`.
    #[serde(default)]
    pub first: u32,
    /// Number of the last frame.
    pub last: u32,
    /// Unit: s⁻¹. Range: 0.001 to 1000.
    #[serde(default = "usual_rate")]
    pub per_second: f64,
}

fn usual_rate() -> f64 {
    24.0
}

impl Frames {
    /// How many there are.
    pub fn count(&self) -> u32 {
        self.last.saturating_sub(self.first).saturating_add(1)
    }

    /// The time that a frame shows. Unit: s.
    pub fn seconds(&self, frame: u32) -> f64 {
        f64::from(frame) / self.per_second
    }
}

impl JobRequest {
    /// Reads JSON text.
    ///
    /// # Errors
    /// [`SceneError`] with the JSON path of what is wrong.
    pub fn parse(text: &str) -> Result<Self, SceneError> {
        let request: Self = tyndall_scene::parse_json(text)?;
        request.check()?;
        Ok(request)
    }

    /// Checks what can be checked without the scene.
    ///
    /// # Errors
    /// [`SceneError::Invalid`] with the JSON path of what is wrong.
    pub fn check(&self) -> Result<(), SceneError> {
        let scenes = [
            self.scene.is_some(),
            self.preset.is_some(),
            self.scene_file.is_some(),
        ];
        let named = scenes.into_iter().filter(|is| *is).count();
        if named != 1 {
            return Err(invalid(
                "",
                format!("{named} scenes"),
                "exactly one of scene, preset and scene_file",
            ));
        }
        if self
            .at_seconds
            .is_some_and(|at| !(0.0..=LATEST).contains(&at))
        {
            let found = format!("{:?}", self.at_seconds.unwrap_or_default());
            return Err(invalid("at_seconds", found, "0 to 1e6"));
        }
        if !(-MOST_PRIORITY..=MOST_PRIORITY).contains(&self.priority) {
            return Err(invalid("priority", self.priority.to_string(), "-10 to 10"));
        }
        let length = self.name.as_ref().map_or(0, |name| name.chars().count());
        if length > LONGEST_NAME {
            let found = format!("{length} characters");
            return Err(invalid("name", found, "at most 200"));
        }
        self.check_frames()?;
        self.check_output()
    }

    fn check_frames(&self) -> Result<(), SceneError> {
        let Some(frames) = &self.frames else {
            return Ok(());
        };
        if self.at_seconds.is_some() {
            let allowed = "nothing beside frames, which have their own times";
            return Err(invalid("at_seconds", "a time".to_owned(), allowed));
        }
        if frames.last < frames.first {
            let found = format!("{} before the first", frames.last);
            return Err(invalid("frames.last", found, "at least frames.first"));
        }
        if frames.count() > MOST_FRAMES {
            let found = format!("{} frames", frames.count());
            return Err(invalid("frames", found, "at most 10000"));
        }
        if !(1e-3..=1e3).contains(&frames.per_second) {
            let found = frames.per_second.to_string();
            return Err(invalid("frames.per_second", found, "0.001 to 1000"));
        }
        if frames.seconds(frames.last) > LATEST {
            let found = format!("{} s", frames.seconds(frames.last));
            return Err(invalid("frames.last", found, "a time of at most 1e6 s"));
        }
        Ok(())
    }

    fn check_output(&self) -> Result<(), SceneError> {
        let is_exr = self.output.format == Format::Exr;
        if let Some(layers) = &self.output.layers {
            if !is_exr {
                let allowed = "layers only of the format exr";
                return Err(invalid("output.layers", "a list".to_owned(), allowed));
            }
            let repeated = (1..layers.len()).find(|at| layers[..*at].contains(&layers[*at]));
            if let Some(at) = repeated {
                let path = format!("output.layers[{at}]");
                return Err(invalid(&path, "a layer again".to_owned(), "each once"));
            }
        }
        if self.video && (is_exr || self.frames.is_none()) {
            let allowed = "true only with frames, in png or jpeg";
            return Err(invalid("video", "true".to_owned(), allowed));
        }
        Ok(())
    }
}

/// A value of the request that is wrong.
pub(crate) fn invalid(path: &str, found: String, allowed: &str) -> SceneError {
    SceneError::Invalid {
        path: path.to_owned(),
        found,
        allowed: allowed.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wrong(text: &str) -> String {
        JobRequest::parse(text).unwrap_err().to_string()
    }

    #[test]
    fn a_request_is_read_back_as_it_was_written() {
        let text = r#"{"preset": "cloud", "render": {"width": 64, "samples": 4},
            "frames": {"last": 9}, "output": {"format": "exr", "layers": ["depth"]}, "priority": 3}"#;
        let request = JobRequest::parse(text).unwrap();
        let written = serde_json::to_string(&request).unwrap();
        assert_eq!(JobRequest::parse(&written).unwrap(), request);
        let frames = request.frames.unwrap();
        assert_eq!((frames.count(), frames.seconds(12)), (10, 0.5));
    }

    #[test]
    fn what_is_wrong_is_named_with_its_place() {
        for (text, place) in [
            ("{}", "exactly one of"),
            (r#"{"preset": "a", "scene_file": "b"}"#, "2 scenes"),
            (r#"{"preset": "a", "priority": 11}"#, "priority"),
            (r#"{"preset": "a", "at_seconds": -1}"#, "at_seconds"),
            (
                r#"{"preset": "a", "frames": {"first": 2, "last": 1}}"#,
                "frames.last",
            ),
            (
                r#"{"preset": "a", "frames": {"last": 10000}}"#,
                "10001 frames",
            ),
            (
                r#"{"preset": "a", "frames": {"last": 1, "per_second": 0}}"#,
                "per_second",
            ),
            (
                r#"{"preset": "a", "frames": {"last": 1}, "at_seconds": 1}"#,
                "at_seconds",
            ),
            (r#"{"preset": "a", "video": true}"#, "video"),
            (
                r#"{"preset": "a", "output": {"layers": []}}"#,
                "output.layers",
            ),
            (
                r#"{"preset": "a", "output": {"format": "bmp"}}"#,
                "output.format",
            ),
            (
                r#"{"preset": "a", "output": {"format": "exr", "layers": ["depth", "depth"]}}"#,
                "output.layers[1]",
            ),
            (r#"{"preset": "a", "colour": 1}"#, "colour"),
        ] {
            let error = wrong(text);
            assert!(error.contains(place), "{text}: {error}");
        }
    }

    #[test]
    fn a_stop_rule_replaces_the_scenes_whole() {
        let scene = RenderDescription {
            samples: Some(8),
            ..RenderDescription::default()
        };
        let overrides = RenderOverrides {
            relative_error: Some(0.1),
            ..RenderOverrides::default()
        };
        let render = overrides.applied_to(&scene);
        assert_eq!((render.samples, render.relative_error), (None, Some(0.1)));
        let same = RenderOverrides::default().applied_to(&scene);
        assert_eq!(same, scene);
    }
}
