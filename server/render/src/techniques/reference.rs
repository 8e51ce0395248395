//! The unbiased reference: volumetric path tracing.
//!
//! Transports everything, or the orders that `render.reference` asks for. Free flight is analytic in
//! homogeneous media, height fog and spheres and by null collisions with majorants over coarse cells
//! in density grids (Woodcock 1965; Novák et al. 2014 for transmittance); chromatic coefficients use
//! throughput-aware spectral probabilities (Kutz et al. 2017). Light scattered once more is gathered
//! along whole segments: equiangular and free-flight distances to every source share one resampled
//! candidate (Kulla and Fajardo 2012; Talbot et al. 2005). Emissive triangles and environment maps are
//! also found by scattering, by the balance heuristic. Bias: none. Cost: paths until they leave or
//! the roulette ends them.

use crate::engine::Recording;
use crate::error::RenderError;
use crate::programs::Bindings;

/// Records one slice, of `columns` × `rows` pixels.
pub(crate) fn record(
    recording: &mut Recording<'_>,
    bindings: &Bindings<'_>,
    variant: &str,
    [columns, rows]: [u32; 2],
) -> Result<(), RenderError> {
    recording.compute("reference", variant, bindings, columns, rows)
}
