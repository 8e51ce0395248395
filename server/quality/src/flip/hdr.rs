//! HDR-FLIP: the largest LDR-FLIP over all exposures at which the reference shows anything.

use rayon::prelude::*;

use super::{FlipMap, check_density, errors};
use crate::image::check_pair;
use crate::{Image, QualityError};

/// Displayed value that the reference's highlight (median) has at the darkest (brightest) exposure.
const TARGET: f32 = 0.85;
/// Numerator and denominator of the tone curve: (a x² + b x) / (c x² + d x + e). Narkowicz's 2015
/// fit of ACES with its input scaled by 0.6, as the paper uses it.
const CURVE: [f32; 5] = [
    0.6 * 0.6 * 2.51,
    0.6 * 0.03,
    0.6 * 0.6 * 2.43,
    0.6 * 0.59,
    0.14,
];
/// Keeps exposures of a reference that is mostly black finite.
const LEAST_LUMINANCE: f32 = 1e-10;
/// Most exposures: a factor 2 apart, so beyond what any display and eye can show.
const MAX_EXPOSURES: u32 = 64;

/// HDR-FLIP of two pictures.
#[derive(Debug, Clone, PartialEq)]
pub struct HdrFlip {
    /// Largest error over the exposures, pixel by pixel.
    pub map: FlipMap,
    /// Exposure of the highlights. Unit: factor of 2.
    pub start_exposure: f32,
    /// Exposure of the median. Unit: factor of 2.
    pub stop_exposure: f32,
    /// Exposures taken, evenly from start to stop. At least 2.
    pub exposures: u32,
}

/// HDR-FLIP of linear radiance; exposures are chosen from the reference alone, with the ACES curve.
/// Values below 0 count as 0.
///
/// # Errors
/// As [`super::ldr_flip`].
pub fn hdr_flip(
    image: &Image,
    reference: &Image,
    pixels_per_degree: f32,
) -> Result<HdrFlip, QualityError> {
    check_pair(image, reference)?;
    check_density(pixels_per_degree)?;
    let size = (image.width() as usize, image.height() as usize);
    let (start, stop) = exposure_range(reference.rgb());
    let exposures = ((stop - start).ceil().max(2.0) as u32).min(MAX_EXPOSURES);
    let at_exposure = |i: u32| {
        let exposure = start + (stop - start) * i as f32 / (exposures - 1) as f32;
        let shown = |picture: &Image| -> Vec<[f32; 3]> {
            let pixels = picture.rgb().iter();
            pixels
                .map(|rgb| rgb.map(|value| curve(value.max(0.0) * exposure.exp2())))
                .collect()
        };
        errors(&shown(image), &shown(reference), size, pixels_per_degree)
    };
    // The largest of several is the same in any order.
    let largest = (0..exposures)
        .into_par_iter()
        .map(at_exposure)
        .reduce_with(|mut largest, errors| {
            for (largest, error) in largest.iter_mut().zip(errors) {
                *largest = largest.max(error);
            }
            largest
        })
        .unwrap_or_default();
    Ok(HdrFlip {
        map: FlipMap {
            width: image.width(),
            height: image.height(),
            errors: largest,
        },
        start_exposure: start,
        stop_exposure: stop,
        exposures,
    })
}

fn curve(value: f32) -> f32 {
    let [a, b, c, d, e] = CURVE;
    let x = value.min(1e6);
    ((a * x * x + b * x) / (c * x * x + d * x + e)).clamp(0.0, 1.0)
}

/// Exposures that show the highlight, and the median, at [`TARGET`].
fn exposure_range(reference: &[[f32; 3]]) -> (f32, f32) {
    let mut luminance: Vec<f32> = reference
        .iter()
        .map(|rgb| 0.212_639 * rgb[0] + 0.715_168_7 * rgb[1] + 0.072_192_32 * rgb[2])
        .collect();
    luminance.sort_by(f32::total_cmp);
    let median = luminance[luminance.len() / 2].max(LEAST_LUMINANCE);
    let highest = luminance[luminance.len() - 1].max(LEAST_LUMINANCE);
    // The larger root of curve(x) = TARGET.
    let [a, b, c, d, e] = CURVE;
    let (a, b, c) = (a - TARGET * c, b - TARGET * d, -TARGET * e);
    let shown_at = (-b + (b * b - 4.0 * a * c).sqrt()) / (2.0 * a);
    ((shown_at / highest).log2(), (shown_at / median).log2())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_range_shows_highlight_and_median_at_the_target() {
        let reference = [[0.1; 3], [1.0; 3], [50.0; 3]];
        let (start, stop) = exposure_range(&reference);
        assert!((curve(50.0 * start.exp2()) - TARGET).abs() < 1e-4);
        assert!((curve(stop.exp2()) - TARGET).abs() < 1e-4);
    }

    #[test]
    fn a_black_reference_has_finite_exposures() {
        let black = Image::new(4, 4, vec![[0.0; 3]; 16]).unwrap();
        let flip = hdr_flip(&black, &black, super::super::PIXELS_PER_DEGREE).unwrap();
        assert_eq!(flip.map.mean(), 0.0);
        assert_eq!(flip.exposures, 2);
    }
}
