//! Files a picture is written to.

use std::path::Path;

use anyhow::bail;
use tyndall_still::Format;

/// The format of a file name.
pub fn format(path: &Path) -> anyhow::Result<Format> {
    match Format::of(path) {
        Some(format) => Ok(format),
        None => bail!(
            "{}: the file name must end in .exr, .png or .jpg",
            path.display()
        ),
    }
}

/// Writes a file that appears under its name only when it is complete.
pub fn write(path: &Path, bytes: &[u8]) -> anyhow::Result<()> {
    let partial = path.with_extension("partial");
    if let Err(error) = std::fs::write(&partial, bytes) {
        // The write's error matters; a leftover that cannot be removed does not.
        std::fs::remove_file(&partial).unwrap_or_default();
        return Err(error.into());
    }
    std::fs::rename(&partial, path)?;
    Ok(())
}
