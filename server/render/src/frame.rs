//! Table of contents of a frame: the passes of the plan, in order.

use crate::engine::Recording;
use crate::error::RenderError;
use crate::image::{self, Work};
use crate::plan::{FramePlan, PassKind};
use crate::programs::Bindings;
use crate::slices::Slice;
use crate::techniques::{area_lights, reference, single_scattering, surfaces};
use crate::tonemap;
use crate::view::ViewParts;

/// What of the plan a frame does.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Share {
    /// A sample of the technique.
    pub base: bool,
    /// Index of its place in its pixel, and in its strata.
    pub place: u32,
    /// A slice of the reference.
    pub slice: Option<Slice>,
    /// Samples of a pixel once it is done, of the first one also its part.
    pub done: f32,
    /// The correction, and the estimate of the error.
    pub estimated: bool,
    /// Whether what was traced before is forgotten.
    pub restarts: bool,
}

impl Share {
    fn needs(self, pass: PassKind, work: Work) -> bool {
        match pass {
            PassKind::Tonemap => true,
            PassKind::Correction | PassKind::Estimate => self.estimated,
            PassKind::Reference => work == Work::Sample && self.slice.is_some(),
            _ => work == Work::Sample && self.base,
        }
    }
}

/// The film that a pass adds to, where the picture is not that film.
fn bind_film<'a>(bindings: &mut Bindings<'a>, pass: PassKind, parts: &'a ViewParts<'_>) {
    let (Some(correction), Some(reference)) = (&parts.targets.correction, &parts.targets.reference)
    else {
        return;
    };
    match pass {
        PassKind::Film => bindings.buffer("film", &correction.base_film),
        PassKind::Reference => bindings.buffer("film", reference.film(parts.targets)),
        _ => return,
    };
}

/// Records what `work` needs of `plan`.
pub(crate) fn record(
    recording: &mut Recording<'_>,
    plan: &FramePlan,
    parts: &mut ViewParts<'_>,
    work: Work,
    share: Share,
) -> Result<(), RenderError> {
    recording
        .encoder
        .clear_buffer(&parts.inputs.statistics, 0, None);
    if let (true, Some(reference)) = (share.restarts, &parts.targets.reference) {
        reference.clear(&mut recording.encoder);
    }
    if let (true, Some(correction)) = (share.restarts, &parts.targets.correction) {
        correction.carry(&mut recording.encoder);
    }
    for planned in &plan.passes {
        if !share.needs(planned.pass, work) {
            continue;
        }
        if planned.pass == PassKind::ShadowMaps {
            parts
                .shadows
                .record(recording, &parts.assets.geometry, &parts.inputs.instances)?;
            continue;
        }
        let mut bindings = Bindings::default();
        bind_film(&mut bindings, planned.pass, parts);
        parts.bind(&mut bindings);
        let (targets, variant) = (parts.targets, planned.variant.as_str());
        match planned.pass {
            PassKind::LightVolume => {
                if let Some(volume) = parts.light_volume {
                    volume.record(recording, &bindings)?;
                }
            }
            PassKind::Gather => {
                single_scattering::record_gather(recording, &bindings, targets, variant)?;
            }
            // Built when the view took the geometry.
            PassKind::Bvh | PassKind::ShadowMaps => {}
            PassKind::Gbuffer => {
                surfaces::record_gbuffer(
                    recording,
                    &bindings,
                    targets,
                    &parts.assets.geometry,
                    variant,
                )?;
            }
            PassKind::Shade => surfaces::record_shade(recording, &bindings, targets, variant)?,
            PassKind::SingleScattering => {
                single_scattering::record(recording, &bindings, targets, variant)?;
            }
            PassKind::AreaLights => area_lights::record(recording, &bindings, targets, variant)?,
            PassKind::Reference => {
                if let Some(slice) = share.slice {
                    let size = slice.invocations(targets.width);
                    reference::record(recording, &bindings, variant, size)?;
                }
            }
            PassKind::Correction => {
                if let Some(correction) = &targets.correction {
                    let variant = (variant, share.restarts);
                    correction.record(recording, variant, &|bindings| parts.bind(bindings))?;
                }
            }
            PassKind::Estimate => image::record_estimate(recording, &bindings, targets, variant)?,
            PassKind::Film => image::record(recording, &bindings, targets, variant)?,
            PassKind::Tonemap => tonemap::record(recording, &bindings, targets, variant)?,
        }
    }
    Ok(())
}
