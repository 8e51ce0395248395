//! `/v1/schema`: the JSON Schema of a scene.

use axum::Json;
use axum::http::header;
use axum::response::IntoResponse;

pub(super) async fn scene() -> impl IntoResponse {
    let kind = "application/schema+json";
    (
        [(header::CONTENT_TYPE, kind)],
        Json(tyndall_scene::json_schema()),
    )
}
