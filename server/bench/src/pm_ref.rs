//! Scenes of schema `pm-ref/1`, the reference scenes of two independent path tracers, as scene
//! descriptions.
//!
//! One mismatch is accepted. In `pm-ref/1` meshes reflect on both sides but emit on one, the side of the
//! normal. Emitters become single-sided, which emit and light as they should; the camera looks through
//! their backs. That is right only where the camera sees no emitter from behind, as in the reference
//! scenes, whose emitters lie on walls and ceilings.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use serde::Deserialize;
use serde_json::json;
use tyndall_files::regular::{self, ReadError};
use tyndall_scene::{SceneDescription, SceneError, parse_json};

/// Why a reference scene was not converted.
#[derive(Debug, thiserror::Error)]
pub enum PmRefError {
    /// The file can't be read.
    #[error("{}: {source}", file.display())]
    Io {
        /// The scene's file.
        file: PathBuf,
        /// The system's reason.
        source: std::io::Error,
    },
    /// The file is not of schema `pm-ref/1`, or the converted scene is refused.
    #[error("{}: {source}", file.display())]
    Scene {
        /// The scene's file.
        file: PathBuf,
        /// Where and why.
        source: SceneError,
    },
    /// Something of the schema that has no counterpart.
    #[error("{}: {what}", file.display())]
    Unsupported {
        /// The scene's file.
        file: PathBuf,
        /// What it is.
        what: String,
    },
}

/// Longest file. Unit: byte.
const LONGEST: u64 = 64 << 20;

/// The text of a regular file.
pub(crate) fn text(path: &Path) -> std::io::Result<String> {
    let wrong = |what: String| std::io::Error::new(std::io::ErrorKind::InvalidData, what);
    let bytes = regular::read(path, LONGEST).map_err(|error| match error {
        ReadError::Io(error) => error,
        too_large @ ReadError::TooLarge { .. } => wrong(too_large.to_string()),
    })?;
    String::from_utf8(bytes).map_err(|error| wrong(error.to_string()))
}

/// Loads a `pm-ref/1` scene.
///
/// Grid media keep their path, which is relative to the folder above the scene's own; everything
/// else stands in the description.
///
/// # Errors
/// [`PmRefError`] if the file can't be read, is of another schema, or is not valid here.
pub fn load(path: &Path) -> Result<SceneDescription, PmRefError> {
    let text = text(path).map_err(|source| PmRefError::Io {
        file: path.to_owned(),
        source,
    })?;
    let scene = |source| PmRefError::Scene {
        file: path.to_owned(),
        source,
    };
    // The schema first: what another one lacks should not hide the cause.
    let Schema { schema } = parse_json(&text).map_err(scene)?;
    if schema != "pm-ref/1" {
        return Err(PmRefError::Unsupported {
            file: path.to_owned(),
            what: format!("schema \"{schema}\", expected \"pm-ref/1\""),
        });
    }
    let reference: Reference = parse_json(&text).map_err(scene)?;
    let converted = json!({
        "version": 1,
        "name": reference.name,
        "camera": {
            "position": reference.camera.origin,
            "target": reference.camera.target,
            "up": reference.camera.up,
            "vertical_fov_degrees": reference.camera.vfov_deg,
        },
        "lights": reference.lights.iter().map(light).collect::<Vec<_>>(),
        "media": reference.media.iter().map(medium).collect::<Vec<_>>(),
        "render": {"width": reference.camera.width, "height": reference.camera.height},
    });
    let mut description = SceneDescription::from_json(&converted.to_string()).map_err(scene)?;
    let meshes = reference.meshes.iter().map(mesh).collect();
    let meshes = serde_json::from_value(meshes).map_err(|error| PmRefError::Unsupported {
        file: path.to_owned(),
        what: error.to_string(),
    })?;
    description.geometry = Arc::new(meshes);
    Ok(description)
}

#[derive(Deserialize)]
struct Schema {
    schema: String,
}

#[derive(Deserialize)]
struct Reference {
    name: String,
    camera: Camera,
    meshes: Vec<Mesh>,
    lights: Vec<Light>,
    media: Vec<Medium>,
}

#[derive(Deserialize)]
struct Camera {
    origin: [f64; 3],
    target: [f64; 3],
    up: [f64; 3],
    vfov_deg: f64,
    width: u32,
    height: u32,
}

#[derive(Deserialize)]
struct Mesh {
    name: String,
    vertices: Vec<[f64; 3]>,
    triangles: Vec<[u32; 3]>,
    reflectance: [f64; 3],
    #[serde(default)]
    emission: Option<[f64; 3]>,
}

#[derive(Deserialize)]
#[serde(tag = "type", rename_all = "snake_case")]
enum Light {
    Point {
        position: [f64; 3],
        intensity: [f64; 3],
    },
    Directional {
        direction: [f64; 3],
        irradiance: [f64; 3],
    },
    Constant {
        radiance: [f64; 3],
    },
}

#[derive(Deserialize)]
struct Medium {
    name: String,
    bounds_min: [f64; 3],
    bounds_max: [f64; 3],
    sigma_t: f64,
    albedo: f64,
    phase: Phase,
    density: Density,
}

#[derive(Deserialize)]
#[serde(tag = "type", rename_all = "snake_case")]
enum Phase {
    Hg { g: f64 },
}

#[derive(Deserialize)]
#[serde(tag = "type", rename_all = "snake_case")]
enum Density {
    Constant,
    ExpHeight { b: f64, y0: f64 },
    Grid { file: String },
}

/// Lambertian, flat shaded; two-sided unless it emits.
fn mesh(mesh: &Mesh) -> serde_json::Value {
    json!({
        "kind": "mesh",
        "name": mesh.name,
        "positions": mesh.vertices,
        "indices": mesh.triangles,
        "material": {
            "base_color": mesh.reflectance,
            "emission": mesh.emission.unwrap_or_default(),
            "double_sided": mesh.emission.is_none(),
        },
    })
}

/// The smallest radius: the reference has mathematical points.
fn light(light: &Light) -> serde_json::Value {
    match light {
        Light::Point {
            position,
            intensity,
        } => json!({
            "kind": "point", "position": position, "intensity": intensity, "radius": 1e-4,
        }),
        Light::Directional {
            direction,
            irradiance,
        } => json!({"kind": "directional", "direction": direction, "irradiance": irradiance}),
        Light::Constant { radiance } => json!({"kind": "environment", "radiance": radiance}),
    }
}

fn medium(medium: &Medium) -> serde_json::Value {
    let Phase::Hg { g } = medium.phase;
    let (low, high) = (medium.bounds_min, medium.bounds_max);
    let mut converted = json!({
        "name": medium.name,
        "sigma_t": medium.sigma_t,
        "albedo": medium.albedo,
        "g": g,
    });
    let bounds = json!({"min": low, "max": high});
    let shape = match &medium.density {
        Density::Constant => json!({"kind": "homogeneous", "bounds": bounds}),
        Density::ExpHeight { b, y0 } => json!({
            "kind": "height_fog", "falloff": b, "origin": [0.0, y0, 0.0], "bounds": bounds,
        }),
        // The grid fills the unit cube before its transform.
        Density::Grid { file } => json!({
            "kind": "grid",
            "path": file,
            "transform": {
                "translation": low,
                "scale": [high[0] - low[0], high[1] - low[1], high[2] - low[2]],
            },
        }),
    };
    if let (Some(members), Some(shape)) = (converted.as_object_mut(), shape.as_object()) {
        members.extend(shape.clone());
    }
    converted
}
