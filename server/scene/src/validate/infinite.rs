//! Light from infinity through a medium without end never arrives: that is an error in the
//! scene, not a black picture.

use glam::DVec3;

use crate::description::{LightDescription, MediumDescription, Rgb};
use crate::error::SceneError;

/// Smallest sine of a light's elevation above unbounded height fog.
///
/// The optical depth goes as its reciprocal.
const LEAST_SINE: f64 = 1e-3;

/// Checks that a light from infinity crosses finite optical depth through every medium.
pub(crate) fn light_can_arrive(
    light: &LightDescription,
    light_path: &str,
    media: &[MediumDescription],
) -> Result<(), SceneError> {
    let LightDescription::Directional(light) = light else {
        return Ok(());
    };
    if light.irradiance == Rgb::grey(0.0) {
        return Ok(());
    }
    // What falls onto the fog at two keyframes does so on the shortest arc between them.
    let travels: Vec<DVec3> = if light.keyframes.is_empty() {
        vec![DVec3::from_array(light.direction)]
    } else {
        let keys = light.keyframes.iter();
        keys.map(|key| DVec3::from_array(key.direction)).collect()
    };
    for (i, medium) in media.iter().enumerate() {
        if is_vacuum(medium) {
            continue;
        }
        let (why, also) = match medium {
            MediumDescription::Homogeneous(medium) if medium.bounds.is_none() => {
                ("fills all of space", "")
            }
            MediumDescription::HeightFog(fog) if fog.bounds.is_none() => {
                let up = DVec3::from_array(fog.up);
                let sine = |travels: &DVec3| -travels.dot(up) / (travels.length() * up.length());
                if fog.falloff > 0.0 && travels.iter().all(|t| sine(t) >= LEAST_SINE) {
                    continue;
                }
                (
                    "gets no thinner toward the light",
                    ", or a direction that falls onto the fog from above",
                )
            }
            _ => continue,
        };
        return Err(SceneError::invalid(
            light_path,
            format!("a directional light whose optical depth is infinite, since media[{i}] {why}"),
            format!(
                "bounds at media[{i}].bounds, or a light with a position at {light_path}{also}"
            ),
        ));
    }
    Ok(())
}

/// Whether a medium neither scatters nor absorbs.
fn is_vacuum(medium: &MediumDescription) -> bool {
    let coefficients = medium.coefficients();
    let zero = |sigma: Option<Rgb>| sigma.is_none_or(|sigma| sigma == Rgb::grey(0.0));
    coefficients.density_scale == 0.0
        || (zero(coefficients.sigma_s) && zero(coefficients.sigma_a) && zero(coefficients.sigma_t))
}
