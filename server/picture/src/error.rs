//! Why a picture can't be written or read.

use std::path::PathBuf;

use tyndall_files::regular::{self, ReadError};
use tyndall_quality::QualityError;

/// Largest file that is read. Unit: byte.
const LARGEST: u64 = 4 << 30;

/// Why a picture can't be written or read.
#[derive(Debug, thiserror::Error)]
pub enum PictureError {
    /// The file can't be opened, read or written.
    #[error("{}: {source}", file.display())]
    Io {
        /// The file.
        file: PathBuf,
        /// The system's reason.
        source: std::io::Error,
    },
    /// The file's content is not what its ending says, or not one of the kinds that are read.
    #[error("{}: {what}", file.display())]
    Content {
        /// The file.
        file: PathBuf,
        /// What was found and what is expected.
        what: String,
    },
    /// The ending names no format.
    #[error("{}: expected a file that ends in {allowed}", file.display())]
    Format {
        /// The file.
        file: PathBuf,
        /// The endings that are known.
        allowed: &'static str,
    },
    /// A layer has another number of pixels than the picture.
    #[error("layer {layer}: {found} pixels, expected {expected}")]
    Layer {
        /// Name of the layer.
        layer: &'static str,
        /// Pixels of the layer.
        found: usize,
        /// Width times height.
        expected: usize,
    },
    /// The pixels make no image.
    #[error(transparent)]
    Image(#[from] QualityError),
    /// A PNG could not be encoded.
    #[error("cannot encode PNG: {0}")]
    Png(#[from] png::EncodingError),
    /// A scene could not be written as JSON.
    #[error("the scene cannot be written as JSON: {0}")]
    Json(String),
}

impl PictureError {
    pub(crate) fn io(file: &std::path::Path, source: std::io::Error) -> Self {
        Self::Io {
            file: file.to_owned(),
            source,
        }
    }

    pub(crate) fn content(file: &std::path::Path, what: impl std::fmt::Display) -> Self {
        Self::Content {
            file: file.to_owned(),
            what: what.to_string(),
        }
    }
}

/// The bytes of a regular file.
pub(crate) fn whole(path: &std::path::Path) -> Result<Vec<u8>, PictureError> {
    regular::read(path, LARGEST).map_err(|error| match error {
        ReadError::Io(source) => PictureError::io(path, source),
        too_large @ ReadError::TooLarge { .. } => PictureError::content(path, too_large),
    })
}
