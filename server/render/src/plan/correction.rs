//! Whether traced samples correct the technique's picture.

use tyndall_scene::{CorrectionMode, RenderSettings, SceneFacts, StopRule};

use super::{FramePlan, PassKind, PlanLimits};

/// Why nothing is corrected, if so.
pub(super) fn without_correction(
    facts: &SceneFacts,
    settings: &RenderSettings,
    limits: PlanLimits,
) -> Option<&'static str> {
    // An error that is to be reached must be known.
    let judged = matches!(settings.stop, StopRule::RelativeError(_));
    if settings.correction == CorrectionMode::Off {
        Some("off")
    } else if limits.loop_cap.is_some() {
        Some("this driver cuts long loops short, and paths with them")
    } else if limits.beyond_correction {
        Some("the picture is larger than this device's largest buffer of residuals")
    } else if facts.triangles == 0 && !facts.scatters && !judged {
        Some("nothing scatters: the picture is exact")
    } else {
        None
    }
}

/// Plans the correction of a technique's picture, or of a black one.
pub(super) fn plan_correction(
    plan: &mut FramePlan,
    facts: &SceneFacts,
    settings: &RenderSettings,
    base: bool,
) {
    let (variant, what) = if base {
        (
            "correction+base",
            "traced samples less the technique's picture, band by band",
        )
    } else {
        (
            "correction",
            "bands of the traced picture that are above its noise",
        )
    };
    let mut variant = String::from(variant);
    // Without a technique there is no depth that residuals could be carried along with.
    if base && settings.correction == CorrectionMode::Always {
        variant.push_str("+history");
        if facts.grids > 0 {
            variant.push_str("+grids");
        }
    }
    plan.run(PassKind::Correction, &variant, what);
    plan.run(
        PassKind::Estimate,
        "estimate+tiles+corrected",
        "error that the correction expects",
    );
}

/// Plans neither paths nor their correction.
pub(super) fn plan_no_correction(plan: &mut FramePlan, why: &str) {
    plan.skip(PassKind::Reference, "", "no correction");
    plan.skip(PassKind::Correction, "", why);
    plan.skip(
        PassKind::Estimate,
        "",
        "the technique does not know its error",
    );
}
