//! With the samples, the corrected picture becomes the traced one.

use tyndall_quality::{
    BLOCK_SIDE, Image, block_z, relative_rmse_trim, relative_rmse_trim_debiased,
};
use tyndall_scene::{CorrectionMode, StopRule};
use tyndall_tests::{gpu, published};

use super::gains::{BASES, climb};
use super::interactive;

/// After many samples it is as far from the traced picture as that is from the truth, at most, and its
/// blocks lie about those of the truth without bias.
#[test]
fn the_limit_is_the_traced_picture_and_unbiased() {
    for name in ["light_shafts", "smoke_plume"] {
        let Some(truth) = published::find(name, "full") else {
            return;
        };
        let mut scene = truth.scene.clone();
        interactive(&mut scene);
        scene.render.correction = CorrectionMode::Always;
        scene.render.stop = StopRule::Samples(256);
        let still = gpu::render(&mut gpu::renderer(), scene);
        let (width, height) = (still.frame.width, still.frame.height);
        let traced = still.traced.as_ref().expect("samples were traced");
        let traced = Image::from_rgba(width, height, traced).expect("a picture");
        let noise = relative_rmse_trim_debiased(&traced, &truth.image).expect("one size");
        let corrected = gpu::image(&still);
        let apart = relative_rmse_trim(&corrected, &traced).expect("one size");
        let variance = still.variance.expect("traced samples know it");
        let corrected = corrected.with_variance(variance).expect("its size");
        let blocks = block_z(&corrected, &truth.image, BLOCK_SIDE).expect("blocks");
        println!(
            "{name}: {apart:.4} from the traced picture, which is {noise:.4} from the truth; {blocks:?}"
        );
        assert!(apart <= noise, "{apart} of {noise}");
        assert!(blocks.mean.abs() < 0.2, "{blocks:?}");
        // Where all paths bring the same, beside smoke, a block keeps its neighbours' weights.
        assert!(blocks.deviation < 1.5, "{blocks:?}");
        assert!(blocks.outside_3 * 20 <= blocks.count, "{blocks:?}");
    }
}

/// With many samples the halves know their error well.
#[test]
fn the_error_expected_of_many_samples_is_found() {
    for (label, settings) in BASES {
        let Some(rungs) = climb("light_shafts", label, settings, &[256]) else {
            return;
        };
        // Measured: 1.00 and 0.96.
        let told = rungs[0].expected / rungs[0].whole;
        assert!((0.8..1.2).contains(&told), "{label}: {told}");
    }
}
