//! Who may ask: the token, as a header or in the address, and `/v1/access`, which only says whether it
//! is right.

use std::borrow::Cow;
use std::net::{IpAddr, Ipv4Addr};
use std::sync::Arc;
use std::time::{Duration, Instant};

use axum::extract::{Request, State};
use axum::http::{HeaderMap, HeaderValue, StatusCode, Uri, header};
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};
use tyndall_stream::protocol::ErrorCode;

use crate::connections::Peer;
use crate::problem::Problem;
use crate::server::App;

/// Lets a request pass that shows the token, if one is set.
pub(super) async fn require(State(app): State<Arc<App>>, request: Request, next: Next) -> Response {
    let Some(token) = &app.token else {
        return next.run(request).await;
    };
    let Some(shown) = bearer(request.headers()).or_else(|| in_query(request.uri())) else {
        let detail = "this server was started with a token and the request shows none; open the page with ?token= and the token behind its address, or send the header Authorization: Bearer with it";
        return refuse(&app, Problem::new(ErrorCode::Unauthorized, detail));
    };
    let peer = request.extensions().get::<Peer>();
    let address = peer.map_or(IpAddr::V4(Ipv4Addr::UNSPECIFIED), |peer| peer.0.ip());
    if let Err(wait) = app.attempts.check(address, Instant::now()) {
        return too_many(&app, wait);
    }
    if equal(&shown, token.as_bytes()) {
        return next.run(request).await;
    }
    let wait = app.attempts.failed(address, Instant::now());
    tokio::time::sleep(wait).await;
    let detail = format!(
        "the token that was shown, of {} characters, is not the one this server was started with; look for it where the server was started (--token or TYNDALL_TOKEN), and in an address write + / = % & # as %2B %2F %3D %25 %26 %23",
        String::from_utf8_lossy(&shown).chars().count()
    );
    let wrong = Problem::new(ErrorCode::Unauthorized, detail);
    let title = "the token is wrong";
    refuse(&app, Problem { title, ..wrong })
}

/// Says that whoever asks may: `GET /v1/access`.
pub(super) async fn access() -> StatusCode {
    StatusCode::NO_CONTENT
}

fn refuse(app: &App, problem: Problem) -> Response {
    app.refusals.log(&problem.detail);
    problem.into_response()
}

fn too_many(app: &App, wait: Duration) -> Response {
    let seconds = wait.as_secs() + 1;
    let detail =
        format!("too many wrong tokens came from your address; none is looked at for {seconds} s");
    let mut response = refuse(app, Problem::new(ErrorCode::TooManyAttempts, detail));
    let after = HeaderValue::from(seconds);
    response.headers_mut().insert(header::RETRY_AFTER, after);
    response
}

fn bearer(headers: &HeaderMap) -> Option<Cow<'_, [u8]>> {
    let value = headers.get(header::AUTHORIZATION)?.as_bytes();
    let space = value.iter().position(|byte| *byte == b' ')?;
    let (scheme, token) = value.split_at(space);
    scheme
        .eq_ignore_ascii_case(b"bearer")
        .then(|| Cow::Borrowed(token.trim_ascii()))
}

/// The `token` of the query, percent-decoded once; a `+` stands for itself, as a token has no spaces. A
/// browser cannot set headers on a WebSocket.
fn in_query(uri: &Uri) -> Option<Cow<'_, [u8]>> {
    let mut pairs = uri.query()?.split('&');
    let token = pairs.find_map(|pair| pair.strip_prefix("token="))?;
    Some(percent_encoding::percent_decode_str(token).into())
}

/// Compares in a time that depends on the lengths only.
fn equal(a: &[u8], b: &[u8]) -> bool {
    let differing = a
        .iter()
        .zip(b)
        .fold(0, |differing, (a, b)| differing | (a ^ b));
    std::hint::black_box(differing) == 0 && a.len() == b.len()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tokens_compare_whole() {
        assert!(equal(b"secret", b"secret"));
        assert!(!equal(b"secret", b"secreT"));
        assert!(!equal(b"secret", b"secret1"));
        assert!(!equal(b"", b"secret"));
    }

    #[test]
    fn a_token_in_an_address_is_decoded_once() {
        let shown = |query: &str| {
            let uri: Uri = format!("/v1/stream?{query}").parse().unwrap();
            in_query(&uri).map(|token| String::from_utf8(token.into_owned()).unwrap())
        };
        let token = Some("a+/=%&b".to_owned());
        assert_eq!(shown("token=a%2B%2F%3D%25%26b"), token);
        assert_eq!(shown("x=1&token=a+/=%25%26b&y"), token);
        assert_eq!(shown("token=%2525").as_deref(), Some("%25"));
        assert_eq!(shown("token=50%").as_deref(), Some("50%"));
        assert_eq!(shown("tokens=1"), None);
    }
}
