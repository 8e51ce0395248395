//! `/v1/jobs`: render jobs.
//!
//! - `create`: accepts a job, or only says whether it would be; `upload`: reads the files that come with it;
//! - `read`: lists jobs, tells how one stands, cancels;
//! - `events`: tells how one stands as it changes;
//! - `preview`, `results`: pictures, while they are made and after.

mod create;
mod events;
mod preview;
mod read;
mod results;
mod upload;

use std::sync::Arc;

use axum::Router;
use axum::extract::DefaultBodyLimit;
use axum::routing::{get, post};
use tyndall_jobs::{JobId, QueueError, ResultsError};
use tyndall_stream::protocol::ErrorCode;

use crate::jobs::AcceptError;
use crate::problem::Problem;
use crate::server::App;

pub(super) use self::create::{CreateParameters, Created};
pub(super) use self::read::ListParameters;

/// The routes, without their guards. `most_bytes` is the longest body of an upload.
pub(super) fn router(most_bytes: u64) -> Router<Arc<App>> {
    let limit = DefaultBodyLimit::max(usize::try_from(most_bytes).unwrap_or(usize::MAX));
    Router::new()
        .route(
            "/v1/jobs",
            post(create::create).layer(limit).get(read::list),
        )
        .route("/v1/jobs/{id}", get(read::one).delete(read::cancel))
        .route("/v1/jobs/{id}/events", get(events::stream))
        .route("/v1/jobs/{id}/preview", get(preview::picture))
        .route("/v1/jobs/{id}/results", get(results::list))
        .route("/v1/jobs/{id}/results/{name}", get(results::one))
}

/// A job's name of an address.
fn job_id(text: &str) -> Result<JobId, Problem> {
    text.parse().map_err(|error: tyndall_jobs::id::NoJobId| {
        Problem::new(ErrorCode::NotFound, error.to_string())
    })
}

impl From<QueueError> for Problem {
    fn from(error: QueueError) -> Self {
        let code = match &error {
            QueueError::NoSuchJob(_) | QueueError::ObjectGone { .. } => ErrorCode::NotFound,
            QueueError::KeyReused { .. } | QueueError::LeaseLost { .. } => ErrorCode::Conflict,
            QueueError::Full { .. } => ErrorCode::QueueFull,
            QueueError::Storage(_) => ErrorCode::StorageFailed,
        };
        if code == ErrorCode::StorageFailed {
            tracing::error!(%error, "the queue failed");
        }
        Self::new(code, error.to_string())
    }
}

impl From<ResultsError> for Problem {
    fn from(error: ResultsError) -> Self {
        let code = match &error {
            ResultsError::Missing { .. } => ErrorCode::NotFound,
            ResultsError::Folder { .. } | ResultsError::Store(_) => ErrorCode::StorageFailed,
        };
        if code == ErrorCode::StorageFailed {
            tracing::error!(%error, "the store of results failed");
        }
        Self::new(code, error.to_string())
    }
}

impl From<AcceptError> for Problem {
    fn from(error: AcceptError) -> Self {
        let code = match error {
            AcceptError::Build(error) => return error.into(),
            AcceptError::Queue(error) => return error.into(),
            AcceptError::Size { .. } => ErrorCode::InvalidSize,
            AcceptError::NoVideo => ErrorCode::NotRenderedYet,
            AcceptError::Hash(_) => ErrorCode::Internal,
        };
        Self::new(code, error.to_string())
    }
}
