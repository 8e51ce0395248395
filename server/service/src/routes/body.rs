//! What a request says of its body.

use axum::http::{HeaderMap, header};

/// The media type without its parameters; empty if none is named.
pub(super) fn content_type(headers: &HeaderMap) -> &str {
    let kind = headers
        .get(header::CONTENT_TYPE)
        .and_then(|value| value.to_str().ok());
    let essence = kind.and_then(|kind| kind.split(';').next());
    essence.unwrap_or_default().trim()
}

/// Whether the body is JSON.
pub(super) fn is_json(headers: &HeaderMap) -> bool {
    let essence = content_type(headers);
    essence.eq_ignore_ascii_case("application/json") || essence.ends_with("+json")
}
