//! Ratio of the means: the share of the energy that arrived.

use crate::image::{check_pair, mean_of, positive_mean};
use crate::{Image, QualityError};

/// mean(I) / mean(R). 1 if no energy is lost or made.
///
/// # Errors
/// [`QualityError`] if the sizes differ, a value is not finite or the reference is black.
pub fn mean_ratio(image: &Image, reference: &Image) -> Result<f64, QualityError> {
    check_pair(image, reference)?;
    Ok(mean_of(image.rgb()) / positive_mean("reference", reference)?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn half_the_energy_is_a_ratio_of_a_half() {
        let reference = Image::new(1, 2, vec![[1.0, 2.0, 3.0], [2.0; 3]]).unwrap();
        let image = Image::new(1, 2, vec![[1.0; 3], [1.0; 3]]).unwrap();
        assert_eq!(mean_ratio(&image, &reference), Ok(0.5));
    }
}
