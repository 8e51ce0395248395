//! HTTP addresses, a file each, and what holds for all of them.

mod body;
mod health;
mod host;
mod jobs;
mod metrics;
mod openapi;
mod page;
mod plan;
mod presets;
mod schema;
mod token;

use std::sync::Arc;

use axum::Router;
use axum::extract::{DefaultBodyLimit, Request};
use axum::http::{HeaderName, HeaderValue, Uri};
use axum::middleware;
use axum::response::{IntoResponse, Response};
use axum::routing::{any, get};
use tower_http::catch_panic::CatchPanicLayer;
use tower_http::set_header::SetResponseHeaderLayer;
use tower_http::trace::TraceLayer;
use tyndall_stream::protocol::ErrorCode;

use crate::problem::Problem;
use crate::server::App;
use crate::socket;

/// Everything that the port answers.
pub(crate) fn router(app: Arc<App>) -> Router {
    let guarded = Router::new()
        .route("/v1/access", get(token::access))
        .route("/v1/presets", get(presets::list))
        .route("/v1/presets/{name}", get(presets::one))
        .route("/v1/plan", get(plan::of_preset).post(plan::of_scene))
        .route("/v1/schema", get(schema::scene))
        .route("/v1/stream", any(socket::upgrade))
        .route("/metrics", get(metrics::print))
        .merge(jobs::router(app.job_limits.max_upload_bytes))
        .route_layer(middleware::from_fn_with_state(
            Arc::clone(&app),
            token::require,
        ));
    let checked = middleware::from_fn_with_state(Arc::clone(&app), host::check);
    let router = Router::new()
        .route("/livez", get(health::live))
        .route("/readyz", get(health::ready))
        .route("/version", get(health::version))
        .route("/openapi.json", get(openapi::json))
        .route("/docs", get(openapi::page))
        .route("/docs.js", get(openapi::script))
        .merge(guarded)
        .layer(DefaultBodyLimit::max(app.limits.max_body_bytes))
        .with_state(app)
        .merge(page::router())
        .fallback(not_found)
        .method_not_allowed_fallback(method_not_allowed)
        .layer(checked);
    [
        ("x-content-type-options", "nosniff"),
        ("x-frame-options", "DENY"),
        // The address may carry the token.
        ("referrer-policy", "no-referrer"),
        ("cross-origin-opener-policy", "same-origin"),
        ("cross-origin-resource-policy", "same-origin"),
    ]
    .into_iter()
    .fold(router, |router, (name, value)| {
        router.layer(SetResponseHeaderLayer::overriding(
            HeaderName::from_static(name),
            HeaderValue::from_static(value),
        ))
    })
    .layer(CatchPanicLayer::custom(panicked))
    // The path without its query: that may carry the token.
    .layer(TraceLayer::new_for_http().make_span_with(|request: &Request| {
        tracing::debug_span!("http", method = %request.method(), path = request.uri().path())
    }))
}

async fn not_found(uri: Uri) -> Problem {
    let path: String = uri.path().chars().take(200).collect();
    Problem::new(ErrorCode::NotFound, format!("there is nothing at {path}"))
}

async fn method_not_allowed(uri: Uri) -> Problem {
    let path: String = uri.path().chars().take(200).collect();
    Problem::new(
        ErrorCode::MethodNotAllowed,
        format!("{path} does not take this method"),
    )
}

fn panicked(_panic: Box<dyn std::any::Any + Send>) -> Response {
    tracing::error!("a request handler panicked");
    Problem::new(ErrorCode::Internal, "the request could not be handled").into_response()
}
