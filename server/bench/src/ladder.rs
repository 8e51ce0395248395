//! Which settings of which technique are measured, and what each claims to show.

use serde::Serialize;
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
    /// What `technique` claims.
    pub fn of(technique: Technique) -> Self {
        match technique {
            Technique::Auto | Technique::SingleScattering => Self::OneScattering,
            Technique::InstantVpl
            | Technique::PrincipalOrdinates
            | Technique::ScreenSpace
            | Technique::Reference => Self::Whole,
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

/// What pixels take from their neighbours instead of marching it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sharing {
    /// Nothing.
    None,
    /// Strata, in tiles of 4×4.
    Interleaved,
    /// Three of every 2×2 pixels are interpolated.
    HalfResolution,
}

impl Sharing {
    /// Side of the tile of pixels that share the strata of a ray.
    pub fn interleave(self) -> u32 {
        if self == Self::Interleaved { 4 } else { 1 }
    }
}

/// One setting of one technique.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Rung {
    /// What transports the light.
    pub technique: Technique,
    /// March steps a ray, for techniques that march.
    pub steps: Option<u32>,
    /// Samples a pixel.
    pub samples: u32,
    /// Whether traced samples, as many, correct the picture; half of the strata are equiangular then.
    pub corrected: bool,
    /// What pixels share.
    pub sharing: Sharing,
}

impl Rung {
    /// What its picture claims.
    pub fn claim(self) -> Claim {
        if self.corrected {
            Claim::Whole
        } else {
            Claim::of(self.technique)
        }
    }

    /// Name of technique, sharing and correction.
    pub fn name(self) -> String {
        let corrected = if self.corrected { "+correction" } else { "" };
        let sharing = match self.sharing {
            Sharing::None => "",
            Sharing::Interleaved => "+interleaved",
            Sharing::HalfResolution => "+half_resolution",
        };
        format!("{}{sharing}{corrected}", self.technique.name())
    }
}

/// The rungs of `technique`, cheapest first; without any for techniques that are not measured yet.
pub fn ladder(technique: Technique, quick: bool) -> Vec<Rung> {
    let rung = |steps, samples, corrected| Rung {
        technique,
        steps,
        samples,
        corrected,
        sharing: Sharing::None,
    };
    let counts: &[u32] = if quick {
        &[1, 4, 16]
    } else {
        &[1, 4, 16, 64, 256]
    };
    match technique {
        Technique::SingleScattering => {
            let (steps, samples): (&[u32], &[u32]) = if quick {
                (&[8, 32], &[1, 4, 16])
            } else {
                (&[8, 16, 32, 64, 128], &[1, 4, 16, 64])
            };
            let all = steps.iter().copied();
            let own = all.flat_map(|steps| {
                samples
                    .iter()
                    .map(move |samples| rung(Some(steps), *samples, false))
            });
            // As the page does it.
            let corrected = counts.iter().map(|samples| Rung {
                sharing: Sharing::Interleaved,
                ..rung(Some(64), *samples, true)
            });
            let most = *steps.last().unwrap_or(&32);
            let shared = [Sharing::Interleaved, Sharing::HalfResolution];
            let shared = shared.into_iter().flat_map(|sharing| {
                samples.iter().map(move |samples| Rung {
                    sharing,
                    ..rung(Some(most), *samples, false)
                })
            });
            own.chain(shared).chain(corrected).collect()
        }
        Technique::Reference => {
            let own = counts.iter().map(|samples| rung(None, *samples, false));
            let corrected = counts.iter().map(|samples| rung(None, *samples, true));
            own.chain(corrected).collect()
        }
        Technique::Auto
        | Technique::InstantVpl
        | Technique::PrincipalOrdinates
        | Technique::ScreenSpace => Vec::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_full_ladder_spans_8_to_128_steps_and_1_to_64_samples() {
        let rungs = ladder(Technique::SingleScattering, false);
        assert_eq!(rungs.len(), 33);
        assert_eq!((rungs[0].steps, rungs[0].samples), (Some(8), 1));
        assert_eq!((rungs[19].steps, rungs[19].samples), (Some(128), 64));
        assert_eq!(rungs[20].name(), "single_scattering+interleaved");
        assert!(!rungs[27].corrected && rungs[28].corrected);
        assert_eq!(rungs[28].claim(), Claim::Whole);
        let samples: Vec<u32> = ladder(Technique::Reference, false)
            .iter()
            .filter(|rung| !rung.corrected)
            .map(|rung| rung.samples)
            .collect();
        assert_eq!(samples, [1, 4, 16, 64, 256]);
    }
}
