//! Every measure of one picture against the truths that are known.

use serde::Serialize;
use tyndall_picture::exposed;
use tyndall_quality::{
    Comparison, FlipMap, Image, PIXELS_PER_DEGREE, QualityError, hdr_flip, ldr_flip,
};

/// Every measure of one picture against one truth.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Measures {
    /// Measures of radiance. Without z-scores unless the picture's own variance is known as well as the
    /// truth's.
    #[serde(flatten)]
    pub radiance: Comparison,
    /// Mean LDR-FLIP of the displayed pictures, at the scene's exposure. Range: [0, 1].
    pub ldr_flip: f64,
}

impl Measures {
    /// Measures `image` against `truth`.
    pub(crate) fn of(image: &Image, truth: &Image, exposure_ev: f32) -> Result<Self, QualityError> {
        let shown =
            |image: &Image| Image::new(image.width(), image.height(), exposed(image, exposure_ev));
        let flip = ldr_flip(&shown(image)?, &shown(truth)?, PIXELS_PER_DEGREE)?;
        let mut radiance = Comparison::of(image, truth)?;
        // Noise of unknown size would count as bias.
        if image.variance().is_none() {
            radiance.block_z = None;
        }
        Ok(Self {
            radiance,
            ldr_flip: flip.mean(),
        })
    }

    /// The error that plots and efficiencies use: relRMSE without the worst 0.1 % of pixels, the
    /// truth's own variance taken off.
    pub fn error(&self) -> f64 {
        self.radiance.error()
    }
}

/// FLIP error picture, pixel by pixel.
pub(crate) fn error_map(image: &Image, truth: &Image) -> Result<FlipMap, QualityError> {
    Ok(hdr_flip(image, truth, PIXELS_PER_DEGREE)?.map)
}
