//! What a scene may ask for that is not rendered yet: refused by name, never ignored.

use tyndall_scene::Scene;
use tyndall_scene::{CorrectionMode, ShadowMode, StopRule, Technique};

/// The fields of a scene that are valid but not rendered yet.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("not rendered yet: {}", fields.join("; "))]
pub struct NotRenderedYet {
    /// JSON paths with a remark each.
    pub fields: Vec<String>,
}

/// Refuses what no pass renders.
pub fn check_supported(scene: &Scene) -> Result<(), NotRenderedYet> {
    let mut fields: Vec<String> = Vec::new();
    match scene.render.technique {
        Technique::Auto | Technique::SingleScattering | Technique::Reference => {}
        missing @ (Technique::InstantVpl
        | Technique::PrincipalOrdinates
        | Technique::ScreenSpace) => {
            fields.push(format!("render.technique: {}", missing.name()));
        }
    }
    let traced = scene.render.technique == Technique::Reference;
    let corrected = scene.render.correction != CorrectionMode::Off;
    if matches!(scene.render.stop, StopRule::RelativeError(_)) && !traced && !corrected {
        fields
            .push("render.relative_error: without correction, whose samples tell the error".into());
    }
    let masked = scene
        .geometry
        .materials
        .iter()
        .any(|m| m.alpha_cutoff.is_some());
    if masked && !traced && scene.render.shadows.mode == ShadowMode::Traced {
        fields.push("render.shadows.mode: traced, with alpha-masked materials".into());
    }
    if fields.is_empty() {
        Ok(())
    } else {
        Err(NotRenderedYet { fields })
    }
}

/// What a scene asks for that is rendered in a simpler form: said aloud, never ignored.
pub fn approximations(scene: &Scene) -> Vec<String> {
    let materials = &scene.geometry.materials;
    let normal_mapped = materials
        .iter()
        .filter(|m| m.normal_texture.is_some())
        .count();
    let glossy = materials
        .iter()
        .filter(|m| m.metallic > 0.0 || m.roughness < 1.0 || m.metallic_roughness_texture.is_some())
        .count();
    let mut found = Vec::new();
    if scene.render.technique == Technique::Reference {
        return found;
    }
    if normal_mapped > 0 {
        found.push(format!(
            "{normal_mapped} materials have normal maps, which are not rendered yet"
        ));
    }
    if glossy > 0 {
        found.push(format!(
            "{glossy} materials are metallic or glossy and are shaded as Lambertian for now"
        ));
    }
    found
}
