//! The scene of a description, part by part: units, defaults, either pair of coefficients.

use std::sync::Arc;

use glam::DVec3;

use super::tracks;
use crate::description::media::Coefficients;
use crate::description::values::unit;
use crate::description::{
    CameraDescription, LightDescription, MediumDescription, RenderDescription, Rgb,
    SceneDescription,
};
use crate::error::SceneError;
use crate::import::Assets;
use crate::scene::{
    Camera, CorrectionMode, DirectionalLight, Environment, Light, Medium, MediumShape,
    PhaseFunction, PointLight, RenderSettings, Scene, SharedGeometry, SpotLight, StopRule,
    Technique,
};

/// Samples a pixel if the description names no stop rule.
const DEFAULT_SAMPLES: u32 = 64;

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
        up: unit(camera.up).as_vec3(),
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
            direction: unit(light.direction).as_vec3(),
            intensity: rgb(light.intensity),
            inner_angle: light.inner_angle_degrees.to_radians() as f32,
            outer_angle: light.outer_angle_degrees.to_radians() as f32,
            radius: light.radius as f32,
            casts_shadows: light.casts_shadows,
        }),
        LightDescription::Directional(light) => Light::Directional(DirectionalLight {
            name: light.name.clone().unwrap_or_default(),
            direction: unit(light.direction).as_vec3(),
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
        phase: coefficients.phase.map_or(
            PhaseFunction::HenyeyGreenstein {
                g: coefficients.g as f32,
            },
            PhaseFunction::from,
        ),
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
        technique: render.technique,
        width: render.width,
        height: render.height,
        stop,
        correction: correction(render),
        seed: render.seed,
        single_scattering: render.single_scattering,
        screen_space: render.screen_space,
        reference: render.reference,
        shadows: render.shadows,
    }
}

/// What was asked for; otherwise the reference's picture stays as it is traced, and every other
/// technique's is corrected.
fn correction(render: &RenderDescription) -> CorrectionMode {
    match (render.correction, render.technique) {
        (Some(mode), _) => mode,
        (None, Technique::Reference) => CorrectionMode::Off,
        (None, _) => CorrectionMode::Always,
    }
}

fn rgb(Rgb(channels): Rgb) -> [f32; 3] {
    channels.map(|channel| channel as f32)
}
