//! What a scene may ask for that is not rendered yet: refused by name, never ignored.

use tyndall_scene::{CorrectionMode, Scene, StopRule};

use crate::error::NotRenderedYet;
use crate::techniques;

/// Refuses what no pass renders.
pub fn check_supported(scene: &Scene) -> Result<(), NotRenderedYet> {
    let Some(technique) = techniques::of(scene.render.technique) else {
        return Err(NotRenderedYet::technique(scene.render.technique));
    };
    let mut fields: Vec<String> = Vec::new();
    let corrected = scene.render.correction != CorrectionMode::Off;
    let judged = matches!(scene.render.stop, StopRule::RelativeError(_));
    if judged && !technique.is_traced() && !corrected {
        fields
            .push("render.relative_error: without correction, whose samples tell the error".into());
    }
    fields.extend(technique.unsupported(scene));
    if fields.is_empty() {
        Ok(())
    } else {
        Err(NotRenderedYet { fields })
    }
}
