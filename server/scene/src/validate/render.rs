//! Rules of the render settings.

use super::rules;
use crate::description::RenderDescription;
use crate::description::render::ScreenSpaceSettings;
use crate::error::SceneError;
use crate::json_path::JsonPath;

/// Largest side of a picture. Unit: pixel.
const SIDE: u64 = 16_384;

pub(super) fn check(render: &RenderDescription, path: &JsonPath) -> Result<(), SceneError> {
    rules::whole(&path.field("width"), render.width.into(), 1, SIDE)?;
    rules::whole(&path.field("height"), render.height.into(), 1, SIDE)?;
    rules::whole(&path.field("seed"), render.seed, 0, rules::SEED)?;

    let rules_given = [
        ("samples", render.samples.is_some()),
        ("time_seconds", render.time_seconds.is_some()),
        ("relative_error", render.relative_error.is_some()),
    ];
    let mut given = rules_given.iter().filter(|(_, given)| *given);
    if let (Some((first, _)), Some((second, _))) = (given.next(), given.next()) {
        return Err(SceneError::invalid(
            path.field(second),
            format!("{second} together with {first}"),
            "at most one of samples, time_seconds and relative_error",
        ));
    }
    let counts = [
        ("max_scatterings", render.reference.max_scatterings),
        (
            "max_surface_scatterings",
            render.reference.max_surface_scatterings,
        ),
    ];
    for (name, count) in counts {
        if let Some(count) = count {
            let reference = path.field("reference");
            rules::whole(&reference.field(name), count.into(), 0, 65_535)?;
        }
    }
    if let Some(samples) = render.samples {
        rules::whole(&path.field("samples"), samples.into(), 1, 65_536)?;
    }
    if let Some(seconds) = render.time_seconds {
        rules::range(&path.field("time_seconds"), seconds, 1e-3, 1e6)?;
    }
    if let Some(error) = render.relative_error {
        rules::range(&path.field("relative_error"), error, 1e-5, 1.0)?;
    }

    let steps = render.single_scattering.steps;
    rules::whole(
        &path.field("single_scattering").field("steps"),
        steps.into(),
        1,
        4096,
    )?;
    let side = render.single_scattering.interleave;
    if !matches!(side, 0 | 1 | 2 | 4 | 8) {
        return Err(SceneError::invalid(
            path.field("single_scattering").field("interleave"),
            side.to_string(),
            "0, 1, 2, 4 or 8",
        ));
    }
    screen_space(&render.screen_space, &path.field("screen_space"))?;
    let resolution = render.shadows.resolution;
    rules::whole(
        &path.field("shadows").field("resolution"),
        resolution.into(),
        16,
        8192,
    )
}

fn screen_space(settings: &ScreenSpaceSettings, path: &JsonPath) -> Result<(), SceneError> {
    if !matches!(settings.kernel, 2 | 4 | 6) {
        return Err(SceneError::invalid(
            path.field("kernel"),
            settings.kernel.to_string(),
            "2, 4 or 6",
        ));
    }
    let numbers = [
        ("separation_luminance", settings.separation_luminance, 1e6),
        ("separation_depth", settings.separation_depth, 100.0),
    ];
    for (name, value, most) in numbers {
        rules::range(&path.field(name), value, 0.0, most)?;
    }
    for (index, value) in settings.ambient.into_iter().enumerate() {
        rules::range(&path.field("ambient").index(index), value, 0.0, 1e6)?;
    }
    Ok(())
}
