//! What a job renders: one task a frame, and names of results that follow from what they are made of.
//!
//! Two tasks that would give the same picture have the same name, so a frame that is stored already is not
//! rendered again.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::json;
use tyndall_picture::{PictureError, hash_json, scene_hash};
use tyndall_scene::{Loaded, Scene, SceneDescription, SceneEdit, SceneError};

use crate::request::JobRequest;

/// What a task makes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum TaskKind {
    /// A picture.
    Frame,
    /// A video of all pictures of its job.
    Video,
}

impl TaskKind {
    /// Its JSON name.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Frame => "frame",
            Self::Video => "video",
        }
    }
}

/// A task before it is queued.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TaskSpec {
    /// What it makes.
    pub kind: TaskKind,
    /// Name of its result by what it is made from.
    pub spec_hash: String,
}

/// Why a job cannot be rendered.
#[derive(Debug, thiserror::Error)]
pub enum SpecError {
    /// The scene and the request do not fit.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// The description cannot be hashed.
    #[error(transparent)]
    Hash(#[from] PictureError),
}

/// A request together with its scene.
#[derive(Debug)]
pub struct Spec<'a> {
    /// What was asked for.
    pub request: &'a JobRequest,
    /// The scene as it was loaded.
    pub loaded: &'a Loaded,
}

impl Spec<'_> {
    /// The time that a task shows. Unit: s.
    pub fn seconds(&self, number: u32) -> f64 {
        match &self.request.frames {
            Some(frames) => frames.seconds(frames.first.saturating_add(number)),
            None => self.request.at_seconds.unwrap_or(0.0),
        }
    }

    /// The scene that a task renders, with its description.
    ///
    /// # Errors
    /// [`SceneError`] where the request does not fit the scene.
    pub fn scene(&self, number: u32) -> Result<(SceneDescription, Scene), SceneError> {
        let (description, request) = (&self.loaded.description, self.request);
        let edit = SceneEdit {
            camera: request.camera.clone(),
            render: Some(request.render.applied_to(&description.render)),
            time_seconds: Some(self.seconds(number)),
            ..SceneEdit::default()
        };
        tyndall_scene::apply_edit(description, &self.loaded.scene, &edit)
    }

    /// The job's tasks; `content` stands for the files that the scene refers to.
    ///
    /// # Errors
    /// [`SpecError`] where the request does not fit the scene.
    pub fn tasks(&self, content: &str) -> Result<Vec<TaskSpec>, SpecError> {
        let (description, _) = self.scene(0)?;
        let scene = scene_hash(&description)?;
        let count = self.request.frames.map_or(1, |frames| frames.count());
        let frame = |number: u32| TaskSpec {
            kind: TaskKind::Frame,
            spec_hash: hash_json(&json!({
                "version": env!("CARGO_PKG_VERSION"),
                "scene": scene,
                "content": content,
                "seconds": self.seconds(number),
                "output": self.request.output,
            })),
        };
        let mut tasks: Vec<TaskSpec> = (0..count).map(frame).collect();
        if self.request.video {
            let frames: Vec<&str> = tasks.iter().map(|task| task.spec_hash.as_str()).collect();
            let rate = self.request.frames.map(|frames| frames.per_second);
            let spec_hash = hash_json(&json!({ "video": frames, "rate": rate }));
            tasks.push(TaskSpec {
                kind: TaskKind::Video,
                spec_hash,
            });
        }
        Ok(tasks)
    }
}

/// The file name of a task's result.
pub fn result_name(request: &JobRequest, kind: TaskKind, number: u32) -> String {
    let extension = request.output.format.extension();
    match (kind, &request.frames) {
        (TaskKind::Video, _) => "video.mp4".to_owned(),
        (TaskKind::Frame, None) => format!("picture.{extension}"),
        (TaskKind::Frame, Some(frames)) => {
            format!(
                "frame_{:05}.{extension}",
                frames.first.saturating_add(number)
            )
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn loaded() -> Loaded {
        let description = tyndall_scene::presets::description("swinging_lamp").unwrap();
        tyndall_scene::build(description, None).unwrap()
    }

    fn hashes(loaded: &Loaded, text: &str, content: &str) -> Vec<String> {
        let request = &JobRequest::parse(text).unwrap();
        let tasks = Spec { request, loaded }.tasks(content).unwrap();
        tasks.into_iter().map(|task| task.spec_hash).collect()
    }

    #[test]
    fn names_follow_from_what_results_are_made_of_and_nothing_else() {
        let loaded = loaded();
        let five = hashes(
            &loaded,
            r#"{"preset": "swinging_lamp", "frames": {"last": 4}}"#,
            "",
        );
        assert_eq!(five.len(), 5);
        let later =
            r#"{"preset": "swinging_lamp", "priority": 5, "frames": {"first": 2, "last": 6}}"#;
        let later = hashes(&loaded, later, "");
        assert_eq!(five[2..], later[..3], "the same times");
        assert!(five.iter().all(|hash| !later[3..].contains(hash)));
        let other = r#"{"preset": "swinging_lamp", "render": {"seed": 1}, "frames": {"last": 4}}"#;
        assert!(
            hashes(&loaded, other, "")
                .iter()
                .all(|hash| !five.contains(hash))
        );
        let files = hashes(
            &loaded,
            r#"{"preset": "swinging_lamp", "frames": {"last": 4}}"#,
            "a",
        );
        assert!(files.iter().all(|hash| !five.contains(hash)));
    }

    #[test]
    fn a_video_comes_last_and_results_have_names() {
        let text =
            r#"{"preset": "swinging_lamp", "video": true, "frames": {"first": 7, "last": 8}}"#;
        let request = JobRequest::parse(text).unwrap();
        let tasks = Spec {
            request: &request,
            loaded: &loaded(),
        }
        .tasks("")
        .unwrap();
        let names: Vec<String> = (0..)
            .zip(&tasks)
            .map(|(number, task)| result_name(&request, task.kind, number))
            .collect();
        assert_eq!(names, ["frame_00007.png", "frame_00008.png", "video.mp4"]);
    }
}
