//! `/v1/plan`: which passes a scene needs, and why, without making or rendering it.

use std::sync::Arc;

use axum::Json;
use axum::body::Bytes;
use axum::extract::rejection::QueryRejection;
use axum::extract::{FromRequest as _, Query, Request, State};
use axum::http::StatusCode;
use serde::Deserialize;
use tyndall_stream::protocol::ErrorCode;

use super::body::is_json;
use crate::problem::Problem;
use crate::scenes::PlanReply;
use crate::server::App;

#[derive(Debug, Deserialize)]
pub(super) struct Parameters {
    preset: String,
}

/// The plan of a preset: `GET /v1/plan?preset=NAME`.
pub(super) async fn of_preset(
    State(app): State<Arc<App>>,
    parameters: Result<Query<Parameters>, QueryRejection>,
) -> Result<Json<PlanReply>, Problem> {
    let Query(Parameters { preset }) = parameters.map_err(|_rejection| {
        let detail = "name a preset: /v1/plan?preset=NAME, or post a scene";
        Problem::new(ErrorCode::Malformed, detail)
    })?;
    let limits = app.readiness.plan_limits();
    Ok(Json(app.scenes.plan_of_preset(&preset, limits).await?))
}

/// The plan of a scene that refers to no files: `POST /v1/plan` with its JSON.
pub(super) async fn of_scene(
    State(app): State<Arc<App>>,
    request: Request,
) -> Result<Json<PlanReply>, Problem> {
    if !is_json(request.headers()) {
        let detail = "send the scene with content type application/json";
        return Err(Problem::new(ErrorCode::UnsupportedMediaType, detail));
    }
    let within = app.limits.body_within;
    let received = tokio::time::timeout(within, Bytes::from_request(request, &()));
    let body = received.await.map_err(|_elapsed| {
        let detail = format!("the body did not arrive within {} s", within.as_secs_f32());
        Problem::new(ErrorCode::TookTooLong, detail)
    })?;
    let body = body.map_err(|rejection| {
        if rejection.status() == StatusCode::PAYLOAD_TOO_LARGE {
            let limit = app.limits.max_body_bytes;
            Problem::new(
                ErrorCode::TooLarge,
                format!("at most {limit} bytes are read"),
            )
        } else {
            Problem::new(ErrorCode::Malformed, rejection.body_text())
        }
    })?;
    let text = String::from_utf8(body.into())
        .map_err(|_not_text| Problem::new(ErrorCode::Malformed, "the body is not UTF-8 text"))?;
    let limits = app.readiness.plan_limits();
    Ok(Json(app.scenes.plan_of(text, limits).await?))
}
