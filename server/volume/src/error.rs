//! Why a grid cannot be read.

/// Why a grid cannot be read. The scene adds which file it was.
#[derive(Debug, thiserror::Error)]
pub enum VolumeError {
    /// The bytes do not follow the format.
    #[error("{field}: found {found}, allowed: {allowed}")]
    Invalid {
        /// Which field of the file.
        field: String,
        /// What is there.
        found: String,
        /// What may be there.
        allowed: String,
    },
    /// The file follows its format but uses a part of it that is not read.
    #[error("{field}: {what} is not supported")]
    Unsupported {
        /// Which field of the file.
        field: String,
        /// The part of the format.
        what: String,
    },
    /// Larger than allowed.
    #[error("{what}: {found} is above the limit of {limit}")]
    Limit {
        /// What is too large.
        what: &'static str,
        /// How large it is.
        found: u64,
        /// How large it may be.
        limit: u64,
    },
    /// A decoder is at fault.
    #[error(transparent)]
    Decoder(#[from] tyndall_files::DecoderFailed),
    /// The file cannot be read.
    #[error("cannot be read: {0}")]
    Io(#[from] std::io::Error),
}

impl VolumeError {
    /// The bytes do not follow the format.
    pub fn invalid(
        field: impl Into<String>,
        found: impl Into<String>,
        allowed: impl Into<String>,
    ) -> Self {
        Self::Invalid {
            field: field.into(),
            found: found.into(),
            allowed: allowed.into(),
        }
    }

    /// The file follows its format but uses a part of it that is not read.
    pub fn unsupported(field: impl Into<String>, what: impl Into<String>) -> Self {
        Self::Unsupported {
            field: field.into(),
            what: what.into(),
        }
    }

    /// Refuses what is larger than allowed.
    pub(crate) fn within(what: &'static str, found: u64, limit: u64) -> Result<(), Self> {
        if found > limit {
            return Err(Self::Limit { what, found, limit });
        }
        Ok(())
    }
}
