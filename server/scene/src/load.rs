//! Scenes from files: a `.json` scene, or a bare model that gets a camera, light and fog.

use std::path::Path;
use std::sync::Arc;

use glam::DVec3;
use tyndall_files::regular::{self, ReadError};

use crate::build::{Loaded, build_with, with_file_camera};
use crate::description::geometry::{GltfGeometry, ObjGeometry};
use crate::description::lights::DirectionalLightDescription;
use crate::description::media::HomogeneousMedium;
use crate::description::{
    Bounds, CameraDescription, GeometryDescription, LightDescription, MediumDescription,
    RenderDescription, Rgb, SceneDescription, VERSION, camera,
};
use crate::error::SceneError;
use crate::facts::facts;
use crate::files::Folder;
use crate::import::{Assets, Grids};
use crate::limits::Limits;

/// Optical depth of the default fog across a bare model.
const DEFAULT_DEPTH: f64 = 0.7;

/// Loads a `.json` scene or a bare `.gltf`, `.glb` or `.obj` model.
///
/// A bare model gets the file's camera or one that frames it, the file's lights or a sun, and
/// thin fog around it.
///
/// # Errors
/// [`SceneError`] with the JSON path, or the file and the place in it, of what is wrong.
pub fn load(path: &Path) -> Result<Loaded, SceneError> {
    load_with(path, &Limits::default())
}

/// [`load`] with other limits.
///
/// # Errors
/// [`SceneError`] with the JSON path, or the file and the place in it, of what is wrong.
pub fn load_with(path: &Path, limits: &Limits) -> Result<Loaded, SceneError> {
    let folder = match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    };
    let ending = path.extension().and_then(|ending| ending.to_str());
    let ending = ending.unwrap_or_default().to_ascii_lowercase();
    match ending.as_str() {
        "json" => {
            let text = scene_text(path, limits)?;
            build_with(
                SceneDescription::parse(&text, limits)?,
                Some(folder),
                limits,
            )
        }
        "gltf" | "glb" | "obj" => bare_model(path, &ending, folder, limits),
        other => Err(SceneError::invalid(
            "",
            format!("a file that ends in \".{other}\""),
            ".json, .gltf, .glb or .obj",
        )),
    }
}

/// Reads the JSON text of a scene.
fn scene_text(path: &Path, limits: &Limits) -> Result<String, SceneError> {
    let io = |source| SceneError::Io {
        path: String::new(),
        file: path.display().to_string(),
        source,
    };
    let bytes = regular::read(path, limits.scene_bytes).map_err(|error| match error {
        ReadError::Io(source) => io(source),
        ReadError::TooLarge { found, limit } => SceneError::Limit {
            path: String::new(),
            what: "size of the file in bytes",
            found,
            limit,
        },
    })?;
    String::from_utf8(bytes)
        .map_err(|error| io(std::io::Error::new(std::io::ErrorKind::InvalidData, error)))
}

/// A model file as a scene.
fn bare_model(
    path: &Path,
    ending: &str,
    folder: &Path,
    limits: &Limits,
) -> Result<Loaded, SceneError> {
    let file = path.file_name().and_then(|name| name.to_str());
    let file = file.ok_or_else(|| SceneError::invalid("", "a file name", "one in UTF-8"))?;
    let geometry = if ending == "obj" {
        GeometryDescription::Obj(ObjGeometry {
            name: None,
            path: file.to_owned(),
            transform: None,
            keyframes: Vec::new(),
        })
    } else {
        GeometryDescription::Gltf(GltfGeometry {
            name: None,
            path: file.to_owned(),
            luminous_efficacy: 683.0,
            import_lights: true,
            transform: None,
            keyframes: Vec::new(),
        })
    };
    let description = SceneDescription {
        version: VERSION,
        name: file.chars().take(100).collect(),
        camera: looking_from([0.0, 0.0, 1.0], [0.0; 3]),
        navigation: None,
        geometry: Arc::new(vec![geometry]),
        lights: Vec::new(),
        media: Vec::new(),
        render: RenderDescription::default(),
        animation: None,
    };
    let (mut loaded, file_camera) = with_file_camera(description, Some(folder), limits)?;
    furnish(&mut loaded, file_camera);
    crate::validate::all_but_geometry(&loaded.description, limits)?;
    let assets = Assets::load(
        &loaded.description,
        &Folder::open(Some(folder), limits)?,
        limits,
        Grids::Made,
        &mut loaded.warnings,
    )?;
    let geometry = loaded.scene.geometry.clone();
    loaded.scene = crate::build::scene(&loaded.description, geometry, assets, 0.0)?;
    Ok(loaded)
}

/// Adds what a bare model lacks.
fn furnish(loaded: &mut Loaded, file_camera: Option<CameraDescription>) {
    let facts = facts(&loaded.scene);
    let bounds = facts.surface_bounds.unwrap_or(facts.bounds);
    let center = 0.5 * (bounds.min + bounds.max);
    let extent = (bounds.max - bounds.min).length();
    let description = &mut loaded.description;
    if let Some(mut camera) = file_camera {
        // The target is the pivot of an orbit: at the model's depth rather than 1 m ahead.
        let position = DVec3::from_array(camera.position);
        let forward = DVec3::from_array(camera.target) - position;
        let depth = (center - position).dot(forward).max(1.0);
        camera.target = (position + depth * forward).to_array();
        description.camera = camera;
    } else {
        // Far enough that the bounding sphere fills the view, from the front, right and above.
        let half_fov = 0.5 * camera::vertical_fov_degrees().to_radians();
        let distance = 0.5 * extent / half_fov.sin();
        let direction = DVec3::new(0.45, 0.3, 0.84);
        let position = center + distance * direction / direction.length();
        description.camera = looking_from(position.to_array(), center.to_array());
    }
    if description.lights.is_empty() {
        let light = DirectionalLightDescription {
            name: Some("sun".to_owned()),
            direction: [-0.5, -0.8, -0.35],
            irradiance: Rgb([3.2, 3.0, 2.7]),
            casts_shadows: true,
            keyframes: Vec::new(),
        };
        description
            .lights
            .push(LightDescription::Directional(light));
    }
    let margin = 0.1 * extent;
    description
        .media
        .push(MediumDescription::Homogeneous(HomogeneousMedium {
            name: Some("fog".to_owned()),
            sigma_s: None,
            sigma_a: None,
            sigma_t: Some(Rgb::grey(DEFAULT_DEPTH / extent)),
            albedo: Some(Rgb::grey(0.95)),
            g: 0.3,
            phase: None,
            emission: Rgb::grey(0.0),
            density_scale: 1.0,
            bounds: Some(Bounds {
                min: (bounds.min - margin).to_array(),
                max: (bounds.max + margin).to_array(),
            }),
        }));
}

fn looking_from(position: [f64; 3], target: [f64; 3]) -> CameraDescription {
    CameraDescription {
        position,
        target,
        up: camera::up(),
        vertical_fov_degrees: camera::vertical_fov_degrees(),
        exposure_ev: 0.0,
        keyframes: Vec::new(),
    }
}
