//! More samples, less error, and never more than the better of what it is made of.

use std::time::Instant;

use tyndall_quality::{Image, relative_rmse_trim_debiased};
use tyndall_render::Still;
use tyndall_scene::{CorrectionMode, Scene, StopRule, Technique};
use tyndall_tests::{gpu, published};

use super::interactive;

/// Samples a pixel.
const LADDER: [u32; 3] = [1, 4, 16];

/// The correction alone: a black picture is brought toward the traced one.
pub(crate) fn black(scene: &mut Scene) {
    scene.render.technique = Technique::Reference;
}

/// Errors of one rung, relative to the truth's mean.
pub(crate) struct Rung {
    traced: f64,
    base: f64,
    corrected: f64,
    /// What the correction says of itself, over the whole picture.
    pub expected: f64,
    /// The same of the picture as it is, its worst pixels included.
    pub whole: f64,
    /// Of the technique's bias in the picture's mean, the part that is left.
    left: f64,
    /// By how much the correction leaves the range of the residuals, as a part of it.
    overshoot: f64,
    /// Expected and found error of each whole block of 32×32 pixels, relative to the picture's mean.
    pub blocks: Vec<(f64, f64)>,
}

/// Side of the blocks that expected errors are judged over. Unit: pixel.
const SIDE: usize = 32;

/// Expected and found errors of blocks; the truth's own variance is taken off the found ones, and what it
/// leaves nothing of is left out.
fn block_errors(still: &Still, truth: &Image) -> Vec<(f64, f64)> {
    let width = still.frame.width as usize;
    let expected = still.square_error.as_ref().expect("it was corrected");
    let variance = truth.variance().expect("the published images have one");
    let mean = |v: &[f32; 3]| v.iter().map(|v| f64::from(*v)).sum::<f64>() / 3.0;
    let whole = truth.rgb().iter().map(mean).sum::<f64>() / truth.rgb().len() as f64;
    let mut errors = Vec::new();
    for top in (0..=still.frame.height as usize - SIDE).step_by(SIDE) {
        for left in (0..=width - SIDE).step_by(SIDE) {
            let (mut told, mut found, mut own) = (0.0, 0.0, 0.0);
            for index in
                (top..top + SIDE).flat_map(|y| (left..left + SIDE).map(move |x| y * width + x))
            {
                let [r, g, b, _] = still.radiance[index];
                let off: [f32; 3] = std::array::from_fn(|c| [r, g, b][c] - truth.rgb()[index][c]);
                told += f64::from(expected[index]);
                found += mean(&off.map(|d| d * d));
                own += mean(&variance[index]);
            }
            if found > 2.0 * own {
                let relative = |sum: f64| (sum / (SIDE * SIDE) as f64).sqrt() / whole;
                errors.push((relative(told), relative(found - own)));
            }
        }
    }
    errors
}

/// What the correction makes of the picture's mean, and of its extremes.
fn whole_picture(still: &Still, truth: &Image, base: &[[f32; 4]], traced: &[[f32; 4]]) -> [f64; 2] {
    let mean = |picture: &[[f32; 4]]| {
        let sum: f64 = picture
            .iter()
            .flat_map(|p| &p[..3])
            .map(|v| f64::from(*v))
            .sum();
        sum / (3 * picture.len()) as f64
    };
    let whole = truth
        .rgb()
        .iter()
        .flatten()
        .map(|v| f64::from(*v))
        .sum::<f64>();
    let whole = whole / (3 * truth.rgb().len()) as f64;
    let bias = mean(base) - whole;
    let range = |picture: &[[f32; 4]]| {
        let apart = picture.iter().zip(base);
        let apart = apart.flat_map(|(p, b)| (0..3).map(|c| f64::from(p[c] - b[c])));
        apart.fold([0.0_f64; 2], |[low, high], v| [low.min(v), high.max(v)])
    };
    let [[low, high], [least, most]] = [range(traced), range(&still.radiance)];
    let beyond = (low - least).max(most - high).max(0.0);
    [
        ((mean(&still.radiance) - whole) / bias).abs(),
        beyond / (high - low),
    ]
}

fn error(radiance: &[[f32; 4]], still: &Still, truth: &Image) -> f64 {
    let (width, height) = (still.frame.width, still.frame.height);
    let image = Image::from_rgba(width, height, radiance).expect("a still has its pixels");
    relative_rmse_trim_debiased(&image, truth).expect("pictures of one size")
}

/// The rungs of a published scene, with so many samples a pixel each.
pub(crate) fn climb(
    name: &str,
    label: &str,
    settings: fn(&mut Scene),
    ladder: &[u32],
) -> Option<Vec<Rung>> {
    let truth = published::find(name, "full")?;
    let mut renderer = gpu::renderer();
    let mut rungs = Vec::new();
    for &samples in ladder {
        let mut scene = truth.scene.clone();
        settings(&mut scene);
        scene.render.correction = CorrectionMode::Always;
        scene.render.stop = StopRule::Samples(samples);
        let started = Instant::now();
        let still = gpu::render(&mut renderer, scene);
        let seconds = started.elapsed().as_secs_f64();
        let traced = still.traced.as_ref().expect("samples were traced");
        let nothing = vec![[0.0; 4]; traced.len()];
        let base = still.base.as_ref().unwrap_or(&nothing);
        let [left, overshoot] = whole_picture(&still, &truth.image, base, traced);
        let rung = Rung {
            left,
            overshoot,
            traced: error(traced, &still, &truth.image),
            base: error(base, &still, &truth.image),
            corrected: error(&still.radiance, &still, &truth.image),
            expected: f64::from(still.frame.stats.estimated_error.expect("an estimate")),
            whole: tyndall_quality::relative_rmse_debiased(&gpu::image(&still), &truth.image)
                .expect("pictures of one size"),
            blocks: block_errors(&still, &truth.image),
        };
        let mut blocks: Vec<f64> = rung
            .blocks
            .iter()
            .map(|(told, found)| told / found)
            .collect();
        blocks.sort_by(f64::total_cmp);
        let at = |share: f64| blocks.get((share * blocks.len() as f64) as usize).copied();
        let [least, middle, most] = [0.0, 0.5, 0.999].map(|share| at(share).unwrap_or(f64::NAN));
        println!(
            "{name} {label} n {samples}: traced {:.4}, base {:.4}, corrected {:.4}; expected {:.4}, found {:.4}, blocks {least:.2} {middle:.2} {most:.2}; bias left {left:.3}, overshoot {overshoot:.3}; {seconds:.2} s",
            rung.traced, rung.base, rung.corrected, rung.expected, rung.whole,
        );
        rungs.push(rung);
    }
    Some(rungs)
}

/// Name, and the settings that make it.
type Base = (&'static str, fn(&mut Scene));

/// What is corrected: the interactive technique's picture, and nothing.
pub(crate) const BASES: [Base; 2] = [("single scattering", interactive), ("black", black)];

fn gains(name: &str) {
    for (label, settings) in BASES {
        let Some(rungs) = climb(name, label, settings, &LADDER) else {
            return;
        };
        for rung in &rungs {
            assert!(rung.expected >= 0.5 * rung.corrected, "optimistic");
            assert!(rung.left < 0.1, "{} of the bias is left", rung.left);
            assert!(rung.overshoot < 0.05, "{} beyond", rung.overshoot);
            let best = rung.traced.min(rung.base);
            assert!(
                rung.corrected.powi(2) <= 1.05 * best.powi(2),
                "{} against {best}",
                rung.corrected
            );
        }
        for pair in rungs.windows(2) {
            // One sample a pixel leaves the finest band alone, which is sometimes luck.
            assert!(
                pair[1].corrected <= 1.25 * pair[0].corrected,
                "more samples, more error"
            );
        }
    }
}

#[test]
fn light_shafts_gain() {
    gains("light_shafts");
}

#[test]
fn fog_box_gains() {
    gains("fog_box");
}

#[test]
fn a_smoke_plume_gains() {
    gains("smoke_plume");
}

/// `relative_error` allows for what the expected error may be wrong by.
#[test]
fn a_target_of_the_error_is_met() {
    for (name, target) in [
        ("light_shafts", 0.05),
        ("fog_box", 0.15),
        ("smoke_plume", 0.04),
    ] {
        let Some(truth) = published::find(name, "full") else {
            return;
        };
        let mut scene = truth.scene.clone();
        interactive(&mut scene);
        scene.render.correction = CorrectionMode::Always;
        scene.render.stop = StopRule::RelativeError(target);
        let still = gpu::render(&mut gpu::renderer(), scene);
        let found = tyndall_quality::relative_rmse_debiased(&gpu::image(&still), &truth.image)
            .expect("pictures of one size");
        println!(
            "{name}: {found:.4} after {} samples, asked for {target}",
            still.frame.samples
        );
        assert!(found <= f64::from(target), "{name}: {found}");
        // The technique's own picture is .28 and more off.
        assert!(still.frame.samples < 200, "{name}");
    }
}
