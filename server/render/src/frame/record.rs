//! Records a frame: the passes of the plan that it includes, in order.

use super::parts::Parts;
use super::pass::PlannedPass;
use super::plan::FramePlan;
use crate::engine::{AccessKind, Life, Recording};
use crate::error::RenderError;

/// Records what the frame's share includes of `plan`.
pub(crate) fn record(
    recording: &mut Recording<'_>,
    plan: &FramePlan,
    parts: &Parts<'_>,
) -> Result<(), RenderError> {
    recording
        .encoder
        .clear_buffer(&parts.inputs.statistics, 0, None);
    for planned in &plan.passes {
        planned.recorder.begin(planned, recording, parts)?;
    }
    let mut written = Vec::new();
    for planned in &plan.passes {
        if parts.share.includes(planned.when) {
            note_written(planned, &mut written)?;
            planned.recorder.record(planned, recording, parts)?;
        }
    }
    Ok(())
}

/// Refuses a pass that reads what lives for a frame and nothing of this frame wrote: another view's
/// values may be in it.
fn note_written(planned: &PlannedPass, written: &mut Vec<&'static str>) -> Result<(), RenderError> {
    let writes = planned.accesses.iter().filter(|a| a.kind.writes());
    written.extend(writes.map(|access| access.resource.name));
    let unwritten = planned.accesses.iter().find(|access| {
        access.resource.life == Life::Frame
            && access.kind != AccessKind::ReadWhenWritten
            && !written.contains(&access.resource.name)
    });
    match unwritten {
        None => Ok(()),
        Some(access) => Err(RenderError::Shader {
            shader: planned.pass.name().to_owned(),
            what: format!("nothing in this frame wrote {}", access.resource.name),
        }),
    }
}
