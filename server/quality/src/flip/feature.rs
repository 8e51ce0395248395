//! FLIP's feature way: edges and points that one picture has and the other lacks.

use super::filter::{Kernel, kernel, separable};

/// Width of what counts as a feature. Unit: degree.
const FEATURE_WIDTH: f32 = 0.082;
/// Expands small differences.
const EXPONENT: f32 = 0.5;

/// Feature errors of luminance planes (Y of `YCxCz`). Range: [0, 1].
pub(super) fn difference(
    image: &[f32],
    reference: &[f32],
    size: (usize, usize),
    density: f32,
) -> Vec<f32> {
    let image = Features::of(image, size, density);
    let reference = Features::of(reference, size, density);
    let differ = |a: &[f32], b: &[f32], i: usize| (a[i] - b[i]).abs();
    (0..image.edges.len())
        .map(|i| {
            let edge = differ(&image.edges, &reference.edges, i);
            let point = differ(&image.points, &reference.points, i);
            (edge.max(point) / std::f32::consts::SQRT_2)
                .powf(EXPONENT)
                .clamp(0.0, 1.0)
        })
        .collect()
}

/// Strength of edges and of points.
struct Features {
    edges: Vec<f32>,
    points: Vec<f32>,
}

impl Features {
    fn of(luminance: &[f32], size: (usize, usize), density: f32) -> Self {
        let plane: Vec<f32> = luminance.iter().map(|y| (y + 16.0) / 116.0).collect();
        let deviation = 0.5 * FEATURE_WIDTH * density;
        let radius = (3.0 * deviation).ceil() as usize;
        let gaussian = |x: f32| (-0.5 * (x / deviation).powi(2)).exp();
        let mut smooth = kernel(radius, gaussian);
        let sum: f32 = smooth.iter().sum();
        for value in &mut smooth {
            *value /= sum;
        }
        let slope = signed(kernel(radius, |x| -x * gaussian(x)));
        let bend = signed(kernel(radius, |x| {
            ((x / deviation).powi(2) - 1.0) * gaussian(x)
        }));
        let strength = |derivative: &[f32]| {
            let along_x = separable(&plane, size, derivative, &smooth);
            let along_y = separable(&plane, size, &smooth, derivative);
            let pairs = along_x.iter().zip(&along_y);
            pairs.map(|(x, y)| x.hypot(*y)).collect()
        };
        Self {
            edges: strength(&slope),
            points: strength(&bend),
        }
    }
}

/// Positive weights scaled to a sum of 1, negative ones to −1.
fn signed(mut kernel: Kernel) -> Kernel {
    let positive: f32 = kernel.iter().filter(|value| **value > 0.0).sum();
    let negative: f32 = kernel.iter().filter(|value| **value < 0.0).sum();
    for value in &mut kernel {
        *value /= if *value > 0.0 { positive } else { -negative };
    }
    kernel
}
