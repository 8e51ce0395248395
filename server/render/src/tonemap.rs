//! Exposure, filmic curve and 8-bit encoding: the only lossy colour step.

use crate::engine::Recording;
use crate::error::RenderError;
use crate::programs::Bindings;
use crate::targets::Targets;

/// Factor on radiance for an exposure value.
pub(crate) fn exposure_scale(exposure_ev: f32) -> f32 {
    exposure_ev.exp2()
}

/// Records the tonemap pass.
pub(crate) fn record(
    recording: &mut Recording<'_>,
    bindings: &Bindings<'_>,
    targets: &Targets,
    variant: &str,
) -> Result<(), RenderError> {
    recording.compute("tonemap", variant, bindings, targets.width, targets.height)
}
