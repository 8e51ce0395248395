//! What clients are told of a job.

use schemars::JsonSchema;
use serde::Serialize;
use tyndall_jobs::spec::result_name;
use tyndall_jobs::{JobId, JobRecord, JobState, QueueError, TaskRecord, TaskState};

use super::{Jobs, now};

/// A job as it stands.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub(crate) struct JobStatus {
    /// Its name in addresses.
    pub(crate) id: JobId,
    /// What its submitter called it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) name: Option<String>,
    /// Where it stands.
    pub(crate) state: JobState,
    /// Greater is earlier.
    pub(crate) priority: i32,
    /// Grows with every change of state.
    pub(crate) revision: u64,
    /// When it was accepted. Unit: ms since 1970.
    pub(crate) created_ms: u64,
    /// When its first task was begun. Unit: ms since 1970.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) started_ms: Option<u64>,
    /// When it was over. Unit: ms since 1970.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) finished_ms: Option<u64>,
    /// Tasks in all: a frame each, and the video.
    pub(crate) tasks: u32,
    /// Tasks whose results are stored.
    pub(crate) done: u32,
    /// Done part. Range: 0 to 1.
    pub(crate) fraction: f32,
    /// Time that is left, as far as it can be told. Unit: s.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) eta_seconds: Option<f32>,
    /// Samples a pixel so far of the picture that is being made.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) samples: Option<u32>,
    /// Estimated relative error so far of the picture that is being made.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) estimated_error: Option<f32>,
    /// Why it failed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) error: Option<String>,
}

/// A part of the list of jobs, newest first.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub(crate) struct JobPage {
    /// Newest first.
    pub(crate) jobs: Vec<JobStatus>,
    /// Asked for as `after`, the page that follows; absent from the last one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) next: Option<JobId>,
}

/// A file of a job.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub(crate) struct JobResult {
    /// Its file name.
    pub(crate) name: String,
    /// Unit: byte.
    pub(crate) bytes: u64,
    /// SHA-256 in hexadecimal.
    pub(crate) sha256: String,
    /// Whether it is all that was asked for: the picture of a cancelled job is not.
    pub(crate) complete: bool,
    /// Where it is.
    pub(crate) url: String,
    /// Its name in the store.
    #[serde(skip)]
    pub(crate) key: String,
}

impl Jobs {
    /// A job as it stands.
    pub(crate) async fn status(&self, id: &JobId) -> Result<JobStatus, QueueError> {
        Ok(self.status_of(self.queue.job(id).await?))
    }

    /// The status of a job that was read from the queue.
    pub(crate) fn status_of(&self, job: JobRecord) -> JobStatus {
        let live = if job.state.is_over() {
            Vec::new()
        } else {
            self.live(&job.id)
        };
        let progress: Vec<_> = live.iter().map(|(_, watch)| watch.progress()).collect();
        let begun: f32 = progress.iter().map(|progress| progress.fraction).sum();
        let fraction = match job.state {
            JobState::Done => 1.0,
            _ => ((job.done as f32 + begun) / job.tasks.max(1) as f32).clamp(0.0, 1.0),
        };
        let started = job.started.filter(|_| job.state == JobState::Running);
        let eta_seconds = started.filter(|_| fraction > 0.0).map(|started| {
            let elapsed = now().saturating_sub(started) as f32 * 1e-3;
            elapsed * (1.0 - fraction) / fraction
        });
        let first = progress.first();
        JobStatus {
            name: job.request.name,
            state: job.state,
            priority: job.priority,
            revision: job.revision,
            created_ms: job.created,
            started_ms: job.started,
            finished_ms: job.finished,
            tasks: job.tasks,
            done: job.done,
            fraction,
            eta_seconds,
            samples: first.map(|progress| progress.samples),
            estimated_error: first.and_then(|progress| progress.estimated_error),
            error: job.error,
            id: job.id,
        }
    }

    /// The files of a job.
    pub(crate) async fn results_of(&self, id: &JobId) -> Result<Vec<JobResult>, QueueError> {
        let job = self.queue.job(id).await?;
        let tasks = self.queue.tasks(id).await?;
        let result = |task: TaskRecord| {
            let object = task.object?;
            let name = result_name(&job.request, task.kind, task.number);
            Some(JobResult {
                url: format!("/v1/jobs/{id}/results/{name}"),
                name,
                bytes: object.bytes,
                sha256: object.sha256,
                complete: task.state == TaskState::Done,
                key: object.key,
            })
        };
        Ok(tasks.into_iter().filter_map(result).collect())
    }
}
