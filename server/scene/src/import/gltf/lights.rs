//! `KHR_lights_punctual`: photometric units divided by a luminous efficacy.

use glam::{DAffine3, DVec3};
use gltf::json::extensions::scene::khr_lights_punctual::{Light, Type};
use gltf::json::validation::Checked;

use super::document::Document;
use crate::description::lights::{
    DirectionalLightDescription, PointLightDescription, SpotLightDescription,
};
use crate::description::{LightDescription, Rgb};
use crate::error::{SceneError, abbreviate};
use crate::import::importer::Importer;

/// Widest cone. Unit: degree.
const WIDEST: f64 = 89.9;
/// Narrowest cone. Unit: degree.
const NARROWEST: f64 = 0.1;
/// Least distance between a spot's two angles. Unit: degree.
const PENUMBRA: f64 = 0.01;
/// Radius of a light that has none. Unit: m.
const RADIUS: f64 = 0.01;

/// The light at `index` of the file, placed by its node; `None` if the node is scaled to nothing.
pub(super) fn convert(
    document: &Document,
    importer: &mut Importer,
    index: usize,
    location: &str,
    world: &DAffine3,
    luminous_efficacy: f64,
) -> Result<Option<LightDescription>, SceneError> {
    let file = document.file;
    let extensions = document.root.extensions.as_ref();
    let lights = extensions.and_then(|extensions| extensions.khr_lights_punctual.as_ref());
    let lights = lights.map_or(&[][..], |extension| &extension.lights);
    let light = file.element(lights, "lights", index, location)?;
    let place = format!("extensions.KHR_lights_punctual.lights[{index}]");
    let Checked::Valid(kind) = light.type_ else {
        return Err(file.refused(place, "unknown type"));
    };
    let power = power(light, luminous_efficacy)
        .ok_or_else(|| file.refused(&place, "color or intensity is negative or not finite"))?;
    if light.range.is_some() {
        importer.warn(format!("{}: {place}: range left out", file.name));
    }
    let name = light.name.as_ref();
    let name = name.map(|name| abbreviate(name));
    let position = world.translation.to_array();
    let Some(direction) = world.transform_vector3(DVec3::NEG_Z).try_normalize() else {
        importer.warn(format!(
            "{}: {location}: scaled to nothing: light left out",
            file.name
        ));
        return Ok(None);
    };
    Ok(Some(match kind {
        Type::Point => LightDescription::Point(PointLightDescription {
            name,
            position,
            intensity: power,
            radius: RADIUS,
            casts_shadows: true,
            keyframes: Vec::new(),
        }),
        Type::Directional => LightDescription::Directional(DirectionalLightDescription {
            name,
            direction: direction.to_array(),
            irradiance: power,
            casts_shadows: true,
            keyframes: Vec::new(),
        }),
        Type::Spot => {
            let spot = light.spot.clone().unwrap_or_default();
            let given = [spot.inner_cone_angle, spot.outer_cone_angle];
            if given.iter().any(|angle| !angle.is_finite()) {
                return Err(file.refused(place, "a cone angle is not finite"));
            }
            let [inner, outer] = given.map(|angle| f64::from(angle).to_degrees());
            let outer_angle_degrees = outer.clamp(NARROWEST, WIDEST);
            let inner_angle_degrees = inner.clamp(0.0, outer_angle_degrees - PENUMBRA);
            let moved = (inner - inner_angle_degrees).abs() + (outer - outer_angle_degrees).abs();
            // 90° is what exporters write for a half space.
            if moved > 0.2 {
                importer.warn(format!(
                    "{}: {place}: cone angles {inner:.2}° and {outer:.2}° taken as \
                     {inner_angle_degrees:.2}° and {outer_angle_degrees:.2}°",
                    file.name
                ));
            }
            LightDescription::Spot(SpotLightDescription {
                name,
                position,
                direction: direction.to_array(),
                intensity: power,
                inner_angle_degrees,
                outer_angle_degrees,
                radius: RADIUS,
                casts_shadows: true,
                keyframes: Vec::new(),
            })
        }
    }))
}

/// Candela to W/sr, lux to W/m².
fn power(light: &Light, luminous_efficacy: f64) -> Option<Rgb> {
    let radiant = f64::from(light.intensity) / luminous_efficacy;
    let power = light.color.map(|channel| f64::from(channel) * radiant);
    let fine = |power: &f64| power.is_finite() && *power >= 0.0;
    power.iter().all(fine).then_some(Rgb(power))
}
