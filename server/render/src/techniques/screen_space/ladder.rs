//! Settings of the filter that the benchmark measures.

use tyndall_scene::{LevelFetch, RenderSettings, ScreenSpaceFilter, SpreadModel, Technique};

use crate::techniques::Rung;

/// As new scenes have it: the splat pyramid.
const SPLAT: &str = "";
/// The hierarchical filter of Iser 2018 with all its remedies.
const HIERARCHICAL: &str = "+hierarchical";
/// With bright pixels apart.
const SEPARATED: &str = "+hierarchical+separation";
/// Without the light that lights scatter in the media.
const FILTER_ALONE: &str = "+filter_alone";
/// By Premože's spread.
const PREMOZE: &str = "+premoze";

/// Each filter at one and several samples; then corrected, as the page does it.
pub(super) fn rungs(quick: bool) -> Vec<Rung> {
    let (variants, samples, corrected): (&[&'static str], &[u32], &[u32]) = if quick {
        (&[FILTER_ALONE, SPLAT], &[1, 4], &[1, 4])
    } else {
        let variants = &[FILTER_ALONE, SPLAT, PREMOZE, HIERARCHICAL, SEPARATED];
        (variants, &[1, 4, 16], &[1, 4, 16, 64])
    };
    let rung = |variant, samples, corrected| Rung {
        technique: Technique::ScreenSpace,
        variant,
        steps: None,
        samples,
        corrected,
        configure,
    };
    let mut rungs = Vec::new();
    for variant in variants {
        rungs.extend(samples.iter().map(|n| rung(*variant, *n, false)));
    }
    rungs.extend(corrected.iter().map(|n| rung(SPLAT, *n, true)));
    rungs
}

fn configure(render: &mut RenderSettings, rung: &Rung) {
    let own = &mut render.screen_space;
    own.in_scatter = rung.variant != FILTER_ALONE;
    own.separation = rung.variant == SEPARATED;
    own.fetch = LevelFetch::LinearBicubic;
    own.filter = match rung.variant {
        HIERARCHICAL | SEPARATED => ScreenSpaceFilter::Hierarchical,
        _ => ScreenSpaceFilter::Splat,
    };
    own.spread = match rung.variant {
        PREMOZE => SpreadModel::Premoze,
        _ => SpreadModel::ExactMoments,
    };
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_full_ladder_has_every_filter_and_the_corrected_default() {
        let rungs = rungs(false);
        assert_eq!(rungs.len(), 19);
        assert_eq!(rungs[0].name(), "screen_space+filter_alone");
        assert_eq!(rungs[18].name(), "screen_space+correction");
    }
}
