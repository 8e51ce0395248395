//! FLIP's colour way: what is left of a colour difference after the eye's contrast sensitivity.

use std::f32::consts::PI;

use super::color_space::{hunt_lab, hyab, rgb_from_opponent};
use super::filter::{Kernel, kernel, separable};

/// Contrast sensitivity of one channel: sum of a √(π/b) exp(−π² x²/b), x in degrees.
type Sensitivity = &'static [(f32, f32)];

/// Of Y, Cx and Cz.
const SENSITIVITIES: [Sensitivity; 3] = [
    &[(1.0, 0.0047)],
    &[(1.0, 0.0053)],
    &[(34.1, 0.04), (13.5, 0.025)],
];
/// Widest b: it decides the radius of all filters.
const WIDEST: f32 = 0.04;
/// Compresses large differences.
const EXPONENT: f32 = 0.7;
/// Share of the largest difference that is mapped to `KNEE`.
const KNEE_AT: f32 = 0.4;
/// Differences below `KNEE_AT` of the largest fill [0, KNEE].
const KNEE: f32 = 0.95;

/// Colour errors of opponent planes. Range: [0, 1].
pub(super) fn difference(
    image: &[Vec<f32>; 3],
    reference: &[Vec<f32>; 3],
    size: (usize, usize),
    density: f32,
) -> Vec<f32> {
    let image = filtered(image, size, density);
    let reference = filtered(reference, size, density);
    let largest = hyab(hunt_lab([0.0, 1.0, 0.0]), hunt_lab([0.0, 0.0, 1.0])).powf(EXPONENT);
    let knee_at = KNEE_AT * largest;
    image
        .iter()
        .zip(&reference)
        .map(|(a, b)| {
            let error = hyab(*a, *b).powf(EXPONENT);
            if error < knee_at {
                error * KNEE / knee_at
            } else {
                KNEE + (error - knee_at) / (largest - knee_at) * (1.0 - KNEE)
            }
        })
        // Colours outside the largest difference do not exist; rounding may still exceed it.
        .map(|error| error.clamp(0.0, 1.0))
        .collect()
}

/// Hunt-adjusted L\*a\*b\* of what the eye resolves.
fn filtered(planes: &[Vec<f32>; 3], size: (usize, usize), density: f32) -> Vec<[f32; 3]> {
    let radius = (3.0 * (WIDEST / (2.0 * PI * PI)).sqrt() * density).ceil() as usize;
    let seen: [Vec<f32>; 3] = std::array::from_fn(|c| {
        let mut sum = vec![0.0; planes[c].len()];
        for (weight, kernel) in kernels(SENSITIVITIES[c], radius, density) {
            let part = separable(&planes[c], size, &kernel, &kernel);
            for (sum, part) in sum.iter_mut().zip(part) {
                *sum += weight * part;
            }
        }
        sum
    });
    let pixels = seen[0].iter().zip(&seen[1]).zip(&seen[2]);
    pixels
        .map(|((y, cx), cz)| hunt_lab(rgb_from_opponent([*y, *cx, *cz])))
        .collect()
}

/// Gaussians of sum 1 along one axis with the share of each; the shares add up to 1.
fn kernels(sensitivity: Sensitivity, radius: usize, density: f32) -> Vec<(f32, Kernel)> {
    let mut parts: Vec<(f32, Kernel)> = sensitivity
        .iter()
        .map(|(a, b)| {
            let kernel = kernel(radius, |x| (-(PI * x / density).powi(2) / b).exp());
            (a * (PI / b).sqrt(), kernel)
        })
        .collect();
    for (weight, kernel) in &mut parts {
        let sum: f32 = kernel.iter().sum();
        for value in kernel.iter_mut() {
            *value /= sum;
        }
        // The kernel is used along both axes.
        *weight *= sum * sum;
    }
    let total: f32 = parts.iter().map(|(weight, _)| weight).sum();
    for (weight, _) in &mut parts {
        *weight /= total;
    }
    parts
}
