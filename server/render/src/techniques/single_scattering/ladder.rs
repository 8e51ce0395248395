//! Settings of the march that the benchmark measures.

use tyndall_scene::{RenderSettings, Technique};

use crate::techniques::Rung;

/// Strata of 4×4 pixels are shared.
const INTERLEAVED: &str = "+interleaved";
/// Three of every 2×2 pixels are interpolated.
const HALF_RESOLUTION: &str = "+half_resolution";

/// Steps × samples; then the finest steps shared among pixels; then corrected, as the page does it.
pub(super) fn rungs(quick: bool) -> Vec<Rung> {
    let (steps, samples, corrected): (&[u32], &[u32], &[u32]) = if quick {
        (&[8, 32], &[1, 4, 16], &[1, 4, 16])
    } else {
        (&[8, 16, 32, 64, 128], &[1, 4, 16, 64], &[1, 4, 16, 64, 256])
    };
    let rung = |variant, steps, samples, corrected| Rung {
        technique: Technique::SingleScattering,
        variant,
        steps: Some(steps),
        samples,
        corrected,
        configure,
    };
    let most = *steps.last().unwrap_or(&32);
    let mut rungs = Vec::new();
    for &steps in steps {
        rungs.extend(samples.iter().map(|n| rung("", steps, *n, false)));
    }
    for variant in [INTERLEAVED, HALF_RESOLUTION] {
        rungs.extend(samples.iter().map(|n| rung(variant, most, *n, false)));
    }
    rungs.extend(corrected.iter().map(|n| rung(INTERLEAVED, 64, *n, true)));
    rungs
}

fn configure(render: &mut RenderSettings, rung: &Rung) {
    let own = &mut render.single_scattering;
    own.steps = rung.steps.unwrap_or(own.steps);
    own.interleave = if rung.variant == INTERLEAVED { 4 } else { 1 };
    own.equiangular |= rung.corrected;
    own.half_resolution = rung.variant == HALF_RESOLUTION;
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_full_ladder_spans_8_to_128_steps_and_1_to_64_samples() {
        let rungs = rungs(false);
        assert_eq!(rungs.len(), 33);
        assert_eq!((rungs[0].steps, rungs[0].samples), (Some(8), 1));
        assert_eq!((rungs[19].steps, rungs[19].samples), (Some(128), 64));
        assert_eq!(rungs[20].name(), "single_scattering+interleaved");
        assert!(!rungs[27].corrected && rungs[28].corrected);
    }
}
