//! Scenes in the binary: the shop window.
//!
//! Made of the format's own kinds, so that each can be written out, changed and read again. Sizes
//! are metres, intensities those of lamps and a low sun, exposures chosen for a mid-grey near
//! 0.18 · 2^−EV.

mod builder;
mod cloud;
mod fogged_hall;
mod light_shafts;
mod smoke_plume;
mod street_night;
mod swinging_lamp;

use crate::description::SceneDescription;

/// What a list of presets shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
pub struct PresetInfo {
    /// Identifier in URLs and on the command line.
    pub name: &'static str,
    /// For people.
    pub title: &'static str,
    /// One sentence.
    pub summary: &'static str,
}

/// The preset that is shown when nothing else is asked for.
pub const DEFAULT: &str = "fogged_hall";

const PRESETS: &[PresetInfo] = &[
    PresetInfo {
        name: DEFAULT,
        title: "Fogged hall",
        summary: "A pillared hall full of fog; a low sun throws shafts through its windows, and \
                  lanterns glow between the arches.",
    },
    PresetInfo {
        name: "light_shafts",
        title: "Light shafts",
        summary: "A dusty barn under a slatted roof: one sun, many thin sheets of light.",
    },
    PresetInfo {
        name: "cornell_fog",
        title: "Cornell box with fog",
        summary: "The classic box with two blocks, filled with homogeneous fog.",
    },
    PresetInfo {
        name: "street_night",
        title: "Street at night",
        summary: "Street lamps and lit windows in fog that thins out with height.",
    },
    PresetInfo {
        name: "swinging_lamp",
        title: "Swinging lamp",
        summary: "A lamp swings through a foggy workshop, a fan turns, a crate slides by: only \
                  shadow maps that see a motion are rendered again.",
    },
    PresetInfo {
        name: "smoke_plume",
        title: "Smoke plume",
        summary: "Smoke rolls out of a chimney into a low sun: a voxel grid made from noise.",
    },
    PresetInfo {
        name: "cloud",
        title: "Cloud",
        summary: "A cumulus over fields: dense, almost without absorption, strongly forward.",
    },
];

/// All presets, the default first.
pub fn names() -> &'static [PresetInfo] {
    PRESETS
}

/// The description of a preset; `None` if there is none of that name.
pub fn description(name: &str) -> Option<SceneDescription> {
    match name {
        "fogged_hall" => Some(fogged_hall::description()),
        "light_shafts" => Some(light_shafts::description()),
        // A test parses it: it is always there.
        "cornell_fog" => SceneDescription::from_json(include_str!("cornell_fog.json")).ok(),
        "street_night" => Some(street_night::description()),
        "swinging_lamp" => Some(swinging_lamp::description()),
        "smoke_plume" => Some(smoke_plume::description()),
        "cloud" => Some(cloud::description()),
        _ => None,
    }
}
