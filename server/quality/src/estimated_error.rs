//! Error of a picture that is still being rendered, from nothing but its own variance.
//!
//! Knows noise, not bias: an estimate for unbiased techniques, a lower bound for all others. Where
//! the variance itself is estimated from few samples it misses what was not hit yet.

use serde::Serialize;

use crate::image::{mean_of, positive_mean};
use crate::relative_rmse::channel_means;
use crate::trim::{kept, mean_at};
use crate::{Image, QualityError};

/// Estimated relative error.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct EstimatedError {
    /// √mean(variance of the mean) / mean: expected `relative_rmse` against the truth.
    pub relative_error: f64,
    /// The same without the 0.1 % of pixels of largest variance.
    pub relative_error_trim: f64,
}

/// Estimates the relative error of `image`.
///
/// # Errors
/// [`QualityError`] if it has no variance, is black, or a value is not finite.
pub fn estimated_error(image: &Image) -> Result<EstimatedError, QualityError> {
    image.check("image")?;
    let variance = image
        .variance()
        .ok_or(QualityError::NoVariance { which: "image" })?;
    let mean = positive_mean("image", image)?;
    let pixels = channel_means(variance);
    let trimmed = mean_at(&pixels, &kept(&pixels));
    Ok(EstimatedError {
        relative_error: mean_of(variance).sqrt() / mean,
        relative_error_trim: trimmed.sqrt() / mean,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_standard_error_of_a_tenth_of_the_mean_is_a_tenth() {
        let mut variance = vec![[0.04; 3]; 1000];
        variance[3] = [1e4; 3];
        let image = Image::new(100, 10, vec![[2.0; 3]; 1000])
            .unwrap()
            .with_variance(variance)
            .unwrap();
        let error = estimated_error(&image).unwrap();
        assert!((error.relative_error_trim - 0.1).abs() < 1e-6, "{error:?}");
        assert!((error.relative_error - (10.04_f64).sqrt() / 2.0).abs() < 1e-3);
        assert!(estimated_error(&image.without_variance()).is_err());
    }
}
