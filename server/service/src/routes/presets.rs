//! `/v1/presets`: the built-in scenes, the default first.

use axum::Json;
use axum::extract::Path;
use tyndall_scene::SceneDescription;
use tyndall_scene::presets::{self, PresetInfo};
use tyndall_stream::protocol::ErrorCode;

use crate::problem::Problem;

pub(super) async fn list() -> Json<&'static [PresetInfo]> {
    Json(presets::names())
}

pub(super) async fn one(Path(name): Path<String>) -> Result<Json<SceneDescription>, Problem> {
    presets::description(&name).map(Json).ok_or_else(|| {
        let name: String = name.chars().take(80).collect();
        Problem::new(ErrorCode::NotFound, format!("there is no preset {name:?}"))
    })
}
