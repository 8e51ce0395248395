//! Arrays beside the JSON, each in a file of its own.

use std::path::Path;

use crate::error::BenchError;

/// Arrays beside the JSON.
#[derive(Debug)]
pub(super) struct Files<'a> {
    folder: &'a Path,
}

impl<'a> Files<'a> {
    /// They go into `folder`.
    pub(super) fn new(folder: &'a Path) -> Self {
        Self { folder }
    }

    /// Writes a file; returns its name.
    pub(super) fn write(&mut self, name: &str, bytes: &[u8]) -> Result<String, BenchError> {
        let file = self.folder.join(name);
        std::fs::write(&file, bytes).map_err(|source| BenchError::io(file, source))?;
        Ok(name.to_owned())
    }

    /// Writes numbers as little-endian float32; returns the file's name.
    pub(super) fn floats(
        &mut self,
        name: &str,
        values: impl Iterator<Item = f32>,
    ) -> Result<String, BenchError> {
        let bytes: Vec<u8> = values.flat_map(f32::to_le_bytes).collect();
        self.write(name, &bytes)
    }
}
