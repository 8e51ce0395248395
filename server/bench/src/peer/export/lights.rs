//! Lights and environments for the peer.

use serde_json::{Value, json};
use tyndall_scene::{Environment, Light, Scene};

use super::files::Files;
use crate::error::BenchError;

/// A radius above this is worth a word: the peer's lights are points. Unit: m.
const POINT: f32 = 1e-3;
/// The peer's spots project a picture of the falloff, flat across the cone. Unit: radian.
const WIDEST_SPOT: f32 = 1.56;
/// Columns of the largest environment map: the peer is given one six times as large.
const WIDEST_MAP: u32 = 2048;

/// The inner error names what the peer can't be given.
pub(super) fn lights(
    scene: &Scene,
    unbounded: bool,
    files: &mut Files<'_>,
    remarks: &mut Vec<String>,
) -> Result<Result<Vec<Value>, String>, BenchError> {
    let mut found = Vec::new();
    for (i, light) in scene.lights.iter().enumerate() {
        if !light.casts_shadows() {
            return Ok(Err(format!("lights[{i}]: casts no shadows")));
        }
        let mut point = |radius: f32| {
            if radius > POINT {
                remarks.push(format!(
                    "lights[{i}]: radius {radius} m, a mathematical point in the peer"
                ));
            }
        };
        match light {
            Light::Point(light) => {
                point(light.radius);
                found.push(json!({
                    "kind": "point",
                    "position": light.position.to_array(),
                    "intensity": light.intensity,
                }));
            }
            Light::Spot(light) if light.outer_angle > WIDEST_SPOT => {
                return Ok(Err(format!(
                    "lights[{i}]: a spot of {:.0}°, wider than {:.0}°",
                    light.outer_angle.to_degrees(),
                    WIDEST_SPOT.to_degrees()
                )));
            }
            Light::Spot(light) => {
                point(light.radius);
                found.push(json!({
                    "kind": "spot",
                    "position": light.position.to_array(),
                    "direction": light.direction.to_array(),
                    "intensity": light.intensity,
                    "inner_angle": light.inner_angle,
                    "outer_angle": light.outer_angle,
                }));
            }
            Light::Directional(_) if unbounded => {
                return Ok(Err(format!(
                    "lights[{i}]: directional, in a medium without bounds"
                )));
            }
            Light::Directional(light) => found.push(json!({
                "kind": "directional",
                "direction": light.direction.to_array(),
                "irradiance": light.irradiance,
            })),
        }
    }
    match &scene.environment {
        None => {}
        Some(environment) => match self::environment(environment, files)? {
            Ok(light) => found.push(light),
            Err(what) => return Ok(Err(what)),
        },
    }
    Ok(Ok(found))
}

fn environment(
    environment: &Environment,
    files: &mut Files<'_>,
) -> Result<Result<Value, String>, BenchError> {
    let radiance = environment.radiance;
    let Some(map) = &environment.map else {
        return Ok(Ok(json!({"kind": "constant", "radiance": radiance})));
    };
    if map.width > WIDEST_MAP {
        return Ok(Err(format!(
            "an environment map of {} columns, more than {WIDEST_MAP}",
            map.width
        )));
    }
    let pixels = map.pixels.iter().flatten().copied();
    let file = files.floats("environment.f32", pixels)?;
    Ok(Ok(json!({
        "kind": "environment",
        "radiance": radiance,
        "file": file,
        "width": map.width,
        "height": map.height,
        "rotation": environment.rotation,
    })))
}
