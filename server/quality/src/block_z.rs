//! Is the difference of two pictures noise? z-scores of block means.
//!
//! z = (block(I) − block(R)) / √(var I + var R), a channel of a block each. If both variances are
//! right and nothing is biased, z has mean 0 and deviation 1; averaging over a block makes it normal
//! enough and finds bias far below the noise of a pixel.

use serde::Serialize;

use crate::image::check_pair;
use crate::{Image, QualityError};

/// Default side of a block. Unit: pixel.
pub const BLOCK_SIDE: u32 = 8;
/// Blocks with less variance than this are exact in both pictures and have no z. Unit: radiance².
const LEAST_VARIANCE: f64 = 1e-12;
/// Keeps z finite. Unit: radiance².
const FLOOR: f64 = 1e-14;

/// z-scores of all blocks and channels.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct BlockZ {
    /// 0 if nothing is biased.
    pub mean: f64,
    /// 1 if both variances are right and nothing is biased.
    pub deviation: f64,
    /// Largest |z|.
    pub max: f64,
    /// Scores beyond ±3; 0.27 % of `count` if all is noise.
    pub outside_3: u64,
    /// Scores: three a block, less those without variance.
    pub count: u64,
}

/// z-scores of `side` × `side` blocks under the variances of both pictures; a picture without one
/// counts as exact. Blocks that stick out at the right and the bottom are left out, and channels of
/// blocks without variance. All zero if none is left.
///
/// # Errors
/// [`QualityError`] if the sizes differ, a value is not finite, no block fits, or neither picture has
/// a variance.
pub fn block_z(image: &Image, reference: &Image, side: u32) -> Result<BlockZ, QualityError> {
    check_pair(image, reference)?;
    let (width, height) = (image.width(), image.height());
    if side == 0 || side > width || side > height {
        return Err(QualityError::BlockTooLarge {
            side,
            width,
            height,
        });
    }
    if image.variance().is_none() && reference.variance().is_none() {
        return Err(QualityError::NoVariance {
            which: "image and the reference",
        });
    }
    let mut scores = Vec::new();
    for by in 0..height / side {
        for bx in 0..width / side {
            let mean = |plane: &[[f32; 3]], c: usize| {
                let mut sum = 0.0;
                for y in by * side..(by + 1) * side {
                    for x in bx * side..(bx + 1) * side {
                        sum += f64::from(plane[(y * width + x) as usize][c]);
                    }
                }
                sum / f64::from(side * side)
            };
            for c in 0..3 {
                // Variance of a block's mean: the mean variance over the pixels it holds.
                let variance = [image.variance(), reference.variance()]
                    .into_iter()
                    .flatten()
                    .map(|plane| mean(plane, c))
                    .sum::<f64>()
                    / f64::from(side * side);
                if variance > LEAST_VARIANCE {
                    let difference = mean(image.rgb(), c) - mean(reference.rgb(), c);
                    scores.push(difference / (variance + FLOOR).sqrt());
                }
            }
        }
    }
    Ok(summary(&scores))
}

fn summary(scores: &[f64]) -> BlockZ {
    let n = scores.len().max(1) as f64;
    let mean = scores.iter().sum::<f64>() / n;
    let square = scores.iter().map(|z| (z - mean).powi(2)).sum::<f64>() / n;
    BlockZ {
        mean,
        deviation: square.sqrt(),
        max: scores.iter().fold(0.0, |max, z| z.abs().max(max)),
        outside_3: scores.iter().filter(|z| z.abs() > 3.0).count() as u64,
        count: scores.len() as u64,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_shift_of_four_deviations_of_the_block_is_a_mean_of_four() {
        // 64 pixels of variance 0.64 have a mean of variance 0.01.
        let reference = Image::new(16, 9, vec![[1.0; 3]; 144])
            .unwrap()
            .with_variance(vec![[0.64; 3]; 144])
            .unwrap();
        let image = Image::new(16, 9, vec![[1.4; 3]; 144]).unwrap();
        let z = block_z(&image, &reference, BLOCK_SIDE).unwrap();
        assert!((z.mean - 4.0).abs() < 1e-5, "{z:?}");
        assert!(z.deviation < 1e-6 && (z.max - 4.0).abs() < 1e-5, "{z:?}");
        // Two whole blocks; the ninth row is left out.
        assert_eq!((z.outside_3, z.count), (6, 6));
    }

    #[test]
    fn both_variances_count() {
        let make = |value: f32| {
            Image::new(8, 8, vec![[value; 3]; 64])
                .unwrap()
                .with_variance(vec![[0.32; 3]; 64])
                .unwrap()
        };
        let z = block_z(&make(1.1), &make(1.0), 8).unwrap();
        assert!((z.mean - 1.0).abs() < 1e-5, "{z:?}");
    }

    #[test]
    fn without_any_variance_there_is_no_score() {
        let image = Image::new(8, 8, vec![[1.0; 3]; 64]).unwrap();
        assert!(matches!(
            block_z(&image, &image, 8),
            Err(QualityError::NoVariance { .. })
        ));
        assert!(matches!(
            block_z(&image, &image, 9),
            Err(QualityError::BlockTooLarge { side: 9, .. })
        ));
        let exact = image.with_variance(vec![[0.0; 3]; 64]).unwrap();
        assert_eq!(block_z(&exact, &exact, 8).unwrap().count, 0);
    }
}
