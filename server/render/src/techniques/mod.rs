//! Ways of making a picture: one folder each, none imports another.
//!
//! A technique says what it claims, what it cannot render, which passes it plans (from its own files
//! and from `stages`) and which of its settings the benchmark measures. It is entered in [`of`], the
//! only list of techniques there is in this crate.

mod claim;
pub(crate) mod reference;
mod rung;
mod screen_space;
mod single_scattering;
mod technique;

pub use claim::{Claim, Paths};
pub use rung::Rung;

use technique::Technique;

/// The technique that renders `key`, if there is one yet. `auto` takes the one that is measured best.
pub(crate) fn of(key: tyndall_scene::Technique) -> Option<&'static dyn Technique> {
    use tyndall_scene::Technique as Key;
    match key {
        Key::Auto | Key::SingleScattering => Some(&single_scattering::SingleScattering),
        Key::Reference => Some(&reference::Reference),
        Key::ScreenSpace => Some(&screen_space::ScreenSpace),
        Key::InstantVpl | Key::PrincipalOrdinates => None,
    }
}

/// The technique that renders `technique`: another one only for `auto`.
pub fn chosen(technique: tyndall_scene::Technique) -> tyndall_scene::Technique {
    of(technique).map_or(technique, Technique::key)
}

/// What the picture of `technique` claims to show; nothing for those that are not rendered yet.
pub fn claim(technique: tyndall_scene::Technique) -> Option<Claim> {
    of(technique).map(Technique::claim)
}

/// Settings of `technique` that are worth measuring, cheapest first; none for `auto` and those that
/// are not rendered yet.
pub fn ladder(technique: tyndall_scene::Technique, quick: bool) -> Vec<Rung> {
    of(technique)
        .filter(|found| found.key() == technique)
        .map_or_else(Vec::new, |found| found.ladder(quick))
}
