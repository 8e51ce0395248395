//! Relative mean square error, pixel by pixel: mean((I − R)² / (R² + 0.01)).
//!
//! Unlike `relative_rmse` it weighs dark parts like bright ones; 0.01 keeps black pixels finite.
//! Source: Rousselle et al. 2011, "Adaptive Sampling and Reconstruction using Greedy Error
//! Minimization"; the constant is the reference images' README's.

use crate::image::check_pair;
use crate::trim::trimmed_mean;
use crate::{Image, QualityError};

/// Added to R². Unit: radiance².
const EPSILON: f64 = 0.01;

/// mean((I − R)² / (R² + 0.01)) over all pixels and channels. Range: ≥ 0.
///
/// # Errors
/// [`QualityError`] if the sizes differ or a value is not finite.
pub fn relative_mse(image: &Image, reference: &Image) -> Result<f64, QualityError> {
    let errors = pixel_errors(image, reference)?;
    Ok(errors.iter().sum::<f64>() / errors.len() as f64)
}

/// [`relative_mse`] without the worst 0.1 % of pixels.
///
/// # Errors
/// As [`relative_mse`].
pub fn relative_mse_trim(image: &Image, reference: &Image) -> Result<f64, QualityError> {
    Ok(trimmed_mean(&pixel_errors(image, reference)?))
}

fn pixel_errors(image: &Image, reference: &Image) -> Result<Vec<f64>, QualityError> {
    check_pair(image, reference)?;
    let pairs = image.rgb().iter().zip(reference.rgb());
    Ok(pairs
        .map(|(a, b)| {
            let relative = |c: usize| {
                let (a, b) = (f64::from(a[c]), f64::from(b[c]));
                (a - b).powi(2) / (b * b + EPSILON)
            };
            (relative(0) + relative(1) + relative(2)) / 3.0
        })
        .collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bright_and_dark_pixels_weigh_the_same() {
        let reference = Image::new(2, 1, vec![[100.0; 3], [1.0; 3]]).unwrap();
        let image = Image::new(2, 1, vec![[110.0; 3], [1.1; 3]]).unwrap();
        let error = relative_mse(&image, &reference).unwrap();
        let expected = 0.5 * (100.0 / 10_000.01 + 0.01 / 1.01);
        assert!((error - expected).abs() < 1e-8, "{error}");
        // Of two pixels, trimming leaves the better one.
        let trimmed = relative_mse_trim(&image, &reference).unwrap();
        assert!((trimmed - 0.01 / 1.01).abs() < 1e-8, "{trimmed}");
    }

    #[test]
    fn black_is_divided_by_the_constant() {
        let black = Image::new(1, 1, vec![[0.0; 3]]).unwrap();
        let image = Image::new(1, 1, vec![[0.1; 3]]).unwrap();
        assert!((relative_mse(&image, &black).unwrap() - 1.0).abs() < 1e-6);
    }
}
