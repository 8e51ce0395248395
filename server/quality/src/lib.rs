//! How far a picture is from the truth, and how far it may be from it where no truth is known.
//! Pure: no device, no files.
//!
//! One file a measure. All take an [`Image`]: linear radiance with, if known, the variance of each
//! pixel's mean. R is the reference, I the picture that is judged, means run over pixels and RGB.
//!
//! | measure | definition |
//! |---|---|
//! | [`relative_rmse`] | √mean((I − R)²) / mean(R) |
//! | [`relative_mse`] | mean((I − R)² / (R² + 0.01)) |
//! | [`mean_ratio`] | mean(I) / mean(R): the share of the energy that arrived |
//! | [`block_z`] | z-scores of 8×8 block means under both variances |
//! | [`ldr_flip`], [`hdr_flip`] | the difference that a person sees when both alternate |
//! | [`estimated_error`] | √mean(variance of the mean) / mean(I), without any reference |
//!
//! *Trimmed* leaves out the worst 0.1 % of pixels (at least one), *debiased* takes the reference's
//! own variance off the mean square. [`Comparison`] holds all of them.

mod block_z;
mod comparison;
mod error;
mod estimated_error;
mod flip;
mod image;
mod magma;
mod mean_ratio;
mod relative_mse;
mod relative_rmse;
mod trim;

pub use block_z::{BLOCK_SIDE, BlockZ, block_z};
pub use comparison::Comparison;
pub use error::QualityError;
pub use estimated_error::{EstimatedError, estimated_error};
pub use flip::{FlipMap, HdrFlip, PIXELS_PER_DEGREE, hdr_flip, ldr_flip};
pub use image::Image;
pub use magma::magma;
pub use mean_ratio::mean_ratio;
pub use relative_mse::{relative_mse, relative_mse_trim};
pub use relative_rmse::{
    relative_rmse, relative_rmse_debiased, relative_rmse_trim, relative_rmse_trim_debiased,
};
