//! Pearson's test of counts against expectations.

#![allow(clippy::print_stdout, reason = "tests print what they measure")]

/// A false alarm of one test is 2.1e-6 (4.6 standard deviations); of all fifty, 1e-4 (Šidák).
pub const DEVIATIONS: f64 = 4.6;

/// Fewest expected in a bin; less expected bins are pooled.
const FEWEST: f64 = 10.0;

/// Fails where the counts do not come from the expectations. Degrees of freedom: bins less one.
pub fn assert_fits(name: &str, counts: &[u32], expected: &[f64]) {
    assert_eq!(counts.len(), expected.len());
    let (mut sum, mut bins) = (0.0, 0_u32);
    let (mut pooled, mut pooled_expected) = (0.0, 0.0);
    for (count, expected) in counts.iter().zip(expected) {
        pooled += f64::from(*count);
        pooled_expected += expected;
        if pooled_expected >= FEWEST {
            sum += (pooled - pooled_expected).powi(2) / pooled_expected;
            bins += 1;
            (pooled, pooled_expected) = (0.0, 0.0);
        }
    }
    // What is left over joins as a bin of its own, with at least one expected.
    sum += (pooled - pooled_expected).powi(2) / pooled_expected.max(1.0);
    assert!(bins > 1, "{name}: {bins} bins");
    let freedom = f64::from(bins - 1);
    let limit = critical(freedom);
    println!("{name}: chi squared {sum:.1}, {freedom} degrees of freedom, limit {limit:.1}");
    assert!(
        sum <= limit,
        "{name}: chi squared {sum:.1} above {limit:.1}, {freedom} degrees"
    );
}

/// The same for equally likely bins.
pub fn assert_uniform(name: &str, counts: &[u32]) {
    let all: f64 = counts.iter().map(|c| f64::from(*c)).sum();
    assert_fits(name, counts, &vec![all / counts.len() as f64; counts.len()]);
}

/// Exceeded once in 480,000 trials (Wilson and Hilferty 1931).
fn critical(freedom: f64) -> f64 {
    let variance = 2.0 / (9.0 * freedom);
    freedom * (1.0 - variance + DEVIATIONS * variance.sqrt()).powi(3)
}

/// Index of the bin of `u` in [0, 1] among `bins` equal ones.
pub fn bin(u: f64, bins: usize) -> usize {
    assert!((-1e-6..=1.0 + 1e-6).contains(&u), "{u} is not in [0, 1]");
    ((u * bins as f64) as usize).min(bins - 1)
}
