//! Linear radiance, and how sure each pixel is.

use crate::QualityError;

/// A picture: linear Rec. 709 RGB, row 0 at the top, and the variance of each pixel's mean if known.
///
/// May hold values that are not finite, so that they can be counted; measures refuse them by name.
#[derive(Debug, Clone, PartialEq)]
pub struct Image {
    width: u32,
    height: u32,
    rgb: Vec<[f32; 3]>,
    variance: Option<Vec<[f32; 3]>>,
}

impl Image {
    /// A picture of `width` × `height` pixels without known variance.
    ///
    /// # Errors
    /// [`QualityError::Empty`] without pixels, [`QualityError::Length`] if `rgb` has another count.
    pub fn new(width: u32, height: u32, rgb: Vec<[f32; 3]>) -> Result<Self, QualityError> {
        if width == 0 || height == 0 {
            return Err(QualityError::Empty { width, height });
        }
        check_length("radiance", rgb.len(), width, height)?;
        Ok(Self {
            width,
            height,
            rgb,
            variance: None,
        })
    }

    /// The RGB of four-channel pixels; the fourth is dropped.
    ///
    /// # Errors
    /// As [`Image::new`].
    pub fn from_rgba(width: u32, height: u32, rgba: &[[f32; 4]]) -> Result<Self, QualityError> {
        Self::new(
            width,
            height,
            rgba.iter().map(|p| [p[0], p[1], p[2]]).collect(),
        )
    }

    /// The same picture with the variance of each pixel's mean (the squared standard error).
    ///
    /// # Errors
    /// [`QualityError::Length`] if the counts differ.
    pub fn with_variance(mut self, variance: Vec<[f32; 3]>) -> Result<Self, QualityError> {
        check_length("variance", variance.len(), self.width, self.height)?;
        self.variance = Some(variance);
        Ok(self)
    }

    /// The same picture without variance.
    #[must_use]
    pub fn without_variance(mut self) -> Self {
        self.variance = None;
        self
    }

    /// Unit: pixel.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Unit: pixel.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// Pixels, row by row from the top.
    pub fn rgb(&self) -> &[[f32; 3]] {
        &self.rgb
    }

    /// Variance of each pixel's mean.
    pub fn variance(&self) -> Option<&[[f32; 3]]> {
        self.variance.as_deref()
    }

    /// Pixels of which at least one channel is NaN or infinite.
    pub fn non_finite(&self) -> u64 {
        let bad = |pixel: &&[f32; 3]| pixel.iter().any(|value| !value.is_finite());
        self.rgb.iter().filter(bad).count() as u64
    }

    /// Mean over pixels and channels.
    ///
    /// # Errors
    /// [`QualityError::NonFinite`].
    pub fn mean(&self) -> Result<f64, QualityError> {
        self.check("image")?;
        Ok(mean_of(&self.rgb))
    }

    /// Refuses values that no measure can use.
    pub(crate) fn check(&self, which: &'static str) -> Result<(), QualityError> {
        let values = self.rgb.iter().chain(self.variance.iter().flatten());
        let count = values.flatten().filter(|value| !value.is_finite()).count() as u64;
        if count > 0 {
            return Err(QualityError::NonFinite { which, count });
        }
        let values = self.variance.iter().flatten().flatten();
        let count = values.filter(|value| **value < 0.0).count() as u64;
        if count > 0 {
            return Err(QualityError::NegativeVariance { which, count });
        }
        Ok(())
    }
}

/// What every measure of two pictures asks for: equal sizes, finite values.
pub(crate) fn check_pair(image: &Image, reference: &Image) -> Result<(), QualityError> {
    let size = |image: &Image| (image.width, image.height);
    if size(image) != size(reference) {
        return Err(QualityError::SizeMismatch {
            image: size(image),
            reference: size(reference),
        });
    }
    image.check("image")?;
    reference.check("reference")
}

/// The reference's mean, which must be above 0.
pub(crate) fn positive_mean(which: &'static str, image: &Image) -> Result<f64, QualityError> {
    let mean = mean_of(&image.rgb);
    if mean > 0.0 {
        return Ok(mean);
    }
    Err(QualityError::Black {
        which,
        mean: mean.to_string(),
    })
}

/// Mean over pixels and channels.
pub(crate) fn mean_of(pixels: &[[f32; 3]]) -> f64 {
    let sum: f64 = pixels.iter().flatten().map(|value| f64::from(*value)).sum();
    sum / (3 * pixels.len().max(1)) as f64
}

fn check_length(
    what: &'static str,
    found: usize,
    width: u32,
    height: u32,
) -> Result<(), QualityError> {
    if found as u64 == u64::from(width) * u64::from(height) {
        return Ok(());
    }
    Err(QualityError::Length {
        what,
        found,
        width,
        height,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_cannot_be_an_image_is_refused_by_name() {
        assert!(matches!(
            Image::new(0, 4, Vec::new()),
            Err(QualityError::Empty { .. })
        ));
        assert!(matches!(
            Image::new(2, 2, vec![[0.0; 3]; 3]),
            Err(QualityError::Length { found: 3, .. })
        ));
        let image = Image::new(1, 1, vec![[0.0; 3]]).unwrap();
        assert!(image.with_variance(Vec::new()).is_err());
    }

    #[test]
    fn values_that_are_not_finite_are_counted_and_refused() {
        let image = Image::new(2, 1, vec![[f32::NAN, f32::INFINITY, 1.0], [1.0; 3]]).unwrap();
        assert_eq!(image.non_finite(), 1);
        assert_eq!(
            image.mean(),
            Err(QualityError::NonFinite {
                which: "image",
                count: 2
            })
        );
    }

    #[test]
    fn negative_variances_are_refused() {
        let image = Image::new(1, 1, vec![[1.0; 3]]).unwrap();
        let image = image.with_variance(vec![[0.0, -1.0, 0.0]]).unwrap();
        assert!(matches!(
            image.mean(),
            Err(QualityError::NegativeVariance { count: 1, .. })
        ));
    }
}
