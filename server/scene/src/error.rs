//! The errors of loading a scene: where, what was found, what is allowed.

/// Why a scene was refused.
#[derive(Debug, thiserror::Error)]
pub enum SceneError {
    /// A value of the description is missing, of the wrong type or out of range.
    #[error("{}: found {found}, allowed {allowed}", shown(path))]
    Invalid {
        /// JSON path such as `media[0].sigma_s`; empty for the whole document.
        path: String,
        /// What stands there.
        found: String,
        /// What may stand there.
        allowed: String,
    },
    /// The text is not JSON.
    #[error("line {line}, column {column}: {message}")]
    Syntax {
        /// Line, from 1.
        line: usize,
        /// Column, from 1.
        column: usize,
        /// What is wrong there.
        message: String,
    },
    /// A file can't be read.
    #[error("{}: {file}: {source}", shown(path))]
    Io {
        /// JSON path that names the file; empty for the scene file itself.
        path: String,
        /// The file as the scene names it.
        file: String,
        /// The system's reason.
        source: std::io::Error,
    },
    /// A model or image file is malformed or uses something unsupported.
    #[error("{}: {file}: {location}: {message}", shown(path))]
    Model {
        /// JSON path that names the file.
        path: String,
        /// The file as the scene names it.
        file: String,
        /// Where in the file, such as `meshes[3].primitives[0].indices`.
        location: String,
        /// What is wrong there.
        message: String,
    },
    /// Something is larger than [`crate::Limits`] allows.
    #[error("{}: {what} is {found}, the limit is {limit}", shown(path))]
    Limit {
        /// JSON path of what is too large.
        path: String,
        /// The limited quantity, with its unit.
        what: &'static str,
        /// How much there is.
        found: u64,
        /// How much there may be.
        limit: u64,
    },
}

/// An empty path means the document.
fn shown(path: &str) -> &str {
    if path.is_empty() { "scene" } else { path }
}

impl SceneError {
    /// A value that is wrong.
    pub(crate) fn invalid(
        path: impl std::fmt::Display,
        found: impl Into<String>,
        allowed: impl Into<String>,
    ) -> Self {
        Self::Invalid {
            path: path.to_string(),
            found: found.into(),
            allowed: allowed.into(),
        }
    }

    /// The JSON path the error is about, if it is about one.
    pub fn path(&self) -> Option<&str> {
        let path = match self {
            Self::Syntax { .. } => return None,
            Self::Invalid { path, .. }
            | Self::Io { path, .. }
            | Self::Model { path, .. }
            | Self::Limit { path, .. } => path,
        };
        (!path.is_empty()).then_some(path)
    }

    /// A short stable name of the kind of error, for protocols and metrics.
    pub fn code(&self) -> &'static str {
        match self {
            Self::Invalid { .. } => "invalid",
            Self::Syntax { .. } => "syntax",
            Self::Io { .. } => "io",
            Self::Model { .. } => "model",
            Self::Limit { .. } => "limit",
        }
    }
}

/// Shortens text from a file so that an error message stays one line.
pub(crate) fn abbreviate(text: &str) -> String {
    const LONGEST: usize = 80;
    let one_line: String = text
        .chars()
        .take(LONGEST)
        .map(|c| if c.is_control() { ' ' } else { c })
        .collect();
    if text.chars().nth(LONGEST).is_some() {
        format!("{one_line}…")
    } else {
        one_line
    }
}
