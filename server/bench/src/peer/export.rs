//! A scene as the peer's script reads it: JSON, and raw little-endian arrays beside it.
//!
//! Triangles go out in world space, media as boxes around homogeneous coefficients or dense grids.
//! What has no counterpart is refused by name: a peer that renders something else proves nothing.
//! What is nearly the same is remarked.

use std::path::Path;

use glam::{DAffine3, DMat3, DVec3};
use serde_json::{Value, json};
use tyndall_scene::{Aabb, Environment, Light, Medium, MediumShape, Scene, SharedGrid};

use crate::error::BenchError;

/// Voxels along the axis in which height fog falls.
const FOG_VOXELS: usize = 1024;
/// Voxels along each axis of a soft ball.
const BALL_VOXELS: usize = 128;
/// Distance within which a surface lies in a face of a medium's box, as a share of its size.
const FACE_TOLERANCE: f64 = 1e-4;
/// How far such a face moves outward, as a share of the box's size: behind a wall nobody sees it,
/// and two surfaces in one plane would hide one another at random.
const FACE_SHIFT: f64 = 0.01;

/// A scene as JSON, with its arrays in files.
#[derive(Debug)]
pub(super) struct Exported {
    /// `camera`, `meshes`, `lights`, `media`.
    pub json: Value,
    /// Differences that are small or out of sight.
    pub remarks: Vec<String>,
}

/// Writes arrays into `folder`. The inner error names what the peer can't be given.
pub(super) fn export(scene: &Scene, folder: &Path) -> Result<Result<Exported, String>, BenchError> {
    let mut files = Files { folder };
    let mut remarks = Vec::new();
    let meshes = match meshes(scene, &mut files, &mut remarks)? {
        Ok(meshes) => meshes,
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
                if boxes.iter().any(overlaps) {
                    return Ok(Err(format!("media[{i}]: overlaps another medium")));
                }
                boxes.push(bounds);
                media.push(value);
            }
            Err(what) => return Ok(Err(format!("media[{i}]: {what}"))),
        }
    }
    let unbounded = boxes.iter().any(Option::is_none);
    let lights = match lights(scene, unbounded, &mut remarks) {
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
            "lights": lights,
            "media": media,
        }),
        remarks,
    }))
}

/// Arrays beside the JSON.
struct Files<'a> {
    folder: &'a Path,
}

impl Files<'_> {
    fn write(&mut self, name: &str, bytes: &[u8]) -> Result<String, BenchError> {
        let file = self.folder.join(name);
        std::fs::write(&file, bytes).map_err(|source| BenchError::io(file, source))?;
        Ok(name.to_owned())
    }

    fn floats(
        &mut self,
        name: &str,
        values: impl Iterator<Item = f32>,
    ) -> Result<String, BenchError> {
        let bytes: Vec<u8> = values.flat_map(f32::to_le_bytes).collect();
        self.write(name, &bytes)
    }
}

/// World positions of an instance's vertices.
fn world(scene: &Scene, instance: usize) -> impl Iterator<Item = DVec3> {
    let instance = &scene.geometry.instances[instance];
    let positions = &scene.geometry.meshes[instance.mesh].positions;
    let transform = instance.world_from_object;
    positions
        .iter()
        .map(move |p| transform.transform_point3(DVec3::from(p.map(f64::from))))
}

fn meshes(
    scene: &Scene,
    files: &mut Files<'_>,
    remarks: &mut Vec<String>,
) -> Result<Result<Vec<Value>, String>, BenchError> {
    let mut meshes = Vec::new();
    let (mut one_sided, mut glowing_backs) = (0, 0);
    for (i, instance) in scene.geometry.instances.iter().enumerate() {
        let mesh = &scene.geometry.meshes[instance.mesh];
        let material = &scene.geometry.materials[mesh.material];
        let name = &mesh.name;
        let textured = material.base_color_texture.is_some() || material.emission_texture.is_some();
        if textured || !mesh.colors.is_empty() {
            return Ok(Err(format!("mesh \"{name}\": textures or vertex colours")));
        }
        if material.alpha_cutoff.is_some() {
            return Ok(Err(format!("mesh \"{name}\": alpha mask")));
        }
        let glows = material.emission.iter().any(|value| *value > 0.0);
        one_sided += usize::from(!material.double_sided && !glows);
        glowing_backs += usize::from(material.double_sided && glows);
        let positions = world(scene, i).flat_map(|p| p.as_vec3().to_array());
        let positions = files.floats(&format!("mesh{i}.f32"), positions)?;
        let mirrored = instance.world_from_object.matrix3.determinant() < 0.0;
        let order: [usize; 3] = if mirrored { [0, 2, 1] } else { [0, 1, 2] };
        let indices: Vec<u8> = mesh
            .indices
            .chunks_exact(3)
            .flat_map(|triangle| order.map(|corner| triangle[corner]))
            .flat_map(u32::to_le_bytes)
            .collect();
        let indices = files.write(&format!("mesh{i}.u32"), &indices)?;
        meshes.push(json!({
            "positions": positions,
            "indices": indices,
            "reflectance": &material.base_color[..3],
            "emission": material.emission,
            "two_sided": material.double_sided,
        }));
    }
    if one_sided > 0 {
        remarks.push(format!(
            "{one_sided} one-sided surfaces: black from behind in the peer, not there in tyndall"
        ));
    }
    if glowing_backs > 0 {
        remarks.push(format!(
            "{glowing_backs} two-sided emitters: their back is dark in the peer"
        ));
    }
    Ok(Ok(meshes))
}

fn lights(scene: &Scene, unbounded: bool, remarks: &mut Vec<String>) -> Result<Vec<Value>, String> {
    let mut found = Vec::new();
    for (i, light) in scene.lights.iter().enumerate() {
        if !light.casts_shadows() {
            return Err(format!("lights[{i}]: casts no shadows"));
        }
        match light {
            Light::Point(light) => {
                if light.radius > 1e-3 {
                    remarks.push(format!(
                        "lights[{i}]: radius {} m, a mathematical point in the peer",
                        light.radius
                    ));
                }
                found.push(json!({
                    "kind": "point",
                    "position": light.position.to_array(),
                    "intensity": light.intensity,
                }));
            }
            Light::Spot(_) => {
                return Err(format!("lights[{i}]: spot, whose falloff the peer has not"));
            }
            Light::Directional(_) if unbounded => {
                return Err(format!(
                    "lights[{i}]: directional, in a medium without bounds"
                ));
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
        Some(Environment { map: Some(_), .. }) => return Err("environment map".into()),
        Some(environment) => {
            found.push(json!({"kind": "constant", "radiance": environment.radiance}));
        }
    }
    Ok(found)
}

/// A medium and the box it lies in, `None` for all of space.
fn medium(
    medium: &Medium,
    index: usize,
    corners: &[DVec3],
    files: &mut Files<'_>,
) -> Result<Result<(Value, Option<Aabb>), String>, BenchError> {
    if medium.emission.iter().any(|value| *value > 0.0) {
        return Ok(Err("emission".into()));
    }
    let file = format!("medium{index}.f32");
    let (bounds, grid) = match &medium.shape {
        MediumShape::Homogeneous { bounds } => (*bounds, None),
        MediumShape::HeightFog { bounds: None, .. } => {
            return Ok(Err("height fog without bounds".into()));
        }
        MediumShape::HeightFog {
            up,
            falloff,
            origin,
            bounds: Some(bounds),
        } => {
            let axis = up.abs().as_dvec3();
            let Some(axis) = (0..3).find(|i| axis[*i] > 1.0 - 1e-6) else {
                return Ok(Err("height fog whose up is no axis".into()));
            };
            let (low, high) = (bounds.min[axis], bounds.max[axis]);
            let values = (0..FOG_VOXELS).map(|i| {
                let at = low + (i as f64 + 0.5) / FOG_VOXELS as f64 * (high - low);
                let height = (at - origin[axis]) * f64::from(up[axis]);
                (-f64::from(*falloff) * height).exp() as f32
            });
            let mut shape = [1; 3];
            shape[2 - axis] = FOG_VOXELS;
            let file = files.floats(&file, values)?;
            (Some(*bounds), Some((file, shape, *bounds)))
        }
        MediumShape::Sphere { center, radius } => {
            let bounds = Aabb {
                min: *center - *radius,
                max: *center + *radius,
            };
            let place = |i: usize| 2.0 * (i as f64 + 0.5) / BALL_VOXELS as f64 - 1.0;
            let values = (0..BALL_VOXELS.pow(3)).map(|i| {
                let (x, y) = (place(i % BALL_VOXELS), place(i / BALL_VOXELS % BALL_VOXELS));
                let z = place(i / BALL_VOXELS / BALL_VOXELS);
                (1.0 - (x * x + y * y + z * z)).max(0.0) as f32
            });
            let file = files.floats(&file, values)?;
            (Some(bounds), Some((file, [BALL_VOXELS; 3], bounds)))
        }
        MediumShape::Grid {
            grid,
            world_from_lattice,
        } => {
            let Some(bounds) = placed_box(grid, world_from_lattice) else {
                return Ok(Err("a grid that is turned".into()));
            };
            let [low, high] = grid.clip;
            let side = (high - low).round().max(DVec3::ONE).as_uvec3();
            let step = (high - low) / side.as_dvec3();
            let (nx, ny) = (side.x as usize, side.y as usize);
            // At the middles of as many cells as there are voxels: those of a dense file, exactly.
            let values = (0..nx * ny * side.z as usize).map(|i| {
                let cell = DVec3::new((i % nx) as f64, (i / nx % ny) as f64, (i / nx / ny) as f64);
                grid.sample(low + (cell + 0.5) * step) as f32
            });
            let file = files.floats(&file, values)?;
            (
                Some(bounds),
                Some((file, [side.z as usize, ny, nx], bounds)),
            )
        }
    };
    let extinction: [f32; 3] = std::array::from_fn(|c| medium.sigma_s[c] + medium.sigma_a[c]);
    let albedo: [f32; 3] = std::array::from_fn(|c| {
        if extinction[c] > 0.0 {
            medium.sigma_s[c] / extinction[c]
        } else {
            0.0
        }
    });
    let shell = bounds.map(|bounds| clear_of_walls(bounds, corners));
    let grid = grid.map(|(file, shape, bounds)| {
        json!({
            "file": file,
            "shape": shape,
            "low": bounds.min.to_array(),
            "high": bounds.max.to_array(),
        })
    });
    let value = json!({
        "sigma_t": extinction,
        "albedo": albedo,
        "g": medium.g,
        "box": shell.map(|b| [b.min.to_array(), b.max.to_array()]),
        "grid": grid,
    });
    Ok(Ok((value, bounds)))
}

/// Where a grid's clip box lies, unless it is turned or mirrored.
fn placed_box(grid: &SharedGrid, world_from_lattice: &DAffine3) -> Option<Aabb> {
    let m = world_from_lattice.matrix3;
    let scale = DVec3::new(m.x_axis.x, m.y_axis.y, m.z_axis.z);
    let rest = m - DMat3::from_diagonal(scale);
    let turned = (0..3).any(|i| rest.col(i).abs().max_element() > 1e-9 * scale.max_element());
    if turned || scale.cmple(DVec3::ZERO).any() {
        return None;
    }
    let [low, high] = grid.clip;
    Some(Aabb {
        min: world_from_lattice.transform_point3(low),
        max: world_from_lattice.transform_point3(high),
    })
}

/// All corners of triangles, three a triangle.
fn corners(scene: &Scene) -> Vec<DVec3> {
    let mut corners = Vec::new();
    for (i, instance) in scene.geometry.instances.iter().enumerate() {
        let positions: Vec<DVec3> = world(scene, i).collect();
        let indices = &scene.geometry.meshes[instance.mesh].indices;
        corners.extend(indices.iter().map(|index| positions[*index as usize]));
    }
    corners
}

/// Moves each face that holds a triangle a little outward.
fn clear_of_walls(bounds: Aabb, corners: &[DVec3]) -> Aabb {
    let size = bounds.max - bounds.min;
    let mut moved = bounds;
    for axis in 0..3 {
        let holds = |face: f64| {
            corners.chunks_exact(3).any(|triangle| {
                let near = |p: &DVec3| (p[axis] - face).abs() < FACE_TOLERANCE * size[axis];
                triangle.iter().all(near)
            })
        };
        if holds(bounds.min[axis]) {
            moved.min[axis] -= FACE_SHIFT * size[axis];
        }
        if holds(bounds.max[axis]) {
            moved.max[axis] += FACE_SHIFT * size[axis];
        }
    }
    moved
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
    fn what_the_peer_can_not_be_given_is_named() {
        let spot = json!([{"kind": "spot", "position": [0, 1, 0], "direction": [0, -1, 0],
            "intensity": 1, "outer_angle_degrees": 30}]);
        assert!(
            exported(&room(&spot, &json!([])))
                .unwrap_err()
                .contains("spot")
        );
        let fog = json!([{"kind": "height_fog", "sigma_t": 0.5, "albedo": 0.5, "falloff": 1}]);
        let error = exported(&room(&json!([]), &fog)).unwrap_err();
        assert!(
            error.contains("media[0]") && error.contains("bounds"),
            "{error}"
        );
    }
}
