//! From a description to the scene that the renderer takes.

use std::path::Path;
use std::sync::Arc;

use glam::{DVec3, Vec3};

use crate::description::media::Coefficients;
use crate::description::render::Technique;
use crate::description::{
    Bounds, CameraDescription, GeometryDescription, LightDescription, MediumDescription,
    RenderDescription, Rgb, SceneDescription,
};
use crate::error::SceneError;
use crate::files::Folder;
use crate::geometry::{Geometry, SharedGeometry};
use crate::import::{self, Assets, Imported};
use crate::limits::Limits;
use crate::scene::{
    Aabb, Camera, CorrectionMode, DirectionalLight, Environment, Light, Medium, MediumShape,
    PointLight, ReferenceSettings, RenderSettings, Scene, ShadowSettings, SingleScatteringSettings,
    SpotLight, StopRule,
};
use crate::tracks;
use crate::validate;

/// Samples a pixel if the description names no stop rule.
const DEFAULT_SAMPLES: u32 = 64;

/// A scene together with what it was made from.
#[derive(Debug, Clone)]
pub struct Loaded {
    /// The description. Lights of glTF files have moved into `lights`, and `import_lights` is
    /// off, so that building it again gives the same scene.
    pub description: SceneDescription,
    /// What the renderer takes.
    pub scene: Scene,
    /// What was left out or approximated, one sentence each.
    pub warnings: Vec<String>,
}

/// Validates a description, reads its files from `folder` and builds the scene.
///
/// Without a folder the description may not refer to files.
///
/// # Errors
/// [`SceneError`] with the JSON path of what is wrong.
pub fn build(description: SceneDescription, folder: Option<&Path>) -> Result<Loaded, SceneError> {
    build_with(description, folder, &Limits::default())
}

/// [`build`] with other limits.
///
/// # Errors
/// [`SceneError`] with the JSON path of what is wrong.
pub fn build_with(
    description: SceneDescription,
    folder: Option<&Path>,
    limits: &Limits,
) -> Result<Loaded, SceneError> {
    with_file_camera(description, folder, limits).map(|(loaded, _)| loaded)
}

/// [`build_with`], and the first perspective camera of the files.
pub(crate) fn with_file_camera(
    mut description: SceneDescription,
    folder: Option<&Path>,
    limits: &Limits,
) -> Result<(Loaded, Option<CameraDescription>), SceneError> {
    validate::description(&description, limits)?;
    let folder = Folder::open(folder, limits)?;
    let mut imported = import::geometry(&description.geometry, &folder, limits)?;
    let file_camera = imported.camera.take();
    let (geometry, mut warnings) = adopt(&mut description, imported, limits)?;
    let assets = Assets::load(&description, &folder, limits, &mut warnings)?;
    let scene = scene(
        &description,
        SharedGeometry(Arc::new(geometry)),
        assets,
        0.0,
    )?;
    let loaded = Loaded {
        description,
        scene,
        warnings,
    };
    Ok((loaded, file_camera))
}

/// Moves the lights of glTF files into the description.
fn adopt(
    description: &mut SceneDescription,
    imported: Imported,
    limits: &Limits,
) -> Result<(Geometry, Vec<String>), SceneError> {
    let has_files = |entry: &GeometryDescription| matches!(entry, GeometryDescription::Gltf(gltf) if gltf.import_lights);
    if description.geometry.iter().any(has_files) {
        for entry in Arc::make_mut(&mut description.geometry) {
            if let GeometryDescription::Gltf(gltf) = entry {
                gltf.import_lights = false;
            }
        }
    }
    for (entry, light) in imported.lights {
        let path = format!("geometry[{entry}].path");
        validate::light_can_arrive(&light, &path, &description.media)?;
        description.lights.push(light);
    }
    // The file's lights keep the same rules as written ones.
    validate::all_but_geometry(description, limits)?;
    Ok((imported.geometry, imported.warnings))
}

/// The scene of a validated description with given geometry and files, at a time. Unit: s.
pub(crate) fn scene(
    description: &SceneDescription,
    geometry: SharedGeometry,
    assets: Assets,
    seconds: f64,
) -> Result<Scene, SceneError> {
    let Assets { map, shapes } = assets;
    let environment = description.lights.iter().find_map(environment);
    let scene = Scene {
        name: description.name.clone(),
        camera: camera(&description.camera),
        geometry,
        lights: description.lights.iter().filter_map(light).collect(),
        environment: environment.map(|environment| Environment { map, ..environment }),
        media: description
            .media
            .iter()
            .zip(shapes)
            .map(|(description, shape)| medium(description, shape))
            .collect(),
        render: render(&description.render),
        animation: tracks::animation(description)?.map(Arc::new),
        time_seconds: 0.0,
    };
    scene.at(seconds)
}

pub(crate) fn camera(camera: &CameraDescription) -> Camera {
    Camera {
        position: DVec3::from_array(camera.position),
        target: DVec3::from_array(camera.target),
        up: unit(camera.up),
        vertical_fov: camera.vertical_fov_degrees.to_radians() as f32,
        exposure_ev: camera.exposure_ev as f32,
    }
}

fn light(light: &LightDescription) -> Option<Light> {
    Some(match light {
        LightDescription::Point(light) => Light::Point(PointLight {
            name: light.name.clone().unwrap_or_default(),
            position: DVec3::from_array(light.position),
            intensity: rgb(light.intensity),
            radius: light.radius as f32,
            casts_shadows: light.casts_shadows,
        }),
        LightDescription::Spot(light) => Light::Spot(SpotLight {
            name: light.name.clone().unwrap_or_default(),
            position: DVec3::from_array(light.position),
            direction: unit(light.direction),
            intensity: rgb(light.intensity),
            inner_angle: light.inner_angle_degrees.to_radians() as f32,
            outer_angle: light.outer_angle_degrees.to_radians() as f32,
            radius: light.radius as f32,
            casts_shadows: light.casts_shadows,
        }),
        LightDescription::Directional(light) => Light::Directional(DirectionalLight {
            name: light.name.clone().unwrap_or_default(),
            direction: unit(light.direction),
            irradiance: rgb(light.irradiance),
            casts_shadows: light.casts_shadows,
        }),
        LightDescription::Environment(_) => return None,
    })
}

fn environment(light: &LightDescription) -> Option<Environment> {
    let LightDescription::Environment(light) = light else {
        return None;
    };
    Some(Environment {
        radiance: rgb(light.radiance),
        map: None,
        rotation: light.rotation_degrees.to_radians() as f32,
    })
}

fn medium(medium: &MediumDescription, shape: MediumShape) -> Medium {
    let coefficients = medium.coefficients();
    let (sigma_s, sigma_a) = scattering_and_absorption(&coefficients);
    let scale = coefficients.density_scale;
    Medium {
        name: coefficients.name.unwrap_or_default().to_owned(),
        sigma_s: sigma_s.map(|sigma| (sigma * scale) as f32),
        sigma_a: sigma_a.map(|sigma| (sigma * scale) as f32),
        g: coefficients.g as f32,
        emission: coefficients.emission.0.map(|e| (e * scale) as f32),
        shape,
    }
}

/// `sigma_s` and `sigma_a` of either pair, before the density scale. Unit: m⁻¹.
fn scattering_and_absorption(medium: &Coefficients) -> ([f64; 3], [f64; 3]) {
    let zero = Rgb::grey(0.0);
    match (medium.sigma_t, medium.albedo) {
        (Some(Rgb(sigma_t)), Some(Rgb(albedo))) => (
            std::array::from_fn(|c| sigma_t[c] * albedo[c]),
            std::array::from_fn(|c| sigma_t[c] * (1.0 - albedo[c])),
        ),
        _ => (
            medium.sigma_s.unwrap_or(zero).0,
            medium.sigma_a.unwrap_or(zero).0,
        ),
    }
}

fn render(render: &RenderDescription) -> RenderSettings {
    let stop = match (render.samples, render.time_seconds, render.relative_error) {
        (_, Some(seconds), _) => StopRule::Seconds(seconds as f32),
        (_, _, Some(error)) => StopRule::RelativeError(error as f32),
        (samples, None, None) => StopRule::Samples(samples.unwrap_or(DEFAULT_SAMPLES)),
    };
    RenderSettings {
        technique: render.technique.into(),
        width: render.width,
        height: render.height,
        stop,
        correction: correction(render),
        seed: render.seed,
        single_scattering: SingleScatteringSettings {
            steps: render.single_scattering.steps,
            jitter: render.single_scattering.jitter,
            interleave: render.single_scattering.interleave,
            half_resolution: render.single_scattering.half_resolution,
            equiangular: render.single_scattering.equiangular,
        },
        reference: ReferenceSettings {
            max_scatterings: render.reference.max_scatterings,
            max_surface_scatterings: render.reference.max_surface_scatterings,
            medium_order: render.reference.medium_order.into(),
        },
        shadows: ShadowSettings {
            mode: render.shadows.mode.into(),
            resolution: render.shadows.resolution,
        },
    }
}

/// What was asked for; otherwise the reference's picture stays as it is traced, and every other
/// technique's is corrected.
fn correction(render: &RenderDescription) -> CorrectionMode {
    match (render.correction, render.technique) {
        (Some(mode), _) => mode.into(),
        (None, Technique::Reference) => CorrectionMode::Off,
        (None, _) => CorrectionMode::Always,
    }
}

fn rgb(Rgb(channels): Rgb) -> [f32; 3] {
    channels.map(|channel| channel as f32)
}

/// The unit vector along a validated direction, which is never short.
pub(crate) fn unit(direction: [f64; 3]) -> Vec3 {
    let direction = DVec3::from_array(direction);
    (direction / direction.length()).as_vec3()
}

pub(crate) fn aabb(bounds: &Bounds) -> Aabb {
    Aabb {
        min: DVec3::from_array(bounds.min),
        max: DVec3::from_array(bounds.max),
    }
}
