//! `/livez`, `/readyz`, `/version`: for supervisors, open to all.

use std::sync::Arc;

use axum::Json;
use axum::extract::State;
use serde::Serialize;
use tyndall_stream::protocol::{Adapter, ErrorCode, PROTOCOL_VERSION};

use crate::problem::Problem;
use crate::server::App;

/// The process answers.
pub(super) async fn live() -> &'static str {
    "live\n"
}

/// The renderer works and the server is not going down.
pub(super) async fn ready(State(app): State<Arc<App>>) -> Result<String, Problem> {
    if app.shutdown.is_cancelled() {
        return Err(Problem::new(
            ErrorCode::NotReady,
            "the server is going down",
        ));
    }
    if !app.readiness.get() {
        return Err(Problem::new(ErrorCode::NotReady, "no device is open"));
    }
    let (renderer, encoder) = app.readiness.panics();
    let mut text = "ready\n".to_owned();
    for (count, place) in [(renderer, "renderer"), (encoder, "encoder")] {
        if count > 0 {
            text += &format!("{count} pictures were given up after a panic of the {place}\n");
        }
    }
    Ok(text)
}

#[derive(Debug, Serialize)]
pub(super) struct About {
    name: &'static str,
    version: &'static str,
    protocol: u32,
    adapter: Adapter,
}

/// What runs here.
pub(super) async fn version(State(app): State<Arc<App>>) -> Json<About> {
    Json(About {
        name: "tyndall",
        version: env!("CARGO_PKG_VERSION"),
        protocol: PROTOCOL_VERSION,
        adapter: app.adapter.clone(),
    })
}
