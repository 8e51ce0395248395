//! Separable filters over planes whose edge pixels repeat outside.

use rayon::prelude::*;

/// A row of weights; the middle one belongs to the pixel itself.
pub(super) type Kernel = Vec<f32>;

/// `weight(x)` at x = −radius ..= radius. Unit of x: pixel.
pub(super) fn kernel(radius: usize, weight: impl Fn(f32) -> f32) -> Kernel {
    let radius = radius as isize;
    (-radius..=radius).map(|x| weight(x as f32)).collect()
}

/// The plane filtered along x by `horizontal` and along y by `vertical`.
pub(super) fn separable(
    plane: &[f32],
    (width, height): (usize, usize),
    horizontal: &[f32],
    vertical: &[f32],
) -> Vec<f32> {
    let radius = horizontal.len() / 2;
    let mut rows = vec![0.0; plane.len()];
    let lines = plane
        .par_chunks_exact(width)
        .zip(rows.par_chunks_exact_mut(width));
    lines.for_each_init(
        || vec![0.0; width + 2 * radius],
        |padded, (row, out)| {
            padded[..radius].fill(row[0]);
            padded[radius..radius + width].copy_from_slice(row);
            padded[radius + width..].fill(row[width - 1]);
            for (x, value) in out.iter_mut().enumerate() {
                let taps = padded[x..].iter().zip(horizontal);
                *value = taps.map(|(a, w)| a * w).sum();
            }
        },
    );
    let radius = (vertical.len() / 2) as isize;
    let mut result = vec![0.0; plane.len()];
    result
        .par_chunks_exact_mut(width)
        .enumerate()
        .for_each(|(y, out)| {
            for (i, weight) in vertical.iter().enumerate() {
                let from =
                    (y as isize + i as isize - radius).clamp(0, height as isize - 1) as usize;
                let row = &rows[from * width..(from + 1) * width];
                for (value, source) in out.iter_mut().zip(row) {
                    *value += weight * source;
                }
            }
        });
    result
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edges_repeat_outside() {
        let plane = [1.0, 2.0, 3.0, 4.0];
        let shift_left = [0.0, 0.0, 1.0];
        let keep = [0.0, 1.0, 0.0];
        assert_eq!(
            separable(&plane, (2, 2), &shift_left, &keep),
            [2.0, 2.0, 4.0, 4.0]
        );
        assert_eq!(
            separable(&plane, (2, 2), &keep, &shift_left),
            [3.0, 4.0, 3.0, 4.0]
        );
    }

    #[test]
    fn a_kernel_is_symmetric_about_its_middle() {
        assert_eq!(kernel(1, |x| x), [-1.0, 0.0, 1.0]);
    }
}
