//! Who may ask: the token, and which pages may open the WebSocket.

use std::net::IpAddr;
use std::sync::Arc;

use axum::extract::{Request, State};
use axum::http::{HeaderMap, Uri, header};
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};
use tyndall_stream::protocol::ErrorCode;

use crate::problem::Problem;
use crate::server::App;

/// Lets a request pass that shows the token, if one is set.
pub(super) async fn require_token(
    State(app): State<Arc<App>>,
    request: Request,
    next: Next,
) -> Response {
    let Some(token) = &app.token else {
        return next.run(request).await;
    };
    let shown = bearer(request.headers()).or_else(|| in_query(request.uri()));
    if shown.is_some_and(|shown| equal(shown.as_bytes(), token.as_bytes())) {
        return next.run(request).await;
    }
    let detail = "show the token as `Authorization: Bearer TOKEN` or `?token=TOKEN`";
    Problem::new(ErrorCode::Unauthorized, detail).into_response()
}

fn bearer(headers: &HeaderMap) -> Option<&str> {
    let (scheme, token) = headers
        .get(header::AUTHORIZATION)?
        .to_str()
        .ok()?
        .split_once(' ')?;
    scheme
        .eq_ignore_ascii_case("bearer")
        .then_some(token.trim())
}

/// The `token` of the query. A browser cannot set headers on a WebSocket.
fn in_query(uri: &Uri) -> Option<&str> {
    uri.query()?
        .split('&')
        .find_map(|pair| pair.strip_prefix("token="))
}

/// Compares in a time that depends on the lengths only.
fn equal(a: &[u8], b: &[u8]) -> bool {
    let differing = a
        .iter()
        .zip(b)
        .fold(0, |differing, (a, b)| differing | (a ^ b));
    std::hint::black_box(differing) == 0 && a.len() == b.len()
}

/// Refuses a WebSocket that a page of another site opens in a visitor's browser.
///
/// Programs send no `Origin` and pass. Without a token the `Host` must also name this machine:
/// a site whose name an attacker makes resolve to 127.0.0.1 would otherwise be its own origin.
pub(crate) fn check_origin(app: &App, headers: &HeaderMap) -> Result<(), Problem> {
    let text = |name| headers.get(name).and_then(|value| value.to_str().ok());
    let Some(origin) = headers.get(header::ORIGIN) else {
        return Ok(());
    };
    let refuse = |why: &str| Err(Problem::new(ErrorCode::OriginRefused, why.to_owned()));
    let Ok(origin) = origin.to_str() else {
        return refuse("the Origin header is not text");
    };
    if app
        .allowed_origins
        .iter()
        .any(|allowed| allowed.eq_ignore_ascii_case(origin))
    {
        return Ok(());
    }
    let host = text(header::HOST).unwrap_or_default();
    let authority = origin
        .split_once("://")
        .map_or("", |(_, authority)| authority);
    if host.is_empty() || !authority.eq_ignore_ascii_case(host) {
        return refuse("the page that opens this stream must come from this server");
    }
    if app.token.is_none() && !names_this_machine(host) {
        return refuse("without a token the server must be addressed as localhost or 127.0.0.1");
    }
    Ok(())
}

/// Whether a `Host` header names the loopback interface.
fn names_this_machine(host: &str) -> bool {
    let name = match host.rsplit_once(':') {
        Some((name, port)) if port.bytes().all(|byte| byte.is_ascii_digit()) => name,
        _ => host,
    };
    let address = name.trim_start_matches('[').trim_end_matches(']');
    name.eq_ignore_ascii_case("localhost")
        || name.to_ascii_lowercase().ends_with(".localhost")
        || address
            .parse::<IpAddr>()
            .is_ok_and(|address| address.is_loopback())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hosts_of_this_machine_are_recognised() {
        for host in [
            "localhost",
            "LOCALHOST:8080",
            "127.0.0.1:1",
            "[::1]:80",
            "[::1]",
            "a.localhost",
        ] {
            assert!(names_this_machine(host), "{host}");
        }
        for host in [
            "example.org",
            "localhost.example.org:80",
            "10.0.0.1",
            "127.0.0.1.example.org",
            "",
        ] {
            assert!(!names_this_machine(host), "{host}");
        }
    }

    #[test]
    fn tokens_compare_whole() {
        assert!(equal(b"secret", b"secret"));
        assert!(!equal(b"secret", b"secreT"));
        assert!(!equal(b"secret", b"secret1"));
        assert!(!equal(b"", b"secret"));
    }
}
