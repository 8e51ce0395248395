//! Files a picture is written to.

mod exr;
mod png;

use std::path::Path;

use anyhow::bail;
use tyndall_picture::Metadata;
use tyndall_render::Still;

/// File format, by extension.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// Every layer the renderer yields, linear, 32-bit float.
    Exr,
    /// Displayed picture, 8-bit sRGB.
    Png,
}

impl Format {
    /// The format of a file name.
    pub fn of(path: &Path) -> anyhow::Result<Self> {
        match path.extension().and_then(|extension| extension.to_str()) {
            Some("exr") => Ok(Self::Exr),
            Some("png") => Ok(Self::Png),
            _ => bail!("{}: the file name must end in .exr or .png", path.display()),
        }
    }
}

/// Writes `still`; the file appears under its name only when it is complete.
pub fn write(
    path: &Path,
    format: Format,
    still: &Still,
    metadata: &Metadata,
) -> anyhow::Result<()> {
    let partial = path.with_extension("partial");
    let written = match format {
        Format::Exr => exr::write(&partial, still, metadata),
        Format::Png => png::write(&partial, still),
    };
    if let Err(error) = written {
        // The write's error matters; a leftover that cannot be removed does not.
        std::fs::remove_file(&partial).unwrap_or_default();
        return Err(error);
    }
    std::fs::rename(&partial, path)?;
    Ok(())
}
