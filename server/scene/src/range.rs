//! The rule that every number keeps: it lies within a range.

use crate::error::SceneError;
use crate::json_path::JsonPath;

/// Latest keyframe. Unit: s.
pub(crate) const LATEST: f64 = 1e6;

/// A number as an error message shows what is allowed.
pub(crate) fn shown(value: f64) -> String {
    let magnitude = value.abs();
    let digits = if magnitude != 0.0 && !(1e-4..1e6).contains(&magnitude) {
        format!("{magnitude:e}").replace("e-", "e−")
    } else {
        magnitude.to_string()
    };
    if value < 0.0 {
        format!("−{digits}")
    } else {
        digits
    }
}

/// A number as an error message shows what was found: as JSON writes it.
pub(crate) fn found(value: f64) -> String {
    if !value.is_finite() {
        return "a number that is not finite".to_owned();
    }
    serde_json::to_string(&value).unwrap_or_else(|_| value.to_string())
}

/// `low` ≤ `value` ≤ `high`.
pub(crate) fn range(path: &JsonPath, value: f64, low: f64, high: f64) -> Result<(), SceneError> {
    if (low..=high).contains(&value) {
        return Ok(());
    }
    let allowed = format!("{} to {}", shown(low), shown(high));
    Err(SceneError::invalid(path, found(value), allowed))
}

/// Checks a time that a scene shall be shown at. Unit: s.
pub(crate) fn check_time(member: &str, seconds: f64) -> Result<(), SceneError> {
    range(&JsonPath::Root.field(member), seconds, 0.0, LATEST)
}
