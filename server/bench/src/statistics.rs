//! Summaries of samples.

use serde::Serialize;

/// Median and 95th percentile.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Summary {
    /// Half of the samples are below.
    pub median: f64,
    /// 95 % of the samples are below.
    pub p95: f64,
}

impl Summary {
    /// Summary of finite samples (nearest rank); zeros without any.
    pub fn of(samples: &[f64]) -> Self {
        let mut sorted = samples.to_vec();
        sorted.sort_by(f64::total_cmp);
        let rank = |q: f64| {
            let index = (q * sorted.len() as f64).ceil() as usize;
            sorted.get(index.saturating_sub(1)).copied().unwrap_or(0.0)
        };
        Self {
            median: rank(0.5),
            p95: rank(0.95),
        }
    }
}

/// √mean((a − b)²)/mean(b) over pixels and RGB, the worst 0.1 % of pixels left out.
pub fn relative_rmse(image: &[[f32; 4]], reference: &[[f32; 4]]) -> f64 {
    let mut squares: Vec<f64> = image
        .iter()
        .zip(reference)
        .map(|(a, b)| (0..3).map(|c| f64::from(a[c] - b[c]).powi(2)).sum::<f64>() / 3.0)
        .collect();
    squares.sort_by(f64::total_cmp);
    let kept = squares.len()
        - squares
            .len()
            .div_ceil(1000)
            .min(squares.len().saturating_sub(1));
    let mean_square = squares[..kept].iter().sum::<f64>() / kept.max(1) as f64;
    let mean = reference
        .iter()
        .map(|b| (0..3).map(|c| f64::from(b[c])).sum::<f64>() / 3.0)
        .sum::<f64>()
        / reference.len().max(1) as f64;
    if mean > 0.0 {
        mean_square.sqrt() / mean
    } else {
        mean_square.sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn median_and_p95_are_nearest_ranks() {
        let samples: Vec<f64> = (1..=100).rev().map(f64::from).collect();
        assert_eq!(
            Summary::of(&samples),
            Summary {
                median: 50.0,
                p95: 95.0
            }
        );
    }

    #[test]
    fn a_uniform_ten_percent_offset_is_an_error_of_a_tenth() {
        let reference = vec![[2.0, 2.0, 2.0, 0.0]; 5000];
        let image = vec![[2.2, 2.2, 2.2, 0.0]; 5000];
        assert!((relative_rmse(&image, &reference) - 0.1).abs() < 1e-6);
    }

    #[test]
    fn the_worst_thousandth_of_pixels_is_left_out() {
        let reference = vec![[1.0, 1.0, 1.0, 0.0]; 2000];
        let mut image = reference.clone();
        image[7] = [1e6; 4];
        image[9] = [1e6; 4];
        assert_eq!(relative_rmse(&image, &reference), 0.0);
        image[11] = [2.0; 4];
        assert!(relative_rmse(&image, &reference) > 0.0);
    }
}
