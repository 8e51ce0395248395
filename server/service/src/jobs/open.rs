//! The folder that holds jobs, uploads and results.

use std::collections::HashSet;
use std::fs::{File, TryLockError};
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex};

use tokio::sync::Semaphore;
use tyndall_jobs::{QueueError, Results, ResultsError, SqliteLimits, SqliteQueue, TaskQueue as _};

use super::worker::WORKER;
use super::{DataFolder, JobLimits, Jobs, MOST_UPLOADS, now, video};
use crate::stills::Desk;

/// Why a folder cannot hold jobs.
#[derive(Debug, thiserror::Error)]
pub enum DataError {
    /// The system refuses.
    #[error("{}: {source}", folder.display())]
    Io {
        /// The folder.
        folder: PathBuf,
        /// The system's reason.
        source: io::Error,
    },
    /// Another process uses it.
    #[error("{}: another process of this program uses it", folder.display())]
    InUse {
        /// The folder.
        folder: PathBuf,
    },
    /// What is in it cannot be used.
    #[error("{}: {source}", folder.display())]
    Queue {
        /// The folder.
        folder: PathBuf,
        /// Why.
        source: QueueError,
    },
    /// Results cannot be stored in it.
    #[error(transparent)]
    Results(#[from] ResultsError),
}

/// Opens what holds the jobs, and frees what an earlier process was at.
pub(crate) async fn open(
    data: &DataFolder,
    limits: JobLimits,
    ffmpeg: Option<PathBuf>,
    desk: Arc<Desk>,
) -> Result<Jobs, DataError> {
    let ffmpeg = ffmpeg.or_else(video::find_ffmpeg);
    let opened = match data {
        DataFolder::Temporary => None,
        DataFolder::Usual(folder) => match prepare(folder) {
            Ok(lock) => Some((folder.clone(), lock)),
            Err(error) => {
                tracing::warn!(%error, "jobs end with this process; --data names another folder");
                None
            }
        },
        DataFolder::Named(folder) => Some((folder.clone(), prepare(folder)?)),
    };
    let (folder, lock, temporary) = if let Some((folder, lock)) = opened {
        (folder, lock, None)
    } else {
        let temporary = tempfile::Builder::new().prefix("tyndall-").tempdir();
        let temporary = temporary.map_err(|source| DataError::Io {
            folder: std::env::temp_dir(),
            source,
        })?;
        let folder = temporary.path().to_owned();
        let lock = prepare(&folder)?;
        (folder, lock, Some(temporary))
    };
    let of_queue = |source| DataError::Queue {
        folder: folder.clone(),
        source,
    };
    let sqlite = SqliteLimits {
        open_jobs: limits.max_open_jobs,
        ..SqliteLimits::default()
    };
    let queue = SqliteQueue::open(&folder.join("queue.sqlite"), sqlite).map_err(of_queue)?;
    let reclaimed = queue.reclaim(WORKER, now()).await.map_err(of_queue)?;
    if reclaimed > 0 {
        tracing::info!(
            reclaimed,
            "tasks that were being made when the last process ended are free again"
        );
    }
    let results = Results::local(&folder.join("results"))?;
    let jobs = Jobs {
        queue: Arc::new(queue),
        results,
        uploading: Semaphore::new(MOST_UPLOADS),
        desk,
        limits,
        ffmpeg,
        folder,
        live: Mutex::default(),
        scenes: Mutex::default(),
        loading: Semaphore::new(1),
        _lock: lock,
        _temporary: temporary,
    };
    sweep(&jobs).await;
    Ok(jobs)
}

/// Makes the folder, for this process alone and nobody else's eyes.
fn prepare(folder: &Path) -> Result<File, DataError> {
    let io = |source| DataError::Io {
        folder: folder.to_owned(),
        source,
    };
    let mut builder = std::fs::DirBuilder::new();
    builder.recursive(true);
    #[cfg(unix)]
    std::os::unix::fs::DirBuilderExt::mode(&mut builder, 0o700);
    builder.create(folder).map_err(io)?;
    for part in ["uploads", "passing"] {
        builder.create(folder.join(part)).map_err(io)?;
    }
    let lock = File::create(folder.join("lock")).map_err(io)?;
    match lock.try_lock() {
        Ok(()) => Ok(lock),
        Err(TryLockError::WouldBlock) => Err(DataError::InUse {
            folder: folder.to_owned(),
        }),
        Err(TryLockError::Error(source)) => Err(io(source)),
    }
}

/// Removes what belongs to no job: an earlier process may have ended at any point.
async fn sweep(jobs: &Jobs) {
    let folder = jobs.folder.join("uploads");
    let names = |folder: &Path| -> HashSet<String> {
        let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
        let names = entries.map(|entry| entry.file_name().to_string_lossy().into_owned());
        names.collect()
    };
    for name in names(&folder) {
        let known = match name.parse() {
            Ok(id) => !matches!(jobs.queue.job(&id).await, Err(QueueError::NoSuchJob(_))),
            Err(_no_job) => false,
        };
        if !known {
            remove(&folder.join(name));
        }
    }
    let passing = jobs.passing_folder();
    for name in names(&passing) {
        remove(&passing.join(name));
    }
}

fn remove(path: &Path) {
    let removed = if path.is_dir() {
        std::fs::remove_dir_all(path)
    } else {
        std::fs::remove_file(path)
    };
    if let Err(error) = removed {
        tracing::warn!(%error, path = %path.display(), "a leftover cannot be removed");
    }
}
