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

/// Records what `work` needs of `plan`.
pub(crate) fn record(
    recording: &mut Recording<'_>,
    plan: &FramePlan,
    parts: &mut ViewParts<'_>,
    work: Work,
    slice: Option<Slice>,
) -> Result<(), RenderError> {
    recording
        .encoder
        .clear_buffer(&parts.inputs.statistics, 0, None);
    for planned in &plan.passes {
        let needed = work == Work::Sample || planned.pass == PassKind::Tonemap;
        if !needed {
            continue;
        }
        if planned.pass == PassKind::ShadowMaps {
            parts
                .shadows
                .record(recording, &parts.assets.geometry, &parts.inputs.instances)?;
            continue;
        }
        let mut bindings = Bindings::default();
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
                if let Some(slice) = slice {
                    reference::record(recording, &bindings, targets, variant, slice.rows)?;
                }
            }
            PassKind::Estimate => image::record_estimate(recording, &bindings, targets)?,
            PassKind::Film => image::record(recording, &bindings, targets, variant)?,
            PassKind::Tonemap => tonemap::record(recording, &bindings, targets, variant)?,
        }
    }
    Ok(())
}
