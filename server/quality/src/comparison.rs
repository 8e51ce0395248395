//! Every measure of one picture against one reference.

use serde::Serialize;

use crate::{
    BLOCK_SIDE, BlockZ, EstimatedError, Image, PIXELS_PER_DEGREE, QualityError, block_z,
    estimated_error, hdr_flip, mean_ratio, relative_mse, relative_mse_trim, relative_rmse,
    relative_rmse_debiased, relative_rmse_trim, relative_rmse_trim_debiased,
};

/// Every measure of one picture against one reference; those that need a variance are absent
/// without one.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Comparison {
    /// √mean((I − R)²) / mean(R).
    pub relative_rmse: f64,
    /// `relative_rmse` with the reference's own variance taken off.
    pub relative_rmse_debiased: Option<f64>,
    /// `relative_rmse` without the worst 0.1 % of pixels.
    pub relative_rmse_trim: f64,
    /// `relative_rmse_trim` with the reference's own variance taken off.
    pub relative_rmse_trim_debiased: Option<f64>,
    /// mean((I − R)² / (R² + 0.01)).
    pub relative_mse: f64,
    /// `relative_mse` without the worst 0.1 % of pixels.
    pub relative_mse_trim: f64,
    /// mean(I) / mean(R).
    pub mean_ratio: f64,
    /// z-scores of 8×8 blocks.
    pub block_z: Option<BlockZ>,
    /// Mean HDR-FLIP. Range: [0, 1].
    pub hdr_flip: f64,
    /// The picture's relative error as its own variance estimates it.
    pub image_estimated_error: Option<EstimatedError>,
    /// The reference's relative error as its own variance estimates it.
    pub reference_estimated_error: Option<EstimatedError>,
}

impl Comparison {
    /// Compares `image` with `reference`.
    ///
    /// # Errors
    /// [`QualityError`] if the sizes differ, a value is not finite or the reference is black.
    pub fn of(image: &Image, reference: &Image) -> Result<Self, QualityError> {
        let known = reference.variance().is_some();
        let any_known = known || image.variance().is_some();
        let blocks = image.width().min(image.height()) >= BLOCK_SIDE;
        let estimate = |image: &Image| {
            let known = image.variance().is_some();
            // A black picture has no relative error.
            known.then(|| estimated_error(image).ok()).flatten()
        };
        Ok(Self {
            relative_rmse: relative_rmse(image, reference)?,
            relative_rmse_debiased: known
                .then(|| relative_rmse_debiased(image, reference))
                .transpose()?,
            relative_rmse_trim: relative_rmse_trim(image, reference)?,
            relative_rmse_trim_debiased: known
                .then(|| relative_rmse_trim_debiased(image, reference))
                .transpose()?,
            relative_mse: relative_mse(image, reference)?,
            relative_mse_trim: relative_mse_trim(image, reference)?,
            mean_ratio: mean_ratio(image, reference)?,
            block_z: (any_known && blocks)
                .then(|| block_z(image, reference, BLOCK_SIDE))
                .transpose()?,
            hdr_flip: hdr_flip(image, reference, PIXELS_PER_DEGREE)?.map.mean(),
            image_estimated_error: estimate(image),
            reference_estimated_error: estimate(reference),
        })
    }

    /// The trimmed relative RMSE, debiased where the reference's variance is known: what plots show.
    pub fn error(&self) -> f64 {
        self.relative_rmse_trim_debiased
            .unwrap_or(self.relative_rmse_trim)
    }
}
