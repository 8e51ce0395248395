//! The rules that several parts share.

use crate::description::{Bounds, Rgb, Transform};
use crate::error::{SceneError, abbreviate};
use crate::files::check_relative;
use crate::json_path::JsonPath;

pub(super) use crate::range::{LATEST, found, range, shown};

/// Largest magnitude of a coordinate; keeps every square and product finite in `f32`. Unit: m.
pub(super) const COORDINATE: f64 = 1e7;
/// Largest seed: every JSON reader keeps it exactly.
pub(super) const SEED: u64 = (1 << 53) - 1;
/// Shortest vector that has a direction.
pub(super) const SHORTEST: f64 = 1e-6;
/// Longest name. Unit: character.
const NAME: usize = 200;
/// Largest emitted radiance, irradiance and emission of a medium, in their units.
pub(super) const RADIANCE: f64 = 1e9;
/// Largest angle of a rotation. Unit: degree.
const ROTATION: f64 = 36_000.0;

type Checked = Result<(), SceneError>;

/// `low` ≤ `value` ≤ `high` for whole numbers.
pub(super) fn whole(path: &JsonPath, value: u64, low: u64, high: u64) -> Checked {
    if (low..=high).contains(&value) {
        return Ok(());
    }
    let allowed = format!("{low} to {high}");
    Err(SceneError::invalid(path, value.to_string(), allowed))
}

/// Every channel in range.
pub(super) fn rgb(path: &JsonPath, Rgb(channels): &Rgb, low: f64, high: f64) -> Checked {
    triple(path, channels, low, high)
}

/// Every component in range; the path names the component unless all are equal.
pub(super) fn triple(path: &JsonPath, components: &[f64; 3], low: f64, high: f64) -> Checked {
    if components.iter().all(|c| *c == components[0]) {
        return range(path, components[0], low, high);
    }
    for (i, component) in components.iter().enumerate() {
        range(&path.index(i), *component, low, high)?;
    }
    Ok(())
}

/// A finite position.
pub(super) fn position(path: &JsonPath, position: &[f64; 3]) -> Checked {
    for (i, coordinate) in position.iter().enumerate() {
        range(&path.index(i), *coordinate, -COORDINATE, COORDINATE)?;
    }
    Ok(())
}

/// A finite vector long enough to have a direction.
pub(super) fn direction(path: &JsonPath, direction: &[f64; 3]) -> Checked {
    position(path, direction)?;
    if glam::DVec3::from_array(*direction).length() < SHORTEST {
        let allowed = format!("a vector longer than {}", shown(SHORTEST));
        return Err(SceneError::invalid(path, list(direction), allowed));
    }
    Ok(())
}

/// `min < max` in every component.
pub(super) fn bounds(path: &JsonPath, bounds: &Bounds) -> Checked {
    let (min_path, max_path) = (path.field("min"), path.field("max"));
    corners(&min_path, &bounds.min, &max_path, &bounds.max)
}

/// `min < max` in every component.
pub(super) fn corners(
    min_path: &JsonPath,
    min: &[f64; 3],
    max_path: &JsonPath,
    max: &[f64; 3],
) -> Checked {
    position(min_path, min)?;
    position(max_path, max)?;
    for i in 0..3 {
        if max[i] - min[i] < SHORTEST {
            let allowed = format!(
                "at least {} more than {min_path}[{i}], which is {}",
                shown(SHORTEST),
                found(min[i])
            );
            return Err(SceneError::invalid(
                max_path.index(i),
                found(max[i]),
                allowed,
            ));
        }
    }
    Ok(())
}

/// A name short enough to show, on one line.
pub(super) fn name(path: &JsonPath, name: &str) -> Checked {
    let length = name.chars().count();
    if length > NAME {
        return Err(SceneError::invalid(
            path,
            format!("{length} characters"),
            format!("at most {NAME} characters"),
        ));
    }
    if name.chars().any(char::is_control) {
        return Err(SceneError::invalid(
            path,
            "a control character",
            "printable characters",
        ));
    }
    Ok(())
}

/// An optional name.
pub(super) fn optional_name(path: &JsonPath, text: Option<&str>) -> Checked {
    text.map_or(Ok(()), |text| name(&path.field("name"), text))
}

/// An invertible transform.
pub(super) fn transform(path: &JsonPath, transform: &Transform) -> Checked {
    position(&path.field("translation"), &transform.translation)?;
    let angles = path.field("rotation_degrees");
    for (i, angle) in transform.rotation_degrees.iter().enumerate() {
        range(&angles.index(i), *angle, -ROTATION, ROTATION)?;
    }
    let path = path.field("scale");
    for (i, factor) in transform.scale.0.iter().enumerate() {
        if !(1e-6..=1e6).contains(&factor.abs()) {
            return Err(SceneError::invalid(
                path.index(i),
                found(*factor),
                "a factor of magnitude 1e−6 to 1e6",
            ));
        }
    }
    Ok(())
}

/// Directions that a light turns through: between opposite ones no arc is the shortest.
pub(super) fn directions<'a>(
    path: &JsonPath,
    directions: impl Iterator<Item = &'a [f64; 3]>,
) -> Checked {
    let mut before: Option<glam::DVec3> = None;
    for (i, found) in directions.enumerate() {
        let keyframe = path.index(i);
        let path = keyframe.field("direction");
        direction(&path, found)?;
        let vector = glam::DVec3::from_array(*found);
        let unit = vector / vector.length();
        if before.is_some_and(|before| before.dot(unit) < 0.0 && before.cross(unit).length() < 1e-3)
        {
            return Err(SceneError::invalid(
                path,
                list(found),
                "a direction that is not opposite to that of the keyframe before",
            ));
        }
        before = Some(unit);
    }
    Ok(())
}

/// Times that grow.
pub(super) fn times(path: &JsonPath, times: impl Iterator<Item = f64>) -> Checked {
    let mut before: Option<f64> = None;
    for (i, time) in times.enumerate() {
        let keyframe = path.index(i);
        let path = keyframe.field("time_seconds");
        range(&path, time, 0.0, LATEST)?;
        if let Some(before) = before.filter(|before| time <= *before) {
            let allowed = format!("more than the keyframe before, {}", found(before));
            return Err(SceneError::invalid(path, found(time), allowed));
        }
        before = Some(time);
    }
    Ok(())
}

/// Not more than the limit.
pub(super) fn count(path: &JsonPath, found: usize, limit: u64) -> Checked {
    let found = found as u64;
    if found > limit {
        return Err(SceneError::Limit {
            path: path.to_string(),
            what: "the number of entries",
            found,
            limit,
        });
    }
    Ok(())
}

/// A path below the scene's folder with one of the known endings.
pub(super) fn file(path: &JsonPath, file: &str, endings: &[&str]) -> Checked {
    check_relative(&path.to_string(), file)?;
    let ending = file.rsplit_once('.').map_or("", |(_, ending)| ending);
    if endings
        .iter()
        .any(|known| known.eq_ignore_ascii_case(ending))
    {
        return Ok(());
    }
    let allowed = format!("a file that ends in .{}", endings.join(", ."));
    Err(SceneError::invalid(path, quoted(file), allowed))
}

/// Three numbers as JSON writes them.
pub(super) fn list(components: &[f64; 3]) -> String {
    let [x, y, z] = components.map(found);
    format!("[{x}, {y}, {z}]")
}

/// Text from the scene in an error message.
pub(super) fn quoted(text: &str) -> String {
    format!("\"{}\"", abbreviate(text))
}
