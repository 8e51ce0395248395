//! Light scattered exactly once in the media, by marching the camera ray.
//!
//! Source: Tóth and Umenhoffer 2009, with the corrections of `wesl/techniques/single_scattering/march.wesl`.
//! Transports order 1 of the partition from point, spot and directional lights, and the media's own
//! emission. Bias: none with jitter in analytic media (unbiased in the ray parameter); without it the
//! midpoint rule's, second order in the step. Density grids add the trapezoid rule of their optical
//! depth and the spacing of the light volume, both second order; interleaving adds what is left of
//! its window's blur, of the fourth order but at edges; shadow maps their resolution's. Cost: steps ×
//! lights × media a pixel, a M²-th of it interleaved.

mod light_volume;

pub(crate) use light_volume::LightVolume;

use crate::engine::Recording;
use crate::error::RenderError;
use crate::programs::Bindings;
use crate::targets::Targets;

/// Records the march.
pub(crate) fn record(
    recording: &mut Recording<'_>,
    bindings: &Bindings<'_>,
    targets: &Targets,
    variant: &str,
) -> Result<(), RenderError> {
    // Groups of the same rank fill blocks of 8 tiles a side: see `interleave.wesl`.
    let block = 8 * recording.constants.interleave.max(1);
    recording.compute(
        "single_scattering",
        variant,
        bindings,
        targets.width.next_multiple_of(block),
        targets.height.next_multiple_of(block),
    )
}

/// Records the gathering of interleaved strata, and the march of the pixels that it rejects with
/// permutation `listed`.
pub(crate) fn record_gather(
    recording: &mut Recording<'_>,
    bindings: &Bindings<'_>,
    targets: &Targets,
    listed: &str,
) -> Result<(), RenderError> {
    let Some(interleaved) = &targets.interleaved else {
        return Ok(());
    };
    let (width, height) = (targets.width, targets.height);
    interleaved.empty_list(&mut recording.encoder);
    recording.compute("gather", "gather+rows", bindings, width, height)?;
    recording.compute("gather", "gather+columns", bindings, width, height)?;
    recording.compute("gather", "gather+reject", bindings, width, height)?;
    recording.compute_indirect(
        "rejected_pixels",
        listed,
        bindings,
        &interleaved.rejected_pixels,
    )
}
