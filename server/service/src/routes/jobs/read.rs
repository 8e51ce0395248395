//! Lists jobs, tells how one stands, cancels one.

use std::sync::Arc;

use axum::Json;
use axum::extract::rejection::QueryRejection;
use axum::extract::{Path, Query, State};
use schemars::JsonSchema;
use serde::Deserialize;
use tyndall_jobs::{Filter, JobId, JobState, PageAsked};
use tyndall_stream::protocol::ErrorCode;

use super::job_id;
use crate::jobs::{JobPage, JobStatus, now};
use crate::problem::Problem;
use crate::server::App;

/// Jobs of a page without another wish, and most of one.
const USUAL_PAGE: u32 = 50;
const LONGEST_PAGE: u32 = 200;

/// The query of a list.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub(in crate::routes) struct ListParameters {
    /// Only jobs in this state.
    state: Option<JobState>,
    /// At most so many. Range: 1 to 200.
    limit: Option<u32>,
    /// Those that follow this one: `next` of the page before.
    after: Option<JobId>,
    /// The secret of the server, where it has one and the header `Authorization` is not used.
    #[allow(dead_code, reason = "the guard before has read it")]
    token: Option<String>,
}

/// Jobs, newest first: `GET /v1/jobs`.
pub(super) async fn list(
    State(app): State<Arc<App>>,
    parameters: Result<Query<ListParameters>, QueryRejection>,
) -> Result<Json<JobPage>, Problem> {
    let Query(parameters) = parameters
        .map_err(|rejection| Problem::new(ErrorCode::Malformed, rejection.body_text()))?;
    let limit = parameters.limit.unwrap_or(USUAL_PAGE);
    if !(1..=LONGEST_PAGE).contains(&limit) {
        let detail = format!("limit is {limit}, allowed are 1 to {LONGEST_PAGE}");
        return Err(Problem::new(ErrorCode::Malformed, detail));
    }
    let asked = PageAsked {
        limit,
        after: parameters.after,
    };
    let filter = Filter {
        state: parameters.state,
    };
    let page = app.jobs.queue.list(filter, &asked).await?;
    let last = page.jobs.last().map(|job| job.id.clone());
    Ok(Json(JobPage {
        next: last.filter(|_| page.more),
        jobs: page
            .jobs
            .into_iter()
            .map(|job| app.jobs.status_of(job))
            .collect(),
    }))
}

/// How a job stands: `GET /v1/jobs/{id}`.
pub(super) async fn one(
    State(app): State<Arc<App>>,
    Path(id): Path<String>,
) -> Result<Json<JobStatus>, Problem> {
    Ok(Json(app.jobs.status(&job_id(&id)?).await?))
}

/// Cancels a job, unless it is over: `DELETE /v1/jobs/{id}`.
pub(super) async fn cancel(
    State(app): State<Arc<App>>,
    Path(id): Path<String>,
) -> Result<Json<JobStatus>, Problem> {
    let id = job_id(&id)?;
    let job = app.jobs.queue.cancel(&id, now()).await?;
    app.jobs.stop(&id);
    tracing::info!(job = %id, state = job.state.name(), "a job was asked to stop");
    Ok(Json(app.jobs.status_of(job)))
}
