//! Light scattered exactly once in the media, by marching the camera ray.
//!
//! Source: Tóth and Umenhoffer 2009, with the corrections of `wesl/techniques/single_scattering/march.wesl`.
//! Transports order 1 of the partition from point, spot and directional lights, and the media's own
//! emission. Bias: none with jitter (unbiased in the ray parameter); without it the midpoint rule's,
//! second order in the step. Shadow maps add their resolution's. Cost: steps × lights × media a pixel.

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
    recording.compute(
        "single_scattering",
        variant,
        bindings,
        targets.width,
        targets.height,
    )
}
