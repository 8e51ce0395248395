//! Relative root mean square error: √mean((I − R)²) / mean(R).
//!
//! Source: the reference images' README ("Error measures"), whose program the tests follow.

use crate::image::{check_pair, positive_mean};
use crate::trim::{kept, mean_at};
use crate::{Image, QualityError};

/// √mean((I − R)²) / mean(R) over all pixels and channels. Range: ≥ 0.
///
/// # Errors
/// [`QualityError`] if the sizes differ, a value is not finite or the reference is black.
pub fn relative_rmse(image: &Image, reference: &Image) -> Result<f64, QualityError> {
    of(image, reference, false, false)
}

/// [`relative_rmse`] with mean(variance of the reference) taken off the mean square: what is left is
/// the picture's own error, even where the reference is noisy. 0 if noise explains all of it.
///
/// # Errors
/// As [`relative_rmse`], and [`QualityError::NoVariance`].
pub fn relative_rmse_debiased(image: &Image, reference: &Image) -> Result<f64, QualityError> {
    of(image, reference, false, true)
}

/// [`relative_rmse`] without the worst 0.1 % of pixels (square error averaged over channels).
///
/// # Errors
/// As [`relative_rmse`].
pub fn relative_rmse_trim(image: &Image, reference: &Image) -> Result<f64, QualityError> {
    of(image, reference, true, false)
}

/// [`relative_rmse_trim`] with the reference's variance taken off, over the pixels that stay.
///
/// # Errors
/// As [`relative_rmse_debiased`].
pub fn relative_rmse_trim_debiased(image: &Image, reference: &Image) -> Result<f64, QualityError> {
    of(image, reference, true, true)
}

fn of(image: &Image, reference: &Image, trim: bool, debias: bool) -> Result<f64, QualityError> {
    check_pair(image, reference)?;
    let mean = positive_mean("reference", reference)?;
    let squares = square_errors(image, reference);
    let pixels = if trim {
        kept(&squares)
    } else {
        (0..squares.len()).collect()
    };
    let own = if debias {
        let variance = reference
            .variance()
            .ok_or(QualityError::NoVariance { which: "reference" })?;
        mean_at(&channel_means(variance), &pixels)
    } else {
        0.0
    };
    Ok((mean_at(&squares, &pixels) - own).max(0.0).sqrt() / mean)
}

/// Square error of each pixel, averaged over channels.
fn square_errors(image: &Image, reference: &Image) -> Vec<f64> {
    let pairs = image.rgb().iter().zip(reference.rgb());
    pairs
        .map(|(a, b)| {
            let square = |c: usize| (f64::from(a[c]) - f64::from(b[c])).powi(2);
            (square(0) + square(1) + square(2)) / 3.0
        })
        .collect()
}

/// Mean over the channels of each pixel.
pub(crate) fn channel_means(pixels: &[[f32; 3]]) -> Vec<f64> {
    pixels
        .iter()
        .map(|p| p.iter().map(|value| f64::from(*value)).sum::<f64>() / 3.0)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grey(values: &[f32]) -> Image {
        let rgb = values.iter().map(|value| [*value; 3]).collect();
        Image::new(values.len() as u32, 1, rgb).unwrap()
    }

    #[test]
    fn a_uniform_ten_percent_offset_is_an_error_of_a_tenth() {
        let (image, reference) = (grey(&[2.2; 500]), grey(&[2.0; 500]));
        assert!((relative_rmse(&image, &reference).unwrap() - 0.1).abs() < 1e-6);
        assert!((relative_rmse_trim(&image, &reference).unwrap() - 0.1).abs() < 1e-6);
    }

    #[test]
    fn the_worst_thousandth_of_pixels_is_left_out() {
        let reference = grey(&[1.0; 2000]);
        let mut values = [1.0; 2000];
        values[7] = 1e6;
        values[9] = 1e6;
        assert_eq!(relative_rmse_trim(&grey(&values), &reference), Ok(0.0));
        assert!(relative_rmse(&grey(&values), &reference).unwrap() > 1e4);
        values[11] = 2.0;
        assert!(relative_rmse_trim(&grey(&values), &reference).unwrap() > 0.0);
    }

    #[test]
    fn the_references_own_variance_is_taken_off() {
        // Mean square error 0.04, of which 0.03 is the reference's.
        let reference = grey(&[1.0; 100]).with_variance(vec![[0.03; 3]; 100]);
        let reference = reference.unwrap();
        let image = grey(&[1.2; 100]);
        let debiased = relative_rmse_debiased(&image, &reference).unwrap();
        assert!((debiased - 0.1).abs() < 1e-6, "{debiased}");
        let trimmed = relative_rmse_trim_debiased(&image, &reference).unwrap();
        assert!((trimmed - 0.1).abs() < 1e-6, "{trimmed}");
        assert_eq!(relative_rmse_debiased(&reference, &reference), Ok(0.0));
        assert_eq!(
            relative_rmse_debiased(&image, &image),
            Err(QualityError::NoVariance { which: "reference" })
        );
    }

    #[test]
    fn what_cannot_be_compared_has_a_name() {
        let one = grey(&[1.0]);
        assert!(matches!(
            relative_rmse(&one, &grey(&[1.0, 1.0])),
            Err(QualityError::SizeMismatch { .. })
        ));
        assert!(matches!(
            relative_rmse(&one, &grey(&[0.0])),
            Err(QualityError::Black { .. })
        ));
        assert!(matches!(
            relative_rmse(&grey(&[f32::NAN]), &one),
            Err(QualityError::NonFinite {
                which: "image",
                count: 3
            })
        ));
    }
}
