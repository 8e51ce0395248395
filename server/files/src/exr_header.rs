//! What an OpenEXR file says of its size, checked before any of its pixels are decoded.

use std::io::Cursor;

use exr::meta::MetaData;

use crate::guard::{DecoderFailed, guarded};

/// How much an OpenEXR file may hold.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ExrLimits {
    /// Pixels of each part.
    pub pixels: u64,
    /// Channels of each part: every block is decoded with all of them.
    pub channels: usize,
    /// Bytes of all samples of a part once they are decoded.
    pub bytes: u64,
}

/// Why a header is refused.
#[derive(Debug, thiserror::Error)]
pub enum ExrError {
    /// It has too many pixels.
    #[error("the number of pixels is {found}, the limit is {limit}")]
    Pixels {
        /// How many it has.
        found: u64,
        /// How many it may have.
        limit: u64,
    },
    /// It holds too much of something else, or does not follow the format.
    #[error("{0}")]
    Unfit(String),
    /// The decoder is at fault.
    #[error(transparent)]
    Decoder(#[from] DecoderFailed),
}

/// Reads the header of a file and refuses what is too large.
///
/// # Errors
/// [`ExrError`], before memory is taken for pixels.
pub fn read_exr_header(bytes: &[u8], limits: ExrLimits) -> Result<MetaData, ExrError> {
    let read = guarded("OpenEXR", || {
        MetaData::read_from_buffered(Cursor::new(bytes), false)
    });
    let meta = read?.map_err(|error| ExrError::Unfit(error.to_string()))?;
    for header in &meta.headers {
        let (width, height) = (header.layer_size.width(), header.layer_size.height());
        let unfit = |what: String| Err(ExrError::Unfit(what));
        if width == 0 || height == 0 {
            return unfit(format!("{width}×{height} pixels, allowed 1 or more"));
        }
        let found = (width as u64).saturating_mul(height as u64);
        if found > limits.pixels {
            let limit = limits.pixels;
            return Err(ExrError::Pixels { found, limit });
        }
        let channels = header.channels.list.len();
        if channels > limits.channels {
            return unfit(format!("{channels} channels, allowed {}", limits.channels));
        }
        let samples = header.channels.list.iter();
        let each: u64 = samples
            .map(|channel| channel.sample_type.bytes_per_sample() as u64)
            .sum();
        let bytes = found.saturating_mul(each);
        if bytes > limits.bytes {
            let allowed = limits.bytes;
            return unfit(format!("{bytes} bytes of samples, allowed {allowed}"));
        }
    }
    Ok(meta)
}
