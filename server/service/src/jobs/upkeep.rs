//! Forgets jobs that have been over for long, with their results and uploads.

use std::sync::Arc;
use std::time::Duration;

use tokio_util::sync::CancellationToken;
use tyndall_jobs::QueueError;

use super::{Jobs, now};
use crate::telemetry;

/// How often it is looked for.
const EVERY: Duration = Duration::from_secs(10);
/// Jobs that are forgotten at once.
const MOST: u32 = 100;

/// Works until the service goes down.
pub(crate) async fn upkeep(jobs: Arc<Jobs>, shutdown: CancellationToken) {
    let mut tick = tokio::time::interval(EVERY);
    loop {
        tokio::select! {
            _ = tick.tick() => {}
            () = shutdown.cancelled() => return,
        }
        if let Err(error) = forget(&jobs).await {
            tracing::error!(%error, "old jobs could not be forgotten");
        }
    }
}

async fn forget(jobs: &Jobs) -> Result<(), QueueError> {
    telemetry::queue(jobs.queue.counts().await?);
    let keep = jobs.limits.keep_for.as_millis() as u64;
    let (forgotten, objects) = jobs.queue.expire(now().saturating_sub(keep), MOST).await?;
    for object in objects {
        if let Err(error) = jobs.results.remove(&object.key).await {
            tracing::warn!(%error, key = object.key, "a result that nobody needs cannot be removed");
        }
    }
    for id in forgotten {
        let folder = jobs.upload_folder(&id);
        if folder.is_dir()
            && let Err(error) = tokio::fs::remove_dir_all(&folder).await
        {
            tracing::warn!(%error, job = %id, "an upload that nobody needs cannot be removed");
        }
        tracing::info!(job = %id, "a job is forgotten");
    }
    Ok(())
}
