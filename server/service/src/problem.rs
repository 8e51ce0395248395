//! Errors over HTTP: `application/problem+json` (RFC 9457), from one table.

use axum::Json;
use axum::http::{HeaderValue, StatusCode, header};
use axum::response::{IntoResponse, Response};
use serde::Serialize;
use tyndall_scene::SceneError;
use tyndall_stream::protocol::ErrorCode;

use crate::scenes::BuildError;

/// After how long a client may try again when the server is full or not ready. Unit: s.
const RETRY_AFTER_SECONDS: HeaderValue = HeaderValue::from_static("5");

/// What went wrong, for programs and for people.
#[derive(Debug, Clone, Serialize)]
pub struct Problem {
    /// Stable name of the cause.
    pub code: ErrorCode,
    /// The cause in words, the same for every occurrence.
    pub title: &'static str,
    /// HTTP status.
    pub status: u16,
    /// This occurrence in one sentence.
    pub detail: String,
    /// JSON path in the scene, where there is one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub path: Option<String>,
}

/// The one table: code → status and title.
pub const fn status_and_title(code: ErrorCode) -> (StatusCode, &'static str) {
    match code {
        ErrorCode::Malformed => (StatusCode::BAD_REQUEST, "the request cannot be read"),
        ErrorCode::NotFound => (StatusCode::NOT_FOUND, "there is no such thing"),
        ErrorCode::MethodNotAllowed => (
            StatusCode::METHOD_NOT_ALLOWED,
            "the address does not take this method",
        ),
        ErrorCode::Unauthorized => (StatusCode::UNAUTHORIZED, "a token is needed"),
        ErrorCode::TooManyAttempts => (
            StatusCode::TOO_MANY_REQUESTS,
            "too many wrong tokens were tried",
        ),
        ErrorCode::OriginRefused => (
            StatusCode::FORBIDDEN,
            "the request is not for this server or comes from a page of another one",
        ),
        ErrorCode::TooLarge => (StatusCode::PAYLOAD_TOO_LARGE, "the body is too long"),
        ErrorCode::UnsupportedMediaType => {
            (StatusCode::UNSUPPORTED_MEDIA_TYPE, "the body must be JSON")
        }
        ErrorCode::InvalidScene => (StatusCode::UNPROCESSABLE_ENTITY, "the scene is wrong"),
        ErrorCode::NotRenderedYet => (
            StatusCode::UNPROCESSABLE_ENTITY,
            "the scene uses what is not rendered yet",
        ),
        ErrorCode::InvalidSize => (StatusCode::UNPROCESSABLE_ENTITY, "the size is not allowed"),
        ErrorCode::ProtocolVersion => (StatusCode::BAD_REQUEST, "the protocol is not spoken here"),
        ErrorCode::HelloExpected => (StatusCode::BAD_REQUEST, "a hello must come first"),
        ErrorCode::NoCommonCodec => (StatusCode::BAD_REQUEST, "no codec is known to both sides"),
        ErrorCode::TooManySessions => (StatusCode::SERVICE_UNAVAILABLE, "every session is taken"),
        ErrorCode::TakenOver => (StatusCode::CONFLICT, "another connection took over"),
        ErrorCode::NotReady => (StatusCode::SERVICE_UNAVAILABLE, "the renderer is not ready"),
        ErrorCode::TookTooLong => (StatusCode::SERVICE_UNAVAILABLE, "the request took too long"),
        ErrorCode::RenderFailed => (StatusCode::INTERNAL_SERVER_ERROR, "the renderer failed"),
        ErrorCode::Internal => (StatusCode::INTERNAL_SERVER_ERROR, "the server is at fault"),
        ErrorCode::Conflict => (StatusCode::CONFLICT, "it contradicts what is there"),
        ErrorCode::QueueFull => (StatusCode::SERVICE_UNAVAILABLE, "every place is taken"),
        ErrorCode::InvalidUpload => (
            StatusCode::UNPROCESSABLE_ENTITY,
            "a file that was uploaded is unfit",
        ),
        ErrorCode::RangeNotSatisfiable => (
            StatusCode::RANGE_NOT_SATISFIABLE,
            "the range lies outside the file",
        ),
        ErrorCode::StorageFailed => (
            StatusCode::SERVICE_UNAVAILABLE,
            "what is stored cannot be read or written",
        ),
    }
}

impl Problem {
    /// A problem with this occurrence in words.
    pub fn new(code: ErrorCode, detail: impl Into<String>) -> Self {
        let (status, title) = status_and_title(code);
        Self {
            code,
            title,
            status: status.as_u16(),
            detail: detail.into(),
            path: None,
        }
    }
}

impl From<&SceneError> for Problem {
    fn from(error: &SceneError) -> Self {
        let code = match error {
            SceneError::Syntax { .. } => ErrorCode::Malformed,
            _ => ErrorCode::InvalidScene,
        };
        Self {
            path: error.path().map(str::to_owned),
            ..Self::new(code, error.to_string())
        }
    }
}

impl From<BuildError> for Problem {
    fn from(error: BuildError) -> Self {
        let code = match &error {
            BuildError::Scene(scene) => return Self::from(scene),
            BuildError::NoSuchPreset { .. } => ErrorCode::NotFound,
            BuildError::NotRenderedYet(_) => ErrorCode::NotRenderedYet,
            BuildError::TookTooLong { .. } => ErrorCode::TookTooLong,
            BuildError::BrokenOff => ErrorCode::Internal,
        };
        Self::new(code, error.to_string())
    }
}

impl IntoResponse for Problem {
    fn into_response(self) -> Response {
        let (status, _) = status_and_title(self.code);
        let mut response = (status, Json(self)).into_response();
        let headers = response.headers_mut();
        let kind = HeaderValue::from_static("application/problem+json");
        headers.insert(header::CONTENT_TYPE, kind);
        headers.insert(header::CACHE_CONTROL, HeaderValue::from_static("no-store"));
        if status == StatusCode::SERVICE_UNAVAILABLE {
            headers.insert(header::RETRY_AFTER, RETRY_AFTER_SECONDS);
        }
        if status == StatusCode::UNAUTHORIZED {
            let challenge = HeaderValue::from_static("Bearer realm=\"tyndall\"");
            headers.insert(header::WWW_AUTHENTICATE, challenge);
        }
        response
    }
}
