//! Which names the server answers to, and pages of which origins may ask: checked before every route.
//!
//! A browser says with `Host` which name it was told and with `Origin` whose page asks. Programs send no
//! `Origin` and pass. Without a token the `Host` must name this machine: a site whose name an attacker
//! makes resolve to 127.0.0.1 would otherwise be its own origin and could read everything. Behind a
//! gateway the page has the gateway's origin, which `--allow-origin` names.

use std::sync::Arc;

use axum::extract::{Request, State};
use axum::http::{HeaderMap, HeaderName, HeaderValue, Uri, header};
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};
use tyndall_stream::protocol::ErrorCode;

use crate::origin::{Host, Origin};
use crate::problem::Problem;
use crate::server::App;

/// Longest part of a header that is shown. Unit: character.
const SHOWN: usize = 120;

/// Refuses requests for other names and of other sites' pages, and tells the browser which socket a page
/// of this server may open.
pub(super) async fn check(State(app): State<Arc<App>>, request: Request, next: Next) -> Response {
    let checked = checked(&app, request.uri(), request.headers());
    let policy = content_security_policy(checked.as_ref().ok().and_then(Option::as_ref));
    let mut response = match checked {
        Ok(_host) => next.run(request).await,
        Err(refused) => {
            app.refusals.log(&refused.detail);
            refused.into_response()
        }
    };
    let name = HeaderName::from_static("content-security-policy");
    response.headers_mut().insert(name, policy);
    response
}

/// The host that a request which may pass was sent to, if it names one.
fn checked(app: &App, uri: &Uri, headers: &HeaderMap) -> Result<Option<Host>, Problem> {
    let refuse = |why: String| Err(Problem::new(ErrorCode::OriginRefused, why));
    let mut hosts = headers.get_all(header::HOST).iter();
    let host = hosts.next();
    if hosts.next().is_some() {
        return refuse("the request has more than one Host header".to_owned());
    }
    let host = match host.map(|host| (host, host.to_str().ok().and_then(Host::parse))) {
        None => None,
        Some((_, Some(host))) => Some(host),
        Some((raw, None)) => {
            return refuse(format!(
                "the Host header is {}, which is no host",
                shown(raw)
            ));
        }
    };
    // A whole address as the target, as proxies are asked for it.
    let target = uri.authority().map(|target| Host::parse(target.as_str()));
    if target.is_some_and(|target| target != host) {
        return refuse("the address of the request and its Host header differ".to_owned());
    }
    let allowed = &app.allowed_origins;
    if let Some(host) = &host
        && app.token.is_none()
        && !host.is_this_machine()
        && !allowed.iter().any(|origin| origin.has_host(host))
    {
        return refuse(format!(
            "this server was asked for as \"{host}\", but without a token it answers as localhost or 127.0.0.1 only; open http://127.0.0.1 with its port, or start it with --token, or with --allow-origin and the origin of the gateway before it"
        ));
    }
    let Some(raw) = headers.get(header::ORIGIN) else {
        return Ok(host);
    };
    let origin = raw.to_str().ok().map(Origin::parse);
    let Some(Ok(origin)) = origin else {
        return refuse(format!(
            "the page that asks has the origin {}, which this server does not know; open the page of this server itself",
            shown(raw)
        ));
    };
    let own = host
        .as_ref()
        .is_some_and(|host| origin.is_plain_page_of(host));
    if own || allowed.contains(&origin) {
        return Ok(host);
    }
    let asked = host.map_or_else(|| "no host".to_owned(), |host| format!("http://{host}"));
    refuse(format!(
        "the page that asks comes from {origin}, this server was asked for as {asked}; open the page of this server itself, or start the server with --allow-origin {origin}"
    ))
}

/// A header's value in quotes, cut short.
fn shown(value: &HeaderValue) -> String {
    let text: String = String::from_utf8_lossy(value.as_bytes())
        .chars()
        .take(SHOWN)
        .collect();
    format!("{text:?}")
}

/// The page loads nothing from elsewhere; lil-gui brings its style and icon font in the script. Not every
/// browser takes a socket of the same host for the page's own, so it is named.
fn content_security_policy(host: Option<&Host>) -> HeaderValue {
    let sockets = host.map_or_else(String::new, |host| format!(" ws://{host} wss://{host}"));
    let policy = format!(
        "default-src 'self'; img-src 'self' blob: data:; style-src 'self' 'unsafe-inline'; \
         font-src 'self' data:; worker-src 'self' blob:; connect-src 'self'{sockets}; \
         object-src 'none'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
    );
    // A host that was parsed has no character that a header cannot carry.
    HeaderValue::try_from(policy).unwrap_or(HeaderValue::from_static("default-src 'self'"))
}
