//! What the camera sees: the G-buffer by rasterization, and its direct light.
//!
//! Transports order 0 of the partition: emission and direct light of Lambertian surfaces, attenuated
//! along both legs through the sum of all analytic media (closed forms). Bias: shadow maps only.

use crate::engine::{Attachments, RasterDraw, Recording};
use crate::error::RenderError;
use crate::gpu_scene::{DrawClass, GpuGeometry};
use crate::programs::{Bindings, RasterTargets};
use crate::targets::{GBUFFER_FORMATS, Targets};

/// Records the G-buffer; `variant` is the part of the permutation's name that the plan decides.
pub(crate) fn record_gbuffer(
    recording: &mut Recording<'_>,
    bindings: &Bindings<'_>,
    targets: &Targets,
    geometry: &GpuGeometry,
    variant: &str,
) -> Result<(), RenderError> {
    let Some(targets) = &targets.surfaces else {
        return Ok(());
    };
    let mut colors = vec![&targets.base_color, &targets.normal];
    colors.extend(&targets.emission);
    let draws: Vec<_> = geometry
        .draws
        .iter()
        .map(|draw| RasterDraw {
            variant: match draw.class {
                DrawClass::Opaque => format!("gbuffer{variant}"),
                DrawClass::SingleSided | DrawClass::Masked => {
                    format!("gbuffer+discarding{variant}")
                }
            },
            draw,
        })
        .collect();
    recording.raster(
        "gbuffer",
        &Attachments {
            colors: &colors,
            depth: &targets.depth,
        },
        &RasterTargets {
            colors: &GBUFFER_FORMATS[..colors.len()],
            depth_bias: wgpu::DepthBiasState::default(),
        },
        geometry,
        bindings,
        &draws,
    )
}

/// Records the direct light.
pub(crate) fn record_shade(
    recording: &mut Recording<'_>,
    bindings: &Bindings<'_>,
    targets: &Targets,
    variant: &str,
) -> Result<(), RenderError> {
    recording.compute("shade", variant, bindings, targets.width, targets.height)
}
