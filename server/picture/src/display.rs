//! Radiance as it is shown: exposure, filmic curve, sRGB.
//!
//! The same steps as `shaders/wesl/image/tonemap.wesl`, without its dither.

use tyndall_quality::Image;

/// Largest radiance times exposure that the curve tells apart from infinity.
const BRIGHTEST: f32 = 1e6;

/// Linear displayed value of radiance, already exposed: Narkowicz's 2015 fit of ACES.
fn filmic(radiance: f32) -> f32 {
    let x = radiance.clamp(0.0, BRIGHTEST);
    ((x * (2.51 * x + 0.03)) / (x * (2.43 * x + 0.59) + 0.14)).clamp(0.0, 1.0)
}

/// Exposed and tone-mapped pixels, linear in [0, 1]. Unit of `exposure_ev`: factor of 2. Values that
/// are not finite become 0.
pub fn exposed(image: &Image, exposure_ev: f32) -> Vec<[f32; 3]> {
    let scale = exposure_ev.exp2();
    let shown = |value: f32| {
        if value.is_finite() {
            filmic(value * scale)
        } else {
            0.0
        }
    };
    image.rgb().iter().map(|rgb| rgb.map(shown)).collect()
}

/// The displayed picture: 8-bit sRGB.
pub fn display(image: &Image, exposure_ev: f32) -> Vec<[u8; 3]> {
    let byte = |value: f32| (encode_srgb(value) * 255.0 + 0.5) as u8;
    let pixels = exposed(image, exposure_ev);
    pixels.into_iter().map(|rgb| rgb.map(byte)).collect()
}

/// sRGB of a linear value, IEC 61966-2-1. Range: [0, 1] to [0, 1].
fn encode_srgb(linear: f32) -> f32 {
    if linear <= 0.003_130_8 {
        12.92 * linear
    } else {
        1.055 * linear.powf(1.0 / 2.4) - 0.055
    }
}

/// Linear value of sRGB, IEC 61966-2-1. Range: [0, 1] to [0, 1].
pub(crate) fn decode_srgb(encoded: f32) -> f32 {
    if encoded <= 0.040_45 {
        encoded / 12.92
    } else {
        ((encoded + 0.055) / 1.055).powf(2.4)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn black_is_black_and_brightness_grows_to_white() {
        let image = Image::new(3, 1, vec![[0.0; 3], [0.18; 3], [1e9; 3]]).unwrap();
        let shown = display(&image, 0.0);
        assert_eq!(shown[0], [0; 3]);
        assert!(shown[1][0] > 100 && shown[1][0] < 160, "{:?}", shown[1]);
        assert_eq!(shown[2], [255; 3]);
        for byte in 0..=255_u8 {
            let value = f32::from(byte) / 255.0;
            assert!((encode_srgb(decode_srgb(value)) - value).abs() < 1e-5);
        }
    }
}
