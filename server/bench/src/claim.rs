//! What a picture claims to show, and which truth is fair to judge it by.

use serde::Serialize;
use tyndall_render::{Paths, Rung};
use tyndall_scene::description::render::{ReferenceSettings, Technique};

/// Which paths a picture claims to show: the truth that it is fair to judge it by.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Claim {
    /// All of them.
    Whole,
    /// Those of at most one scattering, on a surface or in a medium.
    OneScattering,
}

impl Claim {
    /// What `technique` claims; everything for those that are not rendered yet.
    pub fn of(technique: Technique) -> Self {
        match tyndall_render::claim(technique).map(|claim| claim.paths) {
            Some(Paths::AtMostOneScattering) => Self::OneScattering,
            Some(Paths::Whole) | None => Self::Whole,
        }
    }

    /// What the picture of a setting claims: a corrected one all of the light.
    pub fn of_rung(rung: &Rung) -> Self {
        if rung.corrected {
            Self::Whole
        } else {
            Self::of(rung.technique)
        }
    }

    /// The setting of `reference` that counts the same paths.
    pub fn reference(self) -> ReferenceSettings {
        ReferenceSettings {
            max_scatterings: match self {
                Self::Whole => None,
                Self::OneScattering => Some(1),
            },
            ..ReferenceSettings::default()
        }
    }

    /// For people.
    pub fn label(self) -> &'static str {
        match self {
            Self::Whole => "whole",
            Self::OneScattering => "at most one scattering",
        }
    }
}
