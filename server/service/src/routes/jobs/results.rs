//! `GET /v1/jobs/{id}/results`: what a job has made, whole or in ranges.

use std::ops::Range;
use std::path::Path as FilePath;
use std::sync::Arc;

use axum::Json;
use axum::body::Body;
use axum::extract::{Path, State};
use axum::http::{HeaderMap, HeaderName, HeaderValue, StatusCode, header};
use axum::response::{IntoResponse as _, Response};
use tyndall_still::Format;
use tyndall_stream::protocol::ErrorCode;

use super::job_id;
use crate::jobs::JobResult;
use crate::problem::Problem;
use crate::server::App;

/// The files of a job.
pub(super) async fn list(
    State(app): State<Arc<App>>,
    Path(id): Path<String>,
) -> Result<Json<Vec<JobResult>>, Problem> {
    Ok(Json(app.jobs.results_of(&job_id(&id)?).await?))
}

/// A file of a job, or a range of it.
pub(super) async fn one(
    State(app): State<Arc<App>>,
    Path((id, name)): Path<(String, String)>,
    headers: HeaderMap,
) -> Result<Response, Problem> {
    let results = app.jobs.results_of(&job_id(&id)?).await?;
    let found = results.into_iter().find(|result| result.name == name);
    let missing = "the job has no such file, or not yet";
    let result = found.ok_or_else(|| Problem::new(ErrorCode::NotFound, missing))?;
    let tag = format!("\"{}\"", result.sha256);
    let is_tag = |name: HeaderName| {
        let value = headers.get(name).and_then(|value| value.to_str().ok());
        value.map(|value| {
            value == "*"
                || value
                    .split(',')
                    .any(|one| one.trim().trim_start_matches("W/") == tag)
        })
    };
    if is_tag(header::IF_NONE_MATCH) == Some(true) {
        let mut response = StatusCode::NOT_MODIFIED.into_response();
        set(&mut response, header::ETAG, &tag);
        return Ok(response);
    }
    let wanted = headers
        .get(header::RANGE)
        .and_then(|range| range.to_str().ok());
    // Of another version a part is of no use.
    let wanted = wanted.filter(|_| is_tag(header::IF_RANGE) != Some(false));
    let range = match wanted.map_or(Asked::All, |text| asked(text, result.bytes)) {
        Asked::All => None,
        Asked::Range(range) => Some(range),
        Asked::Nothing => {
            let detail = format!("the file has {} bytes", result.bytes);
            let mut response = Problem::new(ErrorCode::RangeNotSatisfiable, detail).into_response();
            let all = format!("bytes */{}", result.bytes);
            set(&mut response, header::CONTENT_RANGE, &all);
            return Ok(response);
        }
    };
    let part = range.clone().unwrap_or(0..result.bytes);
    let stream = app.jobs.results.stream(&result.key, part.clone()).await?;
    let mut response = Body::from_stream(stream).into_response();
    if range.is_some() {
        *response.status_mut() = StatusCode::PARTIAL_CONTENT;
        let place = format!("bytes {}-{}/{}", part.start, part.end - 1, result.bytes);
        set(&mut response, header::CONTENT_RANGE, &place);
    }
    set(&mut response, header::CONTENT_TYPE, media_type(&name));
    set(
        &mut response,
        header::CONTENT_LENGTH,
        &(part.end - part.start).to_string(),
    );
    set(&mut response, header::ACCEPT_RANGES, "bytes");
    set(&mut response, header::ETAG, &tag);
    set(&mut response, header::CACHE_CONTROL, "private, no-cache");
    let attachment = format!("attachment; filename=\"{name}\"");
    set(&mut response, header::CONTENT_DISPOSITION, &attachment);
    Ok(response)
}

fn media_type(name: &str) -> &'static str {
    match Format::of(FilePath::new(name)) {
        Some(format) => format.media_type(),
        None => "video/mp4",
    }
}

fn set(response: &mut Response, name: HeaderName, value: &str) {
    if let Ok(value) = HeaderValue::from_str(value) {
        response.headers_mut().insert(name, value);
    }
}

/// What of a file is asked for.
#[derive(Debug, PartialEq)]
enum Asked {
    All,
    Range(Range<u64>),
    /// A range that lies outside.
    Nothing,
}

/// One range of bytes of RFC 9110; several, other units and what cannot be read count as all.
fn asked(text: &str, length: u64) -> Asked {
    let Some((first, last)) = text
        .strip_prefix("bytes=")
        .and_then(|range| range.split_once('-'))
    else {
        return Asked::All;
    };
    let number = |text: &str| text.trim().parse::<u64>().ok();
    let range = match (first.trim().is_empty(), last.trim().is_empty()) {
        (true, true) => return Asked::All,
        (true, false) => number(last).map(|count| length.saturating_sub(count)..length),
        (false, true) => number(first).map(|first| first..length),
        (false, false) => number(first)
            .zip(number(last))
            .filter(|(first, last)| first <= last)
            .map(|(first, last)| first..last.saturating_add(1).min(length)),
    };
    match range {
        None => Asked::All,
        Some(range) if range.start < range.end => Asked::Range(range),
        Some(_) => Asked::Nothing,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_are_those_of_the_standard() {
        for (text, expected) in [
            ("bytes=0-0", Asked::Range(0..1)),
            ("bytes=2-", Asked::Range(2..10)),
            ("bytes=-3", Asked::Range(7..10)),
            ("bytes=-99", Asked::Range(0..10)),
            ("bytes=5-99", Asked::Range(5..10)),
            ("bytes=10-", Asked::Nothing),
            ("bytes=-0", Asked::Nothing),
            ("bytes=5-4", Asked::All),
            ("bytes=0-1,3-4", Asked::All),
            ("lines=0-1", Asked::All),
            ("bytes=-", Asked::All),
        ] {
            assert_eq!(asked(text, 10), expected, "{text}");
        }
        assert_eq!(asked("bytes=0-", 0), Asked::Nothing);
    }
}
