//! Render jobs: accepted, queued, made on the one device, kept for a while.
//!
//! - `open`: the folder that holds them, with what an earlier process left there;
//! - `accept`: from a request to a queued job;
//! - `worker`: takes tasks and brings each to its end; `make`: a task's result; `video`: frames to MP4;
//! - `status`: what clients are told;
//! - `upkeep`: forgets what is old.

mod accept;
mod make;
mod open;
mod status;
mod upkeep;
mod video;
mod worker;

use std::collections::HashMap;
use std::path::PathBuf;
use std::sync::{Arc, Mutex};
use std::time::{Duration, SystemTime};

use tokio::sync::Semaphore;
use tyndall_jobs::upload::UploadLimits;
use tyndall_jobs::{JobId, Results, SqliteLimits, TaskQueue};
use tyndall_scene::Loaded;

use crate::bell::lock;
use crate::stills::{Desk, StillWatch};

pub(crate) use self::accept::AcceptError;
pub use self::open::DataError;
pub(crate) use self::open::open;
pub(crate) use self::status::{JobPage, JobResult, JobStatus};
pub(crate) use self::upkeep::upkeep;
pub(crate) use self::worker::work;

/// Scenes of jobs that are kept in memory, as many as are rendered at once.
const MOST_SCENES: usize = 2;
/// Uploads that are received at the same time.
const MOST_UPLOADS: usize = 4;

/// Where jobs and their results are kept.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum DataFolder {
    /// Nowhere: they end with the process.
    Temporary,
    /// In a folder, unless it cannot be used: then they end with the process, and the log says so.
    Usual(PathBuf),
    /// In a folder, or the service does not start.
    Named(PathBuf),
}

/// How many jobs there may be, and for how long.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct JobLimits {
    /// Jobs that are not over.
    pub max_open_jobs: u64,
    /// All uploaded files of a job together, unpacked. Unit: byte.
    pub max_upload_bytes: u64,
    /// How long jobs that are over are kept, with their results.
    pub keep_for: Duration,
}

impl Default for JobLimits {
    fn default() -> Self {
        Self {
            max_open_jobs: SqliteLimits::default().open_jobs,
            max_upload_bytes: UploadLimits::default().bytes,
            keep_for: Duration::from_hours(7 * 24),
        }
    }
}

/// The scene of a job.
type SceneOfJob = (JobId, Arc<Loaded>);

/// Everything about jobs.
pub(crate) struct Jobs {
    pub(crate) queue: Arc<dyn TaskQueue>,
    pub(crate) results: Results,
    pub(crate) uploading: Semaphore,
    desk: Arc<Desk>,
    limits: JobLimits,
    ffmpeg: Option<PathBuf>,
    folder: PathBuf,
    /// What is being made, by job and number of its task.
    live: Mutex<HashMap<(JobId, u32), Arc<StillWatch>>>,
    scenes: Mutex<Vec<SceneOfJob>>,
    /// One scene is loaded at a time.
    loading: Semaphore,
    _lock: std::fs::File,
    _temporary: Option<tempfile::TempDir>,
}

impl std::fmt::Debug for Jobs {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Jobs")
            .field("folder", &self.folder)
            .finish_non_exhaustive()
    }
}

impl Jobs {
    /// What is being made of a job: each with the number of its task.
    pub(crate) fn live(&self, job: &JobId) -> Vec<(u32, Arc<StillWatch>)> {
        let live = lock(&self.live);
        let of_job = live.iter().filter(|((id, _), _)| id == job);
        let mut found: Vec<_> = of_job
            .map(|((_, number), watch)| (*number, Arc::clone(watch)))
            .collect();
        found.sort_unstable_by_key(|(number, _)| *number);
        found
    }

    /// Lets what is being made of a job stop at once.
    pub(crate) fn stop(&self, job: &JobId) {
        for (_, watch) in self.live(job) {
            watch.stop();
        }
        self.desk.wake();
    }

    /// The bounds of an upload.
    pub(crate) fn upload_limits(&self) -> UploadLimits {
        UploadLimits {
            bytes: self.limits.max_upload_bytes,
            ..UploadLimits::default()
        }
    }

    /// Whether frames can become videos here.
    pub(crate) fn makes_videos(&self) -> bool {
        self.ffmpeg.is_some()
    }

    /// Where the uploaded files of a job lie.
    pub(crate) fn upload_folder(&self, job: &JobId) -> PathBuf {
        self.folder.join("uploads").join(job.as_str())
    }

    /// Where files lie that are of use for a moment only.
    pub(crate) fn passing_folder(&self) -> PathBuf {
        self.folder.join("passing")
    }
}

/// The time at present. Unit: ms since 1970.
pub(crate) fn now() -> u64 {
    let since = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH);
    since.map_or(0, |since| since.as_millis() as u64)
}
