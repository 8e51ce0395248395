//! Why a measurement failed.

use std::path::PathBuf;

use tyndall_picture::PictureError;
use tyndall_quality::QualityError;
use tyndall_render::RenderError;
use tyndall_scene::SceneError;

use crate::pm_ref::PmRefError;

/// Why a measurement failed.
#[derive(Debug, thiserror::Error)]
pub enum BenchError {
    /// The scene could not be rendered.
    #[error(transparent)]
    Render(#[from] RenderError),
    /// Two pictures could not be compared.
    #[error(transparent)]
    Metric(#[from] QualityError),
    /// A picture could not be read or written.
    #[error(transparent)]
    Picture(#[from] PictureError),
    /// A scene with other settings is not valid.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// A reference scene could not be converted.
    #[error(transparent)]
    PmRef(#[from] PmRefError),
    /// A folder or file could not be made or read.
    #[error("{}: {source}", file.display())]
    Io {
        /// The file or folder.
        file: PathBuf,
        /// The system's reason.
        source: std::io::Error,
    },
    /// Rows could not be written as CSV.
    #[error("rows as CSV: {0}")]
    Csv(#[from] csv::Error),
    /// The other renderer can't be run.
    #[error("peer {peer}: {what}")]
    Peer {
        /// Which renderer.
        peer: &'static str,
        /// What is missing or went wrong.
        what: String,
    },
}

impl BenchError {
    pub(crate) fn io(file: impl Into<PathBuf>, source: std::io::Error) -> Self {
        Self::Io {
            file: file.into(),
            source,
        }
    }
}
