//! The interactive picture B, brought toward the traced one X̄.
//!
//! The residual d = X̄ − B of a few unbiased samples is noisy, the bias behind it is smooth. d is split
//! into bands; each is weighted by how much of it is signal and added to B. Two halves of the samples,
//! even and odd, tell signal from noise without a model of either: the mean of their product over a
//! window is the signal's energy, that of their squared difference the noise's, and the weight is
//! signal/(signal + noise), after James and Stein (1961). It tends to 1 with the samples, so that the
//! picture tends to X̄, and to 0 in noise, so that it stays B. Both also give its expected square error.
//!
//! `algorithms.md` §10, with two changes that measured better or alike on the reference scenes: the
//! noise comes from the halves and not from the variance of samples, and the coarse levels are kept
//! only at the cells of a grid as coarse as they are smooth.
//! Bias: vanishes with the noise of X̄. Cost: about 60 loads of a vector a pixel.

mod history;
mod levels;
mod plan;
mod pyramid;
mod state;

pub(crate) use history::Seen;
pub(crate) use plan::{PASS, SQUARE_ERRORS, largest_buffer, plan, without_correction};
pub(crate) use state::Correction;

/// By so much the error of a corrected picture may exceed the expected one: a target is met when the
/// expected error times this is below it. Found on the reference scenes, docs/calibration.svg: from four
/// samples on at most 1.47 (fog box, black picture).
pub(crate) const SAFETY: f32 = 1.5;
