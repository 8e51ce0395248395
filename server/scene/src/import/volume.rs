//! Density grids of files.

use std::path::Path;

use tyndall_volume::{Grid, VolumeError, VolumeLimits};

use super::volume_stand_in::{ReadOptions, read};

/// Reads a grid: the named one, or the one that the format calls the density.
pub(super) fn read_grid(
    file: &Path,
    name: Option<&str>,
    limits: &VolumeLimits,
) -> Result<Grid, VolumeError> {
    let options = ReadOptions {
        grid: name.map(str::to_owned),
    };
    read(file, &options, limits)
}
