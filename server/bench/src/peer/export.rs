//! A scene as the peer's script reads it: JSON, and raw little-endian arrays beside it.
//!
//! Triangles go out in world space, media as boxes around homogeneous coefficients or dense grids.
//! What has no counterpart is refused by name: a peer that renders something else proves nothing.
//! What is nearly the same is remarked.

mod files;
mod lights;
mod media;
mod surfaces;

use std::path::Path;

use serde_json::{Value, json};
use tyndall_scene::{Aabb, Scene};

use crate::error::BenchError;
use files::Files;
use lights::lights;
use media::medium;
use surfaces::{Surfaces, corners, surfaces};

/// A scene as JSON, with its arrays in files.
#[derive(Debug)]
pub(super) struct Exported {
    /// `camera`, `meshes`, `textures`, `lights`, `media`.
    pub json: Value,
    /// Differences that are small or out of sight.
    pub remarks: Vec<String>,
}

/// Writes arrays into `folder`. The inner error names what the peer can't be given.
pub(super) fn export(scene: &Scene, folder: &Path) -> Result<Result<Exported, String>, BenchError> {
    let mut files = Files::new(folder);
    let mut remarks = Vec::new();
    let Surfaces { meshes, textures } = match surfaces(scene, &mut files, &mut remarks)? {
        Ok(surfaces) => surfaces,
        Err(what) => return Ok(Err(what)),
    };
    let corners = corners(scene);
    let mut media = Vec::new();
    let mut boxes: Vec<Option<Aabb>> = Vec::new();
    for (i, medium) in scene.media.iter().enumerate() {
        match self::medium(medium, i, &corners, &mut files)? {
            Ok((value, bounds)) => {
                let overlaps = |other: &Option<Aabb>| match (other, &bounds) {
                    (Some(a), Some(b)) => a.min.cmplt(b.max).all() && b.min.cmplt(a.max).all(),
                    _ => true,
                };
                if let Some(other) = boxes.iter().position(overlaps) {
                    return Ok(Err(format!(
                        "media[{i}]: overlaps media[{other}], it has one medium at a place"
                    )));
                }
                boxes.push(bounds);
                media.push(value);
            }
            Err(what) => return Ok(Err(format!("media[{i}]: {what}"))),
        }
    }
    let unbounded = boxes.iter().any(Option::is_none);
    let lights = match lights(scene, unbounded, &mut files, &mut remarks)? {
        Ok(lights) => lights,
        Err(what) => return Ok(Err(what)),
    };
    let eye = scene.camera.position;
    let around = boxes
        .iter()
        .position(|bounds| bounds.is_none_or(|b| b.min.cmple(eye).all() && b.max.cmpge(eye).all()));
    let camera = &scene.camera;
    Ok(Ok(Exported {
        json: json!({
            "camera": {
                "position": eye.to_array(),
                "target": camera.target.to_array(),
                "up": camera.up.to_array(),
                "vertical_fov_degrees": camera.vertical_fov.to_degrees(),
                "medium": around,
            },
            "meshes": meshes,
            "textures": textures,
            "lights": lights,
            "media": media,
        }),
        remarks,
    }))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn exported(json: &Value) -> Result<Exported, String> {
        let description = tyndall_scene::SceneDescription::from_json(&json.to_string()).unwrap();
        let scene = tyndall_scene::build(description, None).unwrap().scene;
        let folder = tempfile::tempdir().unwrap();
        export(&scene, folder.path()).unwrap()
    }

    fn room(lights: &Value, media: &Value) -> Value {
        json!({
            "version": 1,
            "camera": {"position": [0, 1, 0.5], "target": [0, 1, -1]},
            "geometry": [{"kind": "quad", "corner": [-1, 0, 1], "edge_u": [2, 0, 0], "edge_v": [0, 0, -2]}],
            "lights": lights,
            "media": media,
        })
    }

    #[test]
    fn a_face_of_fog_that_lies_in_the_floor_moves_below_it() {
        let fog = json!([{"kind": "homogeneous", "sigma_t": 0.5, "albedo": 0.5,
            "bounds": {"min": [-1, 0, -1], "max": [1, 2, 1]}}]);
        let exported = exported(&room(&json!([]), &fog)).unwrap();
        let medium = &exported.json["media"][0];
        assert_eq!(medium["box"][0], json!([-1.0, -0.02, -1.0]));
        assert_eq!(medium["box"][1], json!([1.0, 2.0, 1.0]));
        assert_eq!(exported.json["camera"]["medium"], 0);
    }

    #[test]
    fn textures_go_out_with_their_wrap_and_placed_coordinates() {
        let file = concat!(
            env!("CARGO_MANIFEST_DIR"),
            "/../../tests/data/surface_truths/base_color.json"
        );
        let scene = tyndall_scene::load(Path::new(file)).unwrap().scene;
        let folder = tempfile::tempdir().unwrap();
        let exported = export(&scene, folder.path()).unwrap().unwrap().json;
        let wraps: Vec<&Value> = (0..4)
            .map(|i| {
                let index = exported["meshes"][i]["base_color_texture"]
                    .as_u64()
                    .unwrap();
                &exported["textures"][index as usize]["wrap"][0]
            })
            .collect();
        assert_eq!(wraps, ["repeat", "mirror", "clamp", "repeat"]);
        // The fourth has scale 1.5, 0.75 and offset 0.2, −0.1; its first corner is (0, 1).
        let name = exported["meshes"][3]["texcoords"].as_str().unwrap();
        let bytes = std::fs::read(folder.path().join(name)).unwrap();
        let value = |i: usize| f32::from_le_bytes(bytes[4 * i..][..4].try_into().unwrap());
        assert!((value(0) - 0.2).abs() < 1e-6 && (value(1) - 0.65).abs() < 1e-6);
    }

    #[test]
    fn what_the_peer_can_not_be_given_is_named() {
        let spot = json!([{"kind": "spot", "position": [0, 1, 0], "direction": [0, -1, 0],
            "intensity": 1, "outer_angle_degrees": 89.8}]);
        let error = exported(&room(&spot, &json!([]))).unwrap_err();
        assert!(
            error.contains("lights[0]") && error.contains("90"),
            "{error}"
        );
        let glow = json!([{"kind": "homogeneous", "sigma_t": 0.5, "albedo": 0.5, "emission": 1,
            "bounds": {"min": [-1, 0, -1], "max": [1, 2, 1]}}]);
        let error = exported(&room(&json!([]), &glow)).unwrap_err();
        assert!(
            error.contains("media[0]") && error.contains("emission"),
            "{error}"
        );
        let fog = json!([{"kind": "height_fog", "sigma_t": 0.5, "albedo": 0.5, "falloff": 1}]);
        let error = exported(&room(&json!([]), &fog)).unwrap_err();
        assert!(
            error.contains("media[0]") && error.contains("bounds"),
            "{error}"
        );
    }
}
