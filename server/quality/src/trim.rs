//! Leaving out the worst pixels: where a light lies inside fog, one pixel can hold more square error
//! than all others (radiance goes as 1/distance there, and its error has infinite variance).

/// Share of pixels that trimmed measures leave out.
const SHARE: f64 = 0.001;

/// Indices of the pixels that stay when the worst 0.1 % (rounded up, so at least one; but one pixel
/// always stays) by `error` are left out.
pub(crate) fn kept(error: &[f64]) -> Vec<usize> {
    let dropped = (SHARE * error.len() as f64).ceil() as usize;
    let count = error.len().saturating_sub(dropped).max(1).min(error.len());
    let mut order: Vec<usize> = (0..error.len()).collect();
    order.sort_by(|a, b| error[*a].total_cmp(&error[*b]));
    order.truncate(count);
    order
}

/// Mean of `values` over `indices`.
pub(crate) fn mean_at(values: &[f64], indices: &[usize]) -> f64 {
    indices.iter().map(|i| values[*i]).sum::<f64>() / indices.len().max(1) as f64
}

/// Mean of `values` without their worst 0.1 %.
pub(crate) fn trimmed_mean(values: &[f64]) -> f64 {
    mean_at(values, &kept(values))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_thousandth_is_left_out_rounded_up_and_one_pixel_stays() {
        let errors = |count: usize| (0..count).map(|i| i as f64).collect::<Vec<_>>();
        assert_eq!(kept(&errors(2000)).len(), 1998);
        assert_eq!(kept(&errors(2001)).len(), 1998);
        assert_eq!(kept(&errors(5)), [0, 1, 2, 3]);
        assert_eq!(kept(&errors(1)), [0]);
        assert!(kept(&[]).is_empty());
        assert_eq!(trimmed_mean(&[1.0, 9.0, 3.0]), 2.0);
    }
}
