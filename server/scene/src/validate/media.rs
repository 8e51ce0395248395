//! Rules of media.

use glam::{DAffine3, DVec3};
use tyndall_volume::{ENDINGS, Grid, Procedural};

use super::{phase, rules};
use crate::description::MediumDescription;
use crate::description::media::Coefficients;
use crate::description::{Bounds, Rgb, Transform};
use crate::error::SceneError;
use crate::json_path::JsonPath;
use crate::scene::{box_corners, is_invertible};

/// Largest coefficient. Unit: m⁻¹.
const SIGMA: f64 = 1e6;
/// Largest density scale.
const DENSITY: f64 = 1e6;
/// Largest falloff. Unit: m⁻¹.
const FALLOFF: f64 = 1e3;
/// Largest exponent of height fog inside its bounds or at the camera; e⁶⁰ · σ stays finite.
const EXPONENT: f64 = 60.0;

pub(super) fn check(medium: &MediumDescription, path: &JsonPath) -> Result<(), SceneError> {
    coefficients(&medium.coefficients(), path)?;
    match medium {
        MediumDescription::Homogeneous(medium) => match &medium.bounds {
            Some(bounds) => rules::bounds(&path.field("bounds"), bounds),
            None => Ok(()),
        },
        MediumDescription::HeightFog(medium) => {
            rules::direction(&path.field("up"), &medium.up)?;
            let falloff = path.field("falloff");
            rules::range(&falloff, medium.falloff, 0.0, FALLOFF)?;
            rules::position(&path.field("origin"), &medium.origin)?;
            let Some(bounds) = &medium.bounds else {
                return Ok(());
            };
            rules::bounds(&path.field("bounds"), bounds)?;
            let exponent = highest_exponent(medium.up, medium.falloff, medium.origin, bounds);
            if exponent > EXPONENT {
                let most = medium.falloff * EXPONENT / exponent;
                return Err(SceneError::invalid(
                    falloff,
                    format!(
                        "{}, which makes the density e^{exponent:.0} at the lowest corner",
                        rules::found(medium.falloff)
                    ),
                    format!(
                        "at most {most:.4} in these bounds (density at most e^{EXPONENT}), or a \
                         lower origin"
                    ),
                ));
            }
            Ok(())
        }
        MediumDescription::Sphere(medium) => {
            rules::position(&path.field("center"), &medium.center)?;
            rules::range(&path.field("radius"), medium.radius, 1e-6, 1e6)
        }
        MediumDescription::Grid(medium) => {
            rules::file(&path.field("path"), &medium.path, &ENDINGS)?;
            if let Some(name) = &medium.grid {
                rules::name(&path.field("grid"), name)?;
            }
            optional_transform(path, medium.transform.as_ref())
        }
        MediumDescription::Procedural(medium) => {
            rules::whole(&path.field("seed"), medium.seed, 0, rules::SEED)?;
            let within = |name, value: u32, range: std::ops::RangeInclusive<u32>| {
                let (low, high) = (u64::from(*range.start()), u64::from(*range.end()));
                rules::whole(&path.field(name), u64::from(value), low, high)
            };
            within("resolution", medium.resolution, Procedural::RESOLUTION)?;
            within("octaves", medium.octaves, Procedural::OCTAVES)?;
            optional_transform(path, medium.transform.as_ref())
        }
    }
}

fn optional_transform(path: &JsonPath, transform: Option<&Transform>) -> Result<(), SceneError> {
    transform.map_or(Ok(()), |transform| {
        rules::transform(&path.field("transform"), transform)
    })
}

/// Rules of a medium that depend on what its grid holds and where the file places it.
pub(crate) fn placed_grid(
    medium: &MediumDescription,
    path: &JsonPath,
    grid: &Grid,
    world_from_lattice: &DAffine3,
) -> Result<(), SceneError> {
    let corners = box_corners(grid.clip[0], grid.clip[1])
        .map(|corner| world_from_lattice.transform_point3(corner));
    let near = |corner: &DVec3| corner.abs().max_element() <= rules::COORDINATE;
    if !is_invertible(world_from_lattice) || !corners.iter().all(near) {
        return Err(SceneError::invalid(
            path.field("transform"),
            "a grid that is flattened, or reaches beyond the coordinates",
            format!(
                "an invertible placement within ±{} m",
                rules::shown(rules::COORDINATE)
            ),
        ));
    }
    let coefficients = medium.coefficients();
    let most = f64::from(grid.max());
    let highest = |given: &[Option<Rgb>]| {
        let sum = (0..3).map(|c| given.iter().flatten().map(|Rgb(rgb)| rgb[c]).sum());
        sum.fold(0.0, f64::max)
    };
    let sigma_t = match coefficients.sigma_t {
        Some(sigma_t) => highest(&[Some(sigma_t)]),
        None => highest(&[coefficients.sigma_s, coefficients.sigma_a]),
    };
    for (what, unit, value, limit) in [
        ("extinction", "m⁻¹", sigma_t, SIGMA),
        (
            "emission",
            "W·m⁻³·sr⁻¹",
            highest(&[Some(coefficients.emission)]),
            rules::RADIANCE,
        ),
    ] {
        let densest = value * most;
        if densest * coefficients.density_scale > limit {
            return Err(SceneError::invalid(
                path.field("density_scale"),
                format!(
                    "{}, which makes the {what} {:.3e} {unit} at the largest voxel, {most:e}",
                    rules::found(coefficients.density_scale),
                    densest * coefficients.density_scale
                ),
                format!("at most {:e}, for {}", limit / densest, rules::shown(limit)),
            ));
        }
    }
    Ok(())
}

/// One of the two pairs, whole and in range.
fn coefficients(medium: &Coefficients, path: &JsonPath) -> Result<(), SceneError> {
    const EITHER: &str = "sigma_s and sigma_a, or sigma_t and albedo";
    rules::optional_name(path, medium.name)?;
    let given = [
        ("sigma_s", medium.sigma_s, SIGMA),
        ("sigma_a", medium.sigma_a, SIGMA),
        ("sigma_t", medium.sigma_t, SIGMA),
        ("albedo", medium.albedo, 1.0),
    ];
    match given.map(|(_, value, _)| value.is_some()) {
        [true, true, false, false] | [false, false, true, true] => {}
        [false, false, false, false] => {
            return Err(SceneError::invalid(path, "no coefficients", EITHER));
        }
        _ => {
            let mut names = Vec::new();
            for (name, value, _) in &given {
                if value.is_some() {
                    names.push(*name);
                }
            }
            return Err(SceneError::invalid(path, names.join(" and "), EITHER));
        }
    }
    for (name, value, high) in &given {
        if let Some(value) = value {
            rules::rgb(&path.field(name), value, 0.0, *high)?;
        }
    }
    rules::range(&path.field("g"), medium.g, -phase::G, phase::G)?;
    if let Some(function) = medium.phase {
        if medium.g != 0.0 {
            let found = format!("{} beside phase", rules::found(medium.g));
            return Err(SceneError::invalid(path.field("g"), found, "g or phase"));
        }
        phase::check(function, &path.field("phase"))?;
    }
    rules::rgb(
        &path.field("emission"),
        &medium.emission,
        0.0,
        rules::RADIANCE,
    )?;
    let scale = path.field("density_scale");
    rules::range(&scale, medium.density_scale, 0.0, DENSITY)
}

/// Exponent of the density at the corner of `bounds` where the fog is thickest.
fn highest_exponent(up: [f64; 3], falloff: f64, origin: [f64; 3], bounds: &Bounds) -> f64 {
    let up = DVec3::from_array(up);
    let up = up / up.length();
    let lowest: f64 = (0..3)
        .map(|i| {
            let (low, high) = (bounds.min[i] - origin[i], bounds.max[i] - origin[i]);
            (low * up[i]).min(high * up[i])
        })
        .sum();
    -falloff * lowest
}
