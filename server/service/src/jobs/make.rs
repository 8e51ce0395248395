//! A task's result: found, or rendered, encoded and stored.

use std::fmt::Display;
use std::sync::Arc;

use tyndall_jobs::queue::objects_of;
use tyndall_jobs::{Failure, FailureKind, LeasedTask, ResultsError, Spec, StoredObject, TaskKind};
use tyndall_scene::{Loaded, Scene, SceneDescription};
use tyndall_still::{FinishedStill, encode};

use super::accept::load;
use super::{Jobs, MOST_SCENES, video};
use crate::bell::lock;
use crate::stills::{StillFailure, StillReply, StillWatch};

/// What became of a task.
#[derive(Debug)]
pub(super) enum Made {
    /// Its result is stored: a whole one, or of a stopped task what there was.
    Stored(StoredObject),
    /// It was stopped before there was anything.
    Nothing,
    /// The device went away without its fault.
    Interrupted,
}

fn failure(kind: FailureKind, reason: &dyn Display) -> Failure {
    Failure {
        kind,
        reason: reason.to_string(),
    }
}

#[allow(clippy::needless_pass_by_value, reason = "for map_err")]
fn passing(error: impl Display) -> Failure {
    failure(FailureKind::Passing, &error)
}

#[allow(clippy::needless_pass_by_value, reason = "for map_err")]
fn for_good(error: impl Display) -> Failure {
    failure(FailureKind::ForGood, &error)
}

impl From<StillFailure> for Failure {
    fn from(error: StillFailure) -> Self {
        let kind = match error {
            StillFailure::Refused(_) => FailureKind::ForGood,
            StillFailure::DeviceLost(_) => FailureKind::DeviceLost,
            StillFailure::Passing(_) | StillFailure::Interrupted => FailureKind::Passing,
        };
        failure(kind, &error)
    }
}

impl Jobs {
    /// Makes what a task wants. `watch` says how far it is, and stops it.
    pub(super) async fn make(
        self: &Arc<Self>,
        task: &LeasedTask,
        watch: &Arc<StillWatch>,
    ) -> Result<Made, Failure> {
        match task.kind {
            TaskKind::Video => self.make_video(task, watch).await,
            TaskKind::Frame => {
                if let Some(known) = self.known(&task.spec_hash).await? {
                    return Ok(Made::Stored(known));
                }
                self.make_frame(task, watch).await
            }
        }
    }

    /// The stored result of the same task of any job, if it is whole.
    async fn known(&self, spec_hash: &str) -> Result<Option<StoredObject>, Failure> {
        let known = self.queue.known_object(spec_hash).await.map_err(passing)?;
        let Some(object) = known else {
            return Ok(None);
        };
        if self.results.is_intact(&object).await.map_err(passing)? {
            return Ok(Some(object));
        }
        tracing::warn!(
            key = object.key,
            "a stored result is missing or broken: it is made again"
        );
        Ok(None)
    }

    async fn make_frame(
        self: &Arc<Self>,
        task: &LeasedTask,
        watch: &Arc<StillWatch>,
    ) -> Result<Made, Failure> {
        let loaded = self.scene_of(task).await?;
        let (description, scene) = self.frame_scene(task, loaded).await?;
        let scene = Arc::new(scene);
        // Ten steps of priority are a factor of about 6.
        let weight = (0.18 * f64::from(task.job.priority)).exp();
        let order = self
            .desk
            .order(Arc::clone(&scene), weight, Arc::clone(watch));
        let reply = match order.await {
            Ok(Ok(reply)) => reply,
            Ok(Err(StillFailure::Interrupted)) | Err(_) => return Ok(Made::Interrupted),
            Ok(Err(error)) => return Err(error.into()),
        };
        let stopped = watch.is_stopped();
        let StillReply { still, adapter } = reply;
        let Some(still) = still else {
            return Ok(Made::Nothing);
        };
        if still.non_finite > 0 && !stopped {
            return Err(for_good(format!(
                "{} samples were not finite",
                still.non_finite
            )));
        }
        let output = task.job.request.output.clone();
        let key = Self::key(task, output.format.extension(), stopped);
        let bytes = tokio::task::spawn_blocking(move || {
            let names = (adapter.name.as_str(), adapter.driver.as_str());
            let finished = FinishedStill::new(still, &description, &scene, names)?;
            encode(&finished, &output)
        });
        let bytes = bytes.await.map_err(passing)?.map_err(for_good)?;
        Ok(Made::Stored(
            self.results.put_new(&key, bytes).await.map_err(passing)?,
        ))
    }

    /// The name of a task's object. Each attempt has its own, so a late one disturbs no other.
    fn key(task: &LeasedTask, extension: &str, is_partial: bool) -> String {
        let lease = &task.lease;
        let folder = objects_of(&lease.job);
        let partial = if is_partial { "-partial" } else { "" };
        format!(
            "{folder}{:05}-{}{partial}.{extension}",
            lease.number, lease.attempt
        )
    }

    /// The scene that a task shows.
    async fn frame_scene(
        &self,
        task: &LeasedTask,
        loaded: Arc<Loaded>,
    ) -> Result<(SceneDescription, Scene), Failure> {
        let (request, number) = (task.job.request.clone(), task.lease.number);
        let built = tokio::task::spawn_blocking(move || {
            let spec = Spec {
                request: &request,
                loaded: &loaded,
            };
            spec.scene(number)
        });
        built.await.map_err(passing)?.map_err(for_good)
    }

    /// The loaded scene of a task's job, kept as long as frames of it follow.
    async fn scene_of(self: &Arc<Self>, task: &LeasedTask) -> Result<Arc<Loaded>, Failure> {
        let id = &task.lease.job;
        let kept = |scenes: &[(tyndall_jobs::JobId, Arc<Loaded>)]| {
            let found = scenes.iter().find(|(job, _)| job == id);
            found.map(|(_, loaded)| Arc::clone(loaded))
        };
        if let Some(loaded) = kept(&lock(&self.scenes)) {
            return Ok(loaded);
        }
        let _permit = self.loading.acquire().await.map_err(passing)?;
        if let Some(loaded) = kept(&lock(&self.scenes)) {
            return Ok(loaded);
        }
        let folder = self.upload_folder(id);
        let request = task.job.request.clone();
        let loaded = tokio::task::spawn_blocking(move || {
            let folder = folder.is_dir().then_some(folder);
            load(&request, folder.as_deref(), false)
        });
        let loaded = Arc::new(loaded.await.map_err(passing)?.map_err(for_good)?);
        let mut scenes = lock(&self.scenes);
        scenes.truncate(MOST_SCENES - 1);
        scenes.insert(0, (id.clone(), Arc::clone(&loaded)));
        Ok(loaded)
    }

    async fn make_video(
        self: &Arc<Self>,
        task: &LeasedTask,
        watch: &Arc<StillWatch>,
    ) -> Result<Made, Failure> {
        let Some(ffmpeg) = &self.ffmpeg else {
            return Err(for_good("this server has no ffmpeg any more"));
        };
        let tasks = self.queue.tasks(&task.lease.job).await.map_err(passing)?;
        let frames = tasks
            .into_iter()
            .filter(|task| task.kind == TaskKind::Frame);
        let keys: Option<Vec<String>> = frames
            .map(|task| task.object.map(|object| object.key))
            .collect();
        let keys = keys.ok_or_else(|| passing("a frame of the video is not stored"))?;
        let rate = task
            .job
            .request
            .frames
            .map_or(24.0, |frames| frames.per_second);
        let folder = self.passing_folder();
        let made = video::encode(ffmpeg, &folder, &self.results, &keys, rate, watch);
        let Some(bytes) = made.await.map_err(|error| match error {
            video::VideoError::Results(error @ ResultsError::Missing { .. }) => for_good(error),
            other => passing(other),
        })?
        else {
            return Ok(Made::Nothing);
        };
        let key = Self::key(task, "mp4", false);
        Ok(Made::Stored(
            self.results.put_new(&key, bytes).await.map_err(passing)?,
        ))
    }
}
