//! Light scattered exactly once in the media, by marching the camera ray.
//!
//! Source: Tóth and Umenhoffer 2009, with the corrections of `wesl/techniques/single_scattering/march.wesl`.
//! Transports order 1 of the partition from point, spot and directional lights, and the media's own
//! emission. Bias: none with jitter in analytic media (unbiased in the ray parameter); without it the
//! midpoint rule's, second order in the step. Density grids add the trapezoid rule of their optical
//! depth and the spacing of the light volume, both second order; interleaving adds what is left of
//! its window's blur, of the fourth order but at edges; half resolution what is left of a parabola
//! between marched pixels, of the fourth order but at edges; shadow maps their resolution's. Cost: steps ×
//! lights × media a pixel, a M²-th of it interleaved, a quarter at half resolution.

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
    let (width, height) = marched_size(recording, targets);
    recording.compute(
        "single_scattering",
        variant,
        bindings,
        width.next_multiple_of(block),
        height.next_multiple_of(block),
    )
}

/// Pixels that are marched: see `low_resolution/coarse_grid.wesl`.
fn marched_size(recording: &Recording<'_>, targets: &Targets) -> (u32, u32) {
    let spacing = recording.constants.spacing.max(1);
    (
        targets.width.div_ceil(spacing),
        targets.height.div_ceil(spacing),
    )
}

/// Records the gathering of interleaved strata and the filling in of pixels that were not marched, and
/// the march of those that neither restores with permutation `listed`.
pub(crate) fn record_gather(
    recording: &mut Recording<'_>,
    bindings: &Bindings<'_>,
    targets: &Targets,
    listed: &str,
) -> Result<(), RenderError> {
    let Some(shared) = &targets.shared_march else {
        return Ok(());
    };
    shared.empty_list(&mut recording.encoder);
    if recording.constants.interleave > 1 {
        let (width, height) = marched_size(recording, targets);
        recording.compute("gather", "gather+rows", bindings, width, height)?;
        recording.compute("gather", "gather+columns", bindings, width, height)?;
    }
    let restoring = match (recording.constants.spacing > 1, listed.contains("+grids")) {
        (false, _) => "gather+reject",
        (true, false) => "gather+spread",
        (true, true) => "gather+spread+grids",
    };
    recording.compute("gather", restoring, bindings, targets.width, targets.height)?;
    recording.compute_indirect("rejected_pixels", listed, bindings, &shared.rejected_pixels)
}
