//! Encoders: pictures survive as well as each codec promises.

#![allow(
    clippy::unwrap_used,
    reason = "a test that unwraps says where it failed"
)]

use tyndall_stream::encode::{Chroma, EncodeChoice, EncodeError, Encoder, Picture};

const WIDTH: u32 = 64;
const HEIGHT: u32 = 48;

/// A smooth gradient with a coloured edge in the middle.
fn gradient() -> Vec<u8> {
    (0..WIDTH * HEIGHT)
        .flat_map(|i| {
            let (x, y) = (i % WIDTH, i / WIDTH);
            let red = if x < WIDTH / 2 { 220 } else { 20 };
            [red, (x * 3) as u8, (y * 5) as u8, 255]
        })
        .collect()
}

fn encode(choice: EncodeChoice) -> Vec<u8> {
    let pixels = gradient();
    let picture = Picture {
        width: WIDTH,
        height: HEIGHT,
        rgba: &pixels,
    };
    let mut out = b"head".to_vec();
    Encoder::new()
        .unwrap()
        .encode(picture, choice, &mut out)
        .unwrap();
    assert_eq!(&out[..4], b"head", "what stood in front stays");
    out.split_off(4)
}

fn decode_jpeg(bytes: &[u8]) -> Vec<u8> {
    let image = turbojpeg::decompress(bytes, turbojpeg::PixelFormat::RGBA).unwrap();
    assert_eq!(
        (image.width, image.height),
        (WIDTH as usize, HEIGHT as usize)
    );
    image.pixels
}

fn mean_square_error(a: &[u8], b: &[u8]) -> f64 {
    let sum: f64 = a
        .iter()
        .zip(b)
        .map(|(&a, &b)| (f64::from(a) - f64::from(b)).powi(2))
        .sum();
    sum / a.len() as f64
}

#[test]
fn png_is_lossless() {
    let bytes = encode(EncodeChoice::Png);
    let mut reader = png::Decoder::new(std::io::Cursor::new(bytes))
        .read_info()
        .unwrap();
    let mut rgb = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut rgb).unwrap();
    assert_eq!((info.width, info.height), (WIDTH, HEIGHT));
    let expected: Vec<u8> = gradient()
        .chunks_exact(4)
        .flat_map(|pixel| pixel[..3].to_vec())
        .collect();
    assert_eq!(rgb, expected);
}

#[test]
fn jpeg_is_close_and_full_chroma_is_closer() {
    let jpeg = |quality, chroma| decode_jpeg(&encode(EncodeChoice::Jpeg { quality, chroma }));
    let quarter = mean_square_error(&gradient(), &jpeg(92, Chroma::Quarter));
    let full = mean_square_error(&gradient(), &jpeg(92, Chroma::Full));
    assert!(full < quarter, "{full} {quarter}");
    assert!(full < 10.0, "{full}");
}

#[test]
fn lower_quality_is_smaller() {
    let size = |quality| {
        encode(EncodeChoice::Jpeg {
            quality,
            chroma: Chroma::Quarter,
        })
        .len()
    };
    assert!(size(35) < size(75) && size(75) < size(92));
}

#[test]
fn one_encoder_serves_changing_sizes_and_codecs() {
    let mut encoder = Encoder::new().unwrap();
    for (width, height) in [(1, 1), (17, 3), (64, 48), (2, 200)] {
        let pixels = vec![128; 4 * (width * height) as usize];
        let picture = Picture {
            width,
            height,
            rgba: &pixels,
        };
        for choice in [
            EncodeChoice::Jpeg {
                quality: 75,
                chroma: Chroma::Quarter,
            },
            EncodeChoice::Png,
        ] {
            let mut out = Vec::new();
            encoder.encode(picture, choice, &mut out).unwrap();
            assert!(!out.is_empty());
        }
    }
}

#[test]
fn wrong_pictures_are_named_and_leave_the_output_alone() {
    let mut encoder = Encoder::new().unwrap();
    let mut out = vec![1, 2];
    for (width, height, bytes) in [(0, 0, 0), (4, 4, 63), (16_385, 1, 65_540)] {
        let pixels = vec![0; bytes];
        let picture = Picture {
            width,
            height,
            rgba: &pixels,
        };
        let error = encoder
            .encode(picture, EncodeChoice::Png, &mut out)
            .unwrap_err();
        assert!(matches!(error, EncodeError::Picture { .. }));
    }
    let picture = Picture {
        width: 1,
        height: 1,
        rgba: &[0; 4],
    };
    let choice = EncodeChoice::Jpeg {
        quality: 0,
        chroma: Chroma::Full,
    };
    let error = encoder.encode(picture, choice, &mut out).unwrap_err();
    assert!(matches!(error, EncodeError::Quality { found: 0 }));
    assert_eq!(out, [1, 2]);
}
