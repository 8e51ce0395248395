//! Compression of finished frames, one file per codec.
//!
//! An [`Encoder`] keeps its codecs' working memory between frames, so one belongs to one thread.

mod jpeg;
mod png;

use crate::header::{Codec, MAX_SIDE};

/// How much colour detail a JPEG keeps.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Chroma {
    /// 4:2:0, a quarter of the chroma samples: small, for pictures in motion.
    Quarter,
    /// 4:4:4, every chroma sample: sharp coloured edges.
    Full,
}

/// How one frame is to be compressed; chosen by pacing.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum EncodeChoice {
    /// JPEG with `quality` from 1 to 100.
    Jpeg {
        /// Range: 1 to 100.
        quality: u8,
        /// Colour detail kept.
        chroma: Chroma,
    },
    /// Lossless PNG, compressed fast rather than well.
    Png,
}

impl EncodeChoice {
    /// The codec that the frame header names.
    pub const fn codec(self) -> Codec {
        match self {
            Self::Jpeg { .. } => Codec::Jpeg,
            Self::Png => Codec::Png,
        }
    }
}

/// An 8-bit sRGB picture, row 0 at the top; alpha is ignored.
#[derive(Debug, Clone, Copy)]
pub struct Picture<'a> {
    /// Unit: pixel.
    pub width: u32,
    /// Unit: pixel.
    pub height: u32,
    /// `4 · width · height` bytes.
    pub rgba: &'a [u8],
}

/// Why a picture could not be compressed.
#[derive(Debug, thiserror::Error)]
pub enum EncodeError {
    /// A side outside the range, or pixels that do not fit the size.
    #[error(
        "picture of {width}x{height} with {bytes} bytes, expected 4 a pixel and sides of 1 to {MAX_SIDE}"
    )]
    Picture {
        /// Unit: pixel.
        width: u32,
        /// Unit: pixel.
        height: u32,
        /// Length of the pixels.
        bytes: usize,
    },
    /// A JPEG quality outside 1 to 100.
    #[error("jpeg quality {found}, allowed are 1 to 100")]
    Quality {
        /// Quality asked for.
        found: u8,
    },
    /// The JPEG library refused.
    #[error("jpeg encoder failed: {0}")]
    Jpeg(#[from] turbojpeg::Error),
    /// The PNG library refused.
    #[error("png encoder failed: {0}")]
    Png(#[from] ::png::EncodingError),
}

/// All codecs, with their working memory.
#[derive(Debug)]
pub struct Encoder {
    jpeg: jpeg::JpegEncoder,
    png: png::PngEncoder,
}

impl Encoder {
    /// Prepares the codecs.
    ///
    /// # Errors
    /// When the JPEG library cannot allocate its state.
    pub fn new() -> Result<Self, EncodeError> {
        Ok(Self {
            jpeg: jpeg::JpegEncoder::new()?,
            png: png::PngEncoder::default(),
        })
    }

    /// Appends the compressed picture to `out`, so that a caller can leave room for the header.
    ///
    /// # Errors
    /// When the picture's size and bytes disagree or a codec fails; `out` then holds what it
    /// held before.
    pub fn encode(
        &mut self,
        picture: Picture<'_>,
        choice: EncodeChoice,
        out: &mut Vec<u8>,
    ) -> Result<(), EncodeError> {
        let Picture {
            width,
            height,
            rgba,
        } = picture;
        let fits = rgba.len() as u64 == 4 * u64::from(width) * u64::from(height);
        if !fits || !(1..=MAX_SIDE).contains(&width) || !(1..=MAX_SIDE).contains(&height) {
            return Err(EncodeError::Picture {
                width,
                height,
                bytes: rgba.len(),
            });
        }
        let start = out.len();
        let result = match choice {
            EncodeChoice::Jpeg { quality, chroma } => {
                self.jpeg.encode(picture, quality, chroma, out)
            }
            EncodeChoice::Png => self.png.encode(picture, out),
        };
        if result.is_err() {
            out.truncate(start);
        }
        result
    }
}
