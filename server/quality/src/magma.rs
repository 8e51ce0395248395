//! The colour map of FLIP's error pictures: black, purple, orange, pale yellow.
//!
//! A polynomial of degree 6 through matplotlib's `magma` (Smith and van der Walt 2015, CC0), fitted
//! by Matt Zucker (2019, CC0); within 0.02 of the table.

const COEFFICIENTS: [[f32; 3]; 7] = [
    [-0.002_136_485, -0.000_749_655, -0.005_386_128],
    [0.251_660_54, 0.677_523_24, 2.494_026_6],
    [8.353_717, -3.577_719_5, 0.314_467_9],
    [-27.668_734, 14.264_73, -13.649_213],
    [52.176_14, -27.943_606, 12.944_169],
    [-50.768_525, 29.046_583, 4.234_153],
    [18.655_706, -11.489_774, -5.601_961_5],
];

/// sRGB-encoded colour of an error in [0, 1]; values outside count as the nearer end, NaN as 1.
pub fn magma(error: f32) -> [u8; 3] {
    let t = if error.is_nan() {
        1.0
    } else {
        error.clamp(0.0, 1.0)
    };
    std::array::from_fn(|c| {
        let value = COEFFICIENTS.iter().rev().fold(0.0, |sum, k| sum * t + k[c]);
        (value.clamp(0.0, 1.0) * 255.0 + 0.5) as u8
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_map_runs_through_the_tables_knots() {
        // matplotlib 3.9, magma(0), (64), (128), (192), (255), as 8-bit sRGB.
        let table = [
            (0.0, [0, 0, 4]),
            (64.0 / 255.0, [81, 18, 124]),
            (128.0 / 255.0, [183, 55, 121]),
            (192.0 / 255.0, [252, 137, 97]),
            (1.0, [252, 253, 191]),
        ];
        for (t, expected) in table {
            let found = magma(t);
            for c in 0..3 {
                let difference = i32::from(found[c]) - expected[c];
                assert!(difference.abs() <= 5, "{t}: {found:?}, not {expected:?}");
            }
        }
        assert_eq!(magma(f32::NAN), magma(7.0));
    }
}
