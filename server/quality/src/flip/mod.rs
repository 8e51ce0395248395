//! FLIP: the difference that a person sees when two pictures alternate at the same place.
//!
//! Own implementation of Andersson et al. 2020, "FLIP: A Difference Evaluator for Alternating
//! Images", and Andersson et al. 2021, "Visualizing Errors in Rendered High Dynamic Range Images",
//! checked against the authors' program (`tests/flip.rs`). Pictures come in linear; an error lies in
//! [0, 1], 0 where no difference is seen.
//!
//! Two ways are taken through a picture and multiplied as E = `color^(1 − feature)`: `color` filters
//! with the eye's contrast sensitivity and measures distance in a Hunt-adjusted L\*a\*b\*; `feature`
//! finds edges and points that are in one picture only.

mod color;
mod color_space;
mod feature;
mod filter;
mod hdr;

pub use hdr::{HdrFlip, hdr_flip};

use crate::image::check_pair;
use crate::{Image, QualityError};

/// The default of the papers: a display of 3840 pixels and 0.7 m seen from 0.7 m. Unit: pixel per
/// degree.
pub const PIXELS_PER_DEGREE: f32 = 0.7 * 3840.0 / 0.7 * std::f32::consts::PI / 180.0;

/// Errors pixel by pixel.
#[derive(Debug, Clone, PartialEq)]
pub struct FlipMap {
    /// Unit: pixel.
    pub width: u32,
    /// Unit: pixel.
    pub height: u32,
    /// Row by row from the top. Range: [0, 1].
    pub errors: Vec<f32>,
}

impl FlipMap {
    /// Mean error. Range: [0, 1].
    pub fn mean(&self) -> f64 {
        let sum: f64 = self.errors.iter().map(|error| f64::from(*error)).sum();
        sum / self.errors.len().max(1) as f64
    }
}

/// LDR-FLIP of two displayed pictures: linear RGB, values outside of [0, 1] count as the nearer end.
/// `pixels_per_degree` says how large a pixel is seen ([`PIXELS_PER_DEGREE`]).
///
/// # Errors
/// [`QualityError`] if the sizes differ, a value is not finite, or `pixels_per_degree` is outside of
/// [1, 1000].
pub fn ldr_flip(
    image: &Image,
    reference: &Image,
    pixels_per_degree: f32,
) -> Result<FlipMap, QualityError> {
    check_pair(image, reference)?;
    check_density(pixels_per_degree)?;
    let size = (image.width() as usize, image.height() as usize);
    Ok(FlipMap {
        width: image.width(),
        height: image.height(),
        errors: errors(image.rgb(), reference.rgb(), size, pixels_per_degree),
    })
}

fn check_density(pixels_per_degree: f32) -> Result<(), QualityError> {
    if (1.0..=1000.0).contains(&pixels_per_degree) {
        return Ok(());
    }
    Err(QualityError::PixelsPerDegree {
        found: pixels_per_degree.to_string(),
    })
}

/// Errors of linear pixels.
fn errors(
    image: &[[f32; 3]],
    reference: &[[f32; 3]],
    size: (usize, usize),
    density: f32,
) -> Vec<f32> {
    let image = color_space::opponent(image);
    let reference = color_space::opponent(reference);
    let mut errors = color::difference(&image, &reference, size, density);
    let features = feature::difference(&image[0], &reference[0], size, density);
    for (error, feature) in errors.iter_mut().zip(features) {
        *error = error.powf(1.0 - feature);
    }
    errors
}
