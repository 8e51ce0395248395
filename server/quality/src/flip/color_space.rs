//! Colour spaces of FLIP: linear RGB, CIE XYZ, `YCxCz` (opponent, linear) and L\*a\*b\*.

/// XYZ from linear sRGB: the papers' rational numbers, rounded.
const XYZ_FROM_RGB: [[f32; 3]; 3] = [
    [0.412_386_57, 0.357_591_48, 0.180_450_48],
    [0.212_636_83, 0.715_182_96, 0.072_180_2],
    [0.019_330_62, 0.119_197_16, 0.950_372_6],
];

/// Its inverse.
const RGB_FROM_XYZ: [[f32; 3]; 3] = [
    [3.241_003_3, -1.537_399, -0.498_615_98],
    [-0.969_224_3, 1.875_93, 0.041_554_224],
    [0.055_639_42, -0.204_011_21, 1.057_149],
];

/// XYZ of white.
const WHITE: [f32; 3] = [0.950_428_55, 1.0, 1.088_900_4];

fn multiply(matrix: &[[f32; 3]; 3], v: [f32; 3]) -> [f32; 3] {
    std::array::from_fn(|i| matrix[i][0] * v[0] + matrix[i][1] * v[1] + matrix[i][2] * v[2])
}

/// XYZ relative to white.
fn relative_xyz(rgb: [f32; 3]) -> [f32; 3] {
    let xyz = multiply(&XYZ_FROM_RGB, rgb);
    std::array::from_fn(|i| xyz[i] / WHITE[i])
}

/// Linear RGB, clamped to [0, 1], as planes of Y, Cx (red–green) and Cz (blue–yellow).
pub(super) fn opponent(pixels: &[[f32; 3]]) -> [Vec<f32>; 3] {
    let mut planes = [(); 3].map(|()| Vec::with_capacity(pixels.len()));
    for pixel in pixels {
        let [x, y, z] = relative_xyz(pixel.map(|value| value.clamp(0.0, 1.0)));
        planes[0].push(116.0 * y - 16.0);
        planes[1].push(500.0 * (x - y));
        planes[2].push(200.0 * (y - z));
    }
    planes
}

/// Linear RGB, clamped to [0, 1], from `YCxCz`.
pub(super) fn rgb_from_opponent([luminance, cx, cz]: [f32; 3]) -> [f32; 3] {
    let y = (luminance + 16.0) / 116.0;
    let xyz = [
        (y + cx / 500.0) * WHITE[0],
        y * WHITE[1],
        (y - cz / 200.0) * WHITE[2],
    ];
    multiply(&RGB_FROM_XYZ, xyz).map(|value| value.clamp(0.0, 1.0))
}

/// L\*a\*b\* of linear RGB, a and b scaled by lightness (Hunt effect: colours fade in the dark).
pub(super) fn hunt_lab(rgb: [f32; 3]) -> [f32; 3] {
    let curve = |t: f32| {
        let delta = 6.0_f32 / 29.0;
        if t > delta.powi(3) {
            t.cbrt()
        } else {
            t / (3.0 * delta * delta) + 4.0 / 29.0
        }
    };
    let [x, y, z] = relative_xyz(rgb).map(curve);
    let lightness = 116.0 * y - 16.0;
    let hunt = 0.01 * lightness;
    [lightness, hunt * 500.0 * (x - y), hunt * 200.0 * (y - z)]
}

/// `HyAB`: city-block in lightness, Euclidean in colour; made for large differences.
pub(super) fn hyab(a: [f32; 3], b: [f32; 3]) -> f32 {
    (a[0] - b[0]).abs() + (a[1] - b[1]).hypot(a[2] - b[2])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_way_to_opponent_space_and_back_is_the_identity() {
        for rgb in [[0.2, 0.5, 0.9], [1.0, 0.0, 0.0], [0.0; 3], [1.0; 3]] {
            let planes = opponent(&[rgb]);
            let back = rgb_from_opponent([planes[0][0], planes[1][0], planes[2][0]]);
            for c in 0..3 {
                assert!((back[c] - rgb[c]).abs() < 1e-4, "{rgb:?} {back:?}");
            }
        }
    }

    #[test]
    fn white_has_lightness_100_and_no_colour() {
        let [lightness, a, b] = hunt_lab([1.0; 3]);
        assert!((lightness - 100.0).abs() < 1e-3, "{lightness}");
        assert!(a.abs() < 1e-2 && b.abs() < 1e-2, "{a} {b}");
    }
}
