//! `POST /v1/jobs`: accepts a job, or only says whether it would be accepted.

use std::sync::Arc;

use axum::Json;
use axum::extract::rejection::QueryRejection;
use axum::extract::{Query, Request, State};
use axum::http::{HeaderMap, HeaderValue, StatusCode, header};
use axum::response::{IntoResponse as _, Response};
use http_body_util::LengthLimitError;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use tyndall_jobs::upload::Upload;
use tyndall_jobs::{JobId, JobRequest};
use tyndall_stream::protocol::ErrorCode;

use super::super::body::{content_type, is_json};
use super::upload::{self, Received};
use crate::jobs::{JobStatus, now};
use crate::problem::Problem;
use crate::scenes::PlanReply;
use crate::server::App;

/// Longest idempotency key. Unit: byte.
const LONGEST_KEY: usize = 255;

/// The query of a submission.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub(in crate::routes) struct CreateParameters {
    /// Only say whether the job would be accepted.
    pub(in crate::routes) validate_only: bool,
    /// The secret of the server, where it has one and the header `Authorization` is not used.
    #[allow(dead_code, reason = "the guard before has read it")]
    token: Option<String>,
}

/// The answer to a submission.
#[derive(Debug, Serialize, JsonSchema)]
#[serde(untagged)]
pub(in crate::routes) enum Created {
    /// The job, which may be the one that an earlier request with the same key made.
    Job(Box<JobStatus>),
    /// What the job would do.
    Valid {
        /// Tasks that it would have.
        tasks: u32,
        /// Passes of the first frame, facts of the scene, and what was left out of it.
        #[schemars(with = "serde_json::Value")]
        plan: Box<PlanReply>,
    },
}

/// Accepts a job.
pub(super) async fn create(
    State(app): State<Arc<App>>,
    parameters: Result<Query<CreateParameters>, QueryRejection>,
    request: Request,
) -> Result<Response, Problem> {
    let Query(parameters) = parameters
        .map_err(|rejection| Problem::new(ErrorCode::Malformed, rejection.body_text()))?;
    let key = idempotency_key(request.headers())?;
    let id =
        JobId::new(now()).map_err(|error| Problem::new(ErrorCode::Internal, error.to_string()))?;
    let mut received = receive(&app, &id, request).await?;
    let made = accept(&app, id, &mut received, key, &parameters).await;
    if !matches!(made, Ok((_, true))) {
        received.discard().await;
    }
    made.map(|(response, _)| response)
}

/// The answer, and whether the uploaded files are a job's now.
async fn accept(
    app: &Arc<App>,
    id: JobId,
    received: &mut Received,
    key: Option<String>,
    parameters: &CreateParameters,
) -> Result<(Response, bool), Problem> {
    let request = received.request.clone();
    let upload = received.upload.as_ref().filter(|upload| !upload.is_empty());
    let limits = app.readiness.plan_limits();
    let validating = app.jobs.validate(&request, upload, &app.limits, limits);
    let validated = validating.await?;
    if parameters.validate_only {
        let valid = Created::Valid {
            tasks: validated.tasks.len() as u32,
            plan: Box::new(validated.plan),
        };
        return Ok((Json(valid).into_response(), false));
    }
    let accepted = app.jobs.accept(id, request, validated, key).await?;
    let status = app.jobs.status_of(accepted.job);
    if accepted.is_new {
        // The audit log: one line a job.
        tracing::info!(job = %status.id, tasks = status.tasks, priority = status.priority, "a job is accepted");
    }
    let location = format!("/v1/jobs/{}", status.id);
    let mut response = (StatusCode::ACCEPTED, Json(Created::Job(Box::new(status)))).into_response();
    if let Ok(location) = HeaderValue::from_str(&location) {
        response.headers_mut().insert(header::LOCATION, location);
    }
    Ok((response, accepted.is_new))
}

/// Reads the request and the files that come with it.
async fn receive(app: &Arc<App>, id: &JobId, request: Request) -> Result<Received, Problem> {
    if is_json(request.headers()) {
        let text = text_of(app, request).await?;
        return Ok(Received {
            request: JobRequest::parse(&text).map_err(|error| Problem::from(&error))?,
            upload: None::<Upload>,
        });
    }
    let kind = content_type(request.headers());
    if !kind.eq_ignore_ascii_case("multipart/form-data") {
        let detail = "send the job as application/json, or with its files as multipart/form-data";
        return Err(Problem::new(ErrorCode::UnsupportedMediaType, detail));
    }
    upload::receive(app, id, request).await
}

/// The body as text.
async fn text_of(app: &App, request: Request) -> Result<String, Problem> {
    let most = app.limits.max_body_bytes;
    let too_long = || {
        Problem::new(
            ErrorCode::TooLarge,
            format!("at most {most} bytes of JSON are read"),
        )
    };
    let length = request.headers().get(header::CONTENT_LENGTH);
    let length = length.and_then(|length| length.to_str().ok()?.parse::<usize>().ok());
    if length.is_some_and(|length| length > most) {
        return Err(too_long());
    }
    let within = app.limits.body_within;
    let reading = axum::body::to_bytes(request.into_body(), most);
    let received = tokio::time::timeout(within, reading).await;
    let received = received.map_err(|_elapsed| {
        let detail = format!("the body did not arrive within {} s", within.as_secs_f32());
        Problem::new(ErrorCode::TookTooLong, detail)
    })?;
    let body = received.map_err(|error| {
        let is_long = std::error::Error::source(&error)
            .is_some_and(<dyn std::error::Error>::is::<LengthLimitError>);
        if is_long {
            too_long()
        } else {
            Problem::new(ErrorCode::Malformed, error.to_string())
        }
    })?;
    String::from_utf8(body.into())
        .map_err(|_not_text| Problem::new(ErrorCode::Malformed, "the body is not UTF-8 text"))
}

/// The key under which a request is accepted once only.
fn idempotency_key(headers: &HeaderMap) -> Result<Option<String>, Problem> {
    let Some(value) = headers.get("idempotency-key") else {
        return Ok(None);
    };
    let text = value.to_str().ok().filter(|text| {
        (1..=LONGEST_KEY).contains(&text.len())
            && text
                .bytes()
                .all(|byte| byte.is_ascii_graphic() || byte == b' ')
    });
    let detail = "an Idempotency-Key has 1 to 255 printable ASCII characters";
    let text = text.ok_or_else(|| Problem::new(ErrorCode::Malformed, detail))?;
    Ok(Some(text.to_owned()))
}
