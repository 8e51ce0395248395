//! How a page steers the camera.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use ts_rs::TS;

/// How a page steers the camera.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema, TS)]
#[serde(rename_all = "snake_case")]
pub enum Navigation {
    /// The eye stays where it is and turns: for rooms and streets.
    Look,
    /// The eye moves about a point: for things seen from outside.
    Orbit,
    /// The eye turns and flies through everything.
    Fly,
}
