//! Estimates with their standard errors, and how far they may lie from the truth.
//!
//! A test asks for |found − expected| ≤ tolerance + 4 standard errors: noise alone crosses that once
//! in 16,000 trials. The seeds are fixed, so a test that passed fails only if something changed.

#![allow(clippy::print_stdout, reason = "tests print what they measure")]

use std::sync::{LazyLock, Mutex, PoisonError};

use serde_json::Value;
use tyndall_render::{Renderer, Still};

use crate::gpu;

/// Standard errors that noise may take away; a false alarm is 6.3e-5 a comparison.
pub const SIGMAS: f64 = 4.0;

/// One device a test program: its pipelines are built once.
static RENDERER: LazyLock<Mutex<Renderer>> = LazyLock::new(|| Mutex::new(gpu::renderer()));

/// Calls `with` with the program's renderer.
pub fn with_renderer<T>(with: impl FnOnce(&mut Renderer) -> T) -> T {
    let mut renderer = RENDERER.lock().unwrap_or_else(PoisonError::into_inner);
    with(&mut renderer)
}

/// Renders a scene of the reference and holds it to finite, non-negative samples of whole paths.
pub fn render(json: &Value) -> Still {
    let still = with_renderer(|renderer| gpu::render(renderer, gpu::scene(json)));
    assert_eq!(still.truncated, 0, "truncated paths");
    still
}

/// A mean and its standard error, red, green, blue.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimate {
    /// Mean.
    pub mean: [f64; 3],
    /// Standard error of the mean.
    pub error: [f64; 3],
}

impl Estimate {
    /// Of pixels that all have the same expectation: the error is how they scatter, which counts what
    /// well-spread samples gain.
    pub fn of_equal_pixels(still: &Still) -> Self {
        let n = still.radiance.len() as f64;
        let mean = gpu::mean_rgb(still);
        let error = std::array::from_fn(|c| {
            let squares = |p: &[f32; 4]| (f64::from(p[c]) - mean[c]).powi(2);
            (still.radiance.iter().map(squares).sum::<f64>() / (n * (n - 1.0))).sqrt()
        });
        Self { mean, error }
    }

    /// Σ wᵢ·Lᵢ over the pixels, with the renderer's own variances.
    pub fn of_weighted_pixels(still: &Still, weight: impl Fn(usize) -> f64) -> Self {
        let variance = still.variance.as_ref().expect("the reference knows it");
        let mut sum = Self {
            mean: [0.0; 3],
            error: [0.0; 3],
        };
        for (i, pixel) in still.radiance.iter().enumerate() {
            for c in 0..3 {
                sum.mean[c] += weight(i) * f64::from(pixel[c]);
                sum.error[c] += weight(i).powi(2) * f64::from(variance[i][c]);
            }
        }
        sum.error = sum.error.map(f64::sqrt);
        sum
    }

    /// Mean over the pixels, with the renderer's own variances.
    pub fn of_pixels(still: &Still) -> Self {
        let n = still.radiance.len() as f64;
        Self::of_weighted_pixels(still, |_| 1.0 / n)
    }

    /// Times `factor`.
    #[must_use]
    pub fn scaled(self, factor: f64) -> Self {
        Self {
            mean: self.mean.map(|v| v * factor),
            error: self.error.map(|v| v * factor),
        }
    }

    /// Sum of independent estimates.
    #[must_use]
    pub fn plus(self, other: Self) -> Self {
        Self {
            mean: std::array::from_fn(|c| self.mean[c] + other.mean[c]),
            error: std::array::from_fn(|c| self.error[c].hypot(other.error[c])),
        }
    }

    /// Fails where a channel lies farther from `expected` than `tolerance` + 4 standard errors.
    pub fn assert_channel(&self, name: &str, channel: usize, expected: f64, tolerance: f64) {
        let (mean, error) = (self.mean[channel], self.error[channel]);
        let off = mean - expected;
        println!(
            "{name}: {mean:.6e} ± {error:.1e} for {expected:.6e} ({:+.2} sigma)",
            off / error.max(1e-30)
        );
        assert!(
            off.abs() <= tolerance + SIGMAS * error,
            "{name}, channel {channel}: {mean:.6e} ± {error:.1e} for {expected:.6e}"
        );
    }

    /// The same of green, for grey scenes.
    pub fn assert_near(&self, name: &str, expected: f64, tolerance: f64) {
        self.assert_channel(name, 1, expected, tolerance);
    }

    /// Fails where two independent estimates differ by more than 4 standard errors of the difference.
    pub fn assert_equals(&self, name: &str, other: &Self, channels: &[(usize, usize)]) {
        for (own, others) in channels {
            let error = self.error[*own].hypot(other.error[*others]);
            let both = Self {
                mean: [self.mean[*own]; 3],
                error: [error; 3],
            };
            both.assert_near(name, other.mean[*others], 0.0);
        }
    }
}
