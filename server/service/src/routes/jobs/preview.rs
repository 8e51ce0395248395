//! `GET /v1/jobs/{id}/preview`: the picture that is being made, as it looks now.

use std::sync::Arc;
use std::time::Duration;

use axum::extract::{Path, State};
use axum::http::{HeaderValue, header};
use axum::response::{IntoResponse as _, Response};
use tyndall_stream::encode::{Chroma, EncodeChoice, Encoder, Picture};
use tyndall_stream::protocol::ErrorCode;

use super::job_id;
use crate::problem::Problem;
use crate::server::App;

/// How long the next frame is waited for.
const FRAME_WITHIN: Duration = Duration::from_secs(5);
const QUALITY: u8 = 80;

/// The newest frame of the first picture of a job that is being made, as JPEG.
pub(super) async fn picture(
    State(app): State<Arc<App>>,
    Path(id): Path<String>,
) -> Result<Response, Problem> {
    let id = job_id(&id)?;
    app.jobs.queue.job(&id).await?;
    let nothing = "nothing of the job is being rendered now";
    let live = app.jobs.live(&id);
    let (_, watch) = live
        .first()
        .ok_or_else(|| Problem::new(ErrorCode::NotFound, nothing))?;
    let shown = tokio::time::timeout(FRAME_WITHIN, watch.shown()).await;
    let shown = shown.map_err(|_elapsed| Problem::new(ErrorCode::NotFound, nothing))?;
    let encoded = tokio::task::spawn_blocking(move || {
        let picture = Picture {
            width: shown.width,
            height: shown.height,
            rgba: &shown.rgba,
        };
        let choice = EncodeChoice::Jpeg {
            quality: QUALITY,
            chroma: Chroma::Quarter,
        };
        let mut bytes = Vec::new();
        Encoder::new()?.encode(picture, choice, &mut bytes)?;
        Ok::<_, tyndall_stream::encode::EncodeError>(bytes)
    });
    let at_fault =
        |error: &dyn std::fmt::Display| Problem::new(ErrorCode::Internal, error.to_string());
    let bytes = encoded
        .await
        .map_err(|error| at_fault(&error))?
        .map_err(|error| at_fault(&error))?;
    let headers = [
        (header::CONTENT_TYPE, HeaderValue::from_static("image/jpeg")),
        (header::CACHE_CONTROL, HeaderValue::from_static("no-store")),
    ];
    Ok((headers, bytes).into_response())
}
