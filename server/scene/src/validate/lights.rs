//! Rules of lights.

use super::rules;
use crate::description::{LightDescription, Rgb};
use crate::error::SceneError;
use crate::json_path::JsonPath;

/// Largest intensity. Unit: W·sr⁻¹.
const INTENSITY: f64 = 1e12;
/// Least distance between a spot's two angles; the falloff divides by it. Unit: degree.
const PENUMBRA: f64 = 0.01;
/// Endings of environment maps.
const MAPS: &[&str] = &["hdr", "exr"];

pub(super) fn check(light: &LightDescription, path: &JsonPath) -> Result<(), SceneError> {
    match light {
        LightDescription::Point(light) => {
            rules::optional_name(path, light.name.as_deref())?;
            rules::position(&path.field("position"), &light.position)?;
            intensity(path, &light.intensity)?;
            radius(path, light.radius)?;
            let path = path.field("keyframes");
            rules::times(&path, light.keyframes.iter().map(|key| key.time_seconds))?;
            positions(&path, light.keyframes.iter().map(|key| &key.position))
        }
        LightDescription::Spot(light) => {
            rules::optional_name(path, light.name.as_deref())?;
            rules::position(&path.field("position"), &light.position)?;
            rules::direction(&path.field("direction"), &light.direction)?;
            intensity(path, &light.intensity)?;
            let outer = light.outer_angle_degrees;
            rules::range(&path.field("outer_angle_degrees"), outer, 0.1, 89.9)?;
            rules::range(
                &path.field("inner_angle_degrees"),
                light.inner_angle_degrees,
                0.0,
                outer - PENUMBRA,
            )?;
            radius(path, light.radius)?;
            let path = path.field("keyframes");
            rules::times(&path, light.keyframes.iter().map(|key| key.time_seconds))?;
            positions(&path, light.keyframes.iter().map(|key| &key.position))?;
            rules::directions(&path, light.keyframes.iter().map(|key| &key.direction))
        }
        LightDescription::Directional(light) => {
            rules::optional_name(path, light.name.as_deref())?;
            rules::direction(&path.field("direction"), &light.direction)?;
            let irradiance = path.field("irradiance");
            rules::rgb(&irradiance, &light.irradiance, 0.0, rules::RADIANCE)?;
            let path = path.field("keyframes");
            rules::times(&path, light.keyframes.iter().map(|key| key.time_seconds))?;
            rules::directions(&path, light.keyframes.iter().map(|key| &key.direction))
        }
        LightDescription::Environment(light) => {
            rules::optional_name(path, light.name.as_deref())?;
            rules::rgb(
                &path.field("radiance"),
                &light.radiance,
                0.0,
                rules::RADIANCE,
            )?;
            let rotation = path.field("rotation_degrees");
            rules::range(&rotation, light.rotation_degrees, -360.0, 360.0)?;
            match &light.map {
                Some(map) => rules::file(&path.field("map"), map, MAPS),
                None => Ok(()),
            }
        }
    }
}

/// Positions of keyframes.
fn positions<'a>(
    path: &JsonPath,
    positions: impl Iterator<Item = &'a [f64; 3]>,
) -> Result<(), SceneError> {
    for (i, position) in positions.enumerate() {
        rules::position(&path.index(i).field("position"), position)?;
    }
    Ok(())
}

fn intensity(path: &JsonPath, value: &Rgb) -> Result<(), SceneError> {
    rules::rgb(&path.field("intensity"), value, 0.0, INTENSITY)
}

fn radius(path: &JsonPath, value: f64) -> Result<(), SceneError> {
    rules::range(&path.field("radius"), value, 1e-4, 1e3)
}

/// Two environments would be one too many for the scene to hold.
pub(super) fn at_most_one_environment(
    lights: &[LightDescription],
    path: &JsonPath,
) -> Result<(), SceneError> {
    let mut environments = lights
        .iter()
        .enumerate()
        .filter(|(_, light)| matches!(light, LightDescription::Environment(_)))
        .map(|(i, _)| i);
    match (environments.next(), environments.next()) {
        (Some(first), Some(second)) => Err(SceneError::invalid(
            path.index(second),
            format!("a second environment, after {}", path.index(first)),
            "at most one environment",
        )),
        _ => Ok(()),
    }
}
