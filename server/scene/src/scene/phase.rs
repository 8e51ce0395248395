//! Phase functions: into which directions a medium scatters.
//!
//! What is asked of them on the CPU is asked here, on the device in `shaders/wesl/medium/phase.wesl`; the
//! numbers of the kinds are the same there.

use std::f64::consts::PI;

/// How the light that a medium scatters is spread over directions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum PhaseFunction {
    /// One lobe (Henyey and Greenstein 1941).
    HenyeyGreenstein {
        /// Mean cosine, +1 forward. Range: [−0.999, 0.999].
        g: f32,
    },
    /// The sum of two such lobes, as clouds have.
    TwoLobes {
        /// Mean cosine of the forward lobe. Range: [−0.999, 0.999].
        g_forward: f32,
        /// Mean cosine of the backward lobe. Range: [−0.999, 0.999].
        g_backward: f32,
        /// What of the light the forward lobe scatters. Range: [0, 1].
        forward_share: f32,
    },
}

/// A phase function as the device takes it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PhaseParameters {
    /// Number of the kind in `shaders/wesl/medium/phase.wesl`.
    pub kind: u32,
    /// What the kind makes of them is said there.
    pub parameters: [f32; 3],
}

impl PhaseFunction {
    /// The kind and its parameters for the device.
    pub fn parameters(&self) -> PhaseParameters {
        match *self {
            Self::HenyeyGreenstein { g } => PhaseParameters {
                kind: 0,
                parameters: [g, 0.0, 0.0],
            },
            Self::TwoLobes {
                g_forward,
                g_backward,
                forward_share,
            } => PhaseParameters {
                kind: 1,
                parameters: [g_forward, g_backward, forward_share],
            },
        }
    }

    /// Whether it is a plain lobe, which pipelines evaluate without looking at the kind.
    pub fn is_henyey_greenstein(&self) -> bool {
        matches!(self, Self::HenyeyGreenstein { .. })
    }

    /// Whether it is the same in all directions.
    pub fn is_isotropic(&self) -> bool {
        self.largest_g() == 0.0
    }

    /// Largest |g| of a lobe: how narrow the narrowest is.
    pub fn largest_g(&self) -> f32 {
        match *self {
            Self::HenyeyGreenstein { g } => g.abs(),
            Self::TwoLobes {
                g_forward,
                g_backward,
                forward_share,
            } => {
                // A lobe without a share is none.
                let forward = if forward_share > 0.0 { g_forward } else { 0.0 };
                let backward = if forward_share < 1.0 { g_backward } else { 0.0 };
                forward.abs().max(backward.abs())
            }
        }
    }

    /// Mean cosine of the angle by which light turns, +1 forward.
    pub fn mean_cosine(&self) -> f64 {
        match *self {
            Self::HenyeyGreenstein { g } => f64::from(g),
            Self::TwoLobes {
                g_forward,
                g_backward,
                forward_share,
            } => mix(g_backward.into(), g_forward.into(), forward_share),
        }
    }

    /// Density of scattering by an angle of this cosine. Unit: sr⁻¹.
    pub fn value(&self, cosine: f64) -> f64 {
        match *self {
            Self::HenyeyGreenstein { g } => henyey_greenstein(cosine, g.into()),
            Self::TwoLobes {
                g_forward,
                g_backward,
                forward_share,
            } => mix(
                henyey_greenstein(cosine, g_backward.into()),
                henyey_greenstein(cosine, g_forward.into()),
                forward_share,
            ),
        }
    }

    /// The largest value. Unit: sr⁻¹.
    pub fn peak(&self) -> f64 {
        // Lobes are convex in the cosine, and so is their sum: it is largest at one of the ends.
        self.value(1.0).max(self.value(-1.0))
    }
}

/// From `a` at a share of 0 to `b` at 1.
fn mix(a: f64, b: f64, share: f32) -> f64 {
    a + (b - a) * f64::from(share)
}

/// One lobe of mean cosine `g`, without the cancellation of 1 + g² − 2g·cosθ. Unit: sr⁻¹.
fn henyey_greenstein(cosine: f64, g: f64) -> f64 {
    let along = if g < 0.0 { -cosine } else { cosine };
    let magnitude = g.abs();
    let squared = (1.0 - magnitude).powi(2) + 2.0 * magnitude * (1.0 - along);
    (1.0 - magnitude) * (1.0 + magnitude) / (4.0 * PI * squared * squared.sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Phase functions of every kind.
    fn examples() -> Vec<PhaseFunction> {
        let mut found = Vec::new();
        for g in [-0.9, -0.3, 0.0, 0.6, 0.9] {
            found.push(PhaseFunction::HenyeyGreenstein { g });
        }
        for [g_forward, g_backward, forward_share] in [
            [0.8, -0.3, 0.7],
            [0.9, -0.9, 0.25],
            [0.6, 0.9, 0.0],
            [0.0, -0.9, 1.0],
            [0.0, 0.0, 0.5],
        ] {
            found.push(PhaseFunction::TwoLobes {
                g_forward,
                g_backward,
                forward_share,
            });
        }
        found
    }

    #[test]
    fn values_integrate_to_one_with_the_mean_cosine_below_the_peak() {
        let count = 200_000;
        for phase in examples() {
            let (mut total, mut mean, mut most) = (0.0, 0.0, 0.0_f64);
            for i in 0..count {
                // Even in the angle, so that narrow lobes are seen.
                let angle = PI * (f64::from(i) + 0.5) / f64::from(count);
                let cosine = angle.cos();
                let value = phase.value(cosine);
                let share = value * 2.0 * PI * angle.sin() * PI / f64::from(count);
                total += share;
                mean += share * cosine;
                most = most.max(value);
            }
            let exact = phase.mean_cosine();
            assert!((total - 1.0).abs() < 1e-6, "{phase:?}: {total}");
            assert!((mean - exact).abs() < 1e-6, "{phase:?}: {mean}");
            let peak = phase.peak();
            assert!(
                most <= peak * (1.0 + 1e-12) && most > 0.98 * peak,
                "{phase:?}: {most} of {peak}"
            );
        }
    }

    #[test]
    fn only_lobes_of_mean_cosine_zero_are_isotropic() {
        for phase in examples() {
            let flat = (phase.value(1.0) - phase.value(-1.0)).abs() < 1e-12;
            assert_eq!(phase.is_isotropic(), flat, "{phase:?}");
        }
    }
}
