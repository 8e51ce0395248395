//! Which settings of which technique are measured, and what each claims to show.

use serde::Serialize;
use tyndall_scene::description::render::{Reference, Technique};

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
    pub fn reference(self) -> Reference {
        Reference {
            max_scatterings: match self {
                Self::Whole => None,
                Self::OneScattering => Some(1),
            },
            ..Reference::default()
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

/// One setting of one technique.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Rung {
    /// What transports the light.
    pub technique: Technique,
    /// March steps a ray, for techniques that march.
    pub steps: Option<u32>,
    /// Samples a pixel.
    pub samples: u32,
}

/// The rungs of `technique`, cheapest first; without any for techniques that are not measured yet.
pub fn ladder(technique: Technique, quick: bool) -> Vec<Rung> {
    let rung = |steps, samples| Rung {
        technique,
        steps,
        samples,
    };
    match technique {
        Technique::SingleScattering => {
            let (steps, samples): (&[u32], &[u32]) = if quick {
                (&[8, 32], &[1, 4, 16])
            } else {
                (&[8, 16, 32, 64, 128], &[1, 4, 16, 64])
            };
            let all = steps.iter().copied();
            all.flat_map(|steps| {
                samples
                    .iter()
                    .map(move |samples| rung(Some(steps), *samples))
            })
            .collect()
        }
        Technique::Reference => {
            let samples: &[u32] = if quick {
                &[1, 4, 16]
            } else {
                &[1, 4, 16, 64, 256]
            };
            samples.iter().map(|samples| rung(None, *samples)).collect()
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
        assert_eq!(rungs.len(), 20);
        assert_eq!((rungs[0].steps, rungs[0].samples), (Some(8), 1));
        assert_eq!((rungs[19].steps, rungs[19].samples), (Some(128), 64));
        let samples: Vec<u32> = ladder(Technique::Reference, false)
            .iter()
            .map(|rung| rung.samples)
            .collect();
        assert_eq!(samples, [1, 4, 16, 64, 256]);
    }
}
