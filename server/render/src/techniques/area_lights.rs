//! Light of emissive triangles and of the environment, scattered exactly once toward the eye.
//!
//! Source: directions uniform over the solid angle of an emissive triangle (Arvo 1995; Peters 2021), the
//! best of several by what they would bring (Talbot et al. 2005), equiangular distances (Kulla and
//! Fajardo 2012), collisions and ratio tracking in grids (Woodcock 1965; Novák et al. 2014), joined by
//! the balance heuristic (Veach and Guibas 1995).
//! Transports the part of orders 0 and 1 of the partition that `surfaces` and `single_scattering` leave
//! out: area lights on Lambertian surfaces and in the media. Bias: none; every frame is a sample of the
//! running mean. Cost: a shadow ray for each of the strata a kind of light and medium, half as many
//! where media without grids scatter emitters' light, and up to three on the surface.

use crate::engine::Recording;
use crate::error::RenderError;
use crate::programs::Bindings;
use crate::targets::Targets;

/// Records one sample a pixel of each kind.
pub(crate) fn record(
    recording: &mut Recording<'_>,
    bindings: &Bindings<'_>,
    targets: &Targets,
    variant: &str,
) -> Result<(), RenderError> {
    recording.compute(
        "area_lights",
        variant,
        bindings,
        targets.width,
        targets.height,
    )
}
