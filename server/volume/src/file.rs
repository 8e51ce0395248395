//! Any file, by its ending.

use std::fs::File;
use std::io::{BufReader, Read};
use std::path::Path;

use tyndall_files::{guarded, regular};

use crate::{Grid, VolumeError, VolumeLimits, npy, npz, nvdb, raw, vdb, vol};

/// The endings that [`read`] knows, without the dot.
pub const ENDINGS: [&str; 6] = ["vdb", "nvdb", "vol", "npy", "npz", "raw"];

/// Which part of a file is read.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct ReadOptions {
    /// Name of the grid, or of the array: of several with one name, `density[1]` is the second.
    /// `None`: the one named "density", else the first of floats. Formats that hold one grid
    /// without a name have to be read with `None`.
    pub grid: Option<String>,
}

/// Reads a grid of a file; its ending, in any case, says which format it has ([`ENDINGS`]).
///
/// Positions are those of the file: its world space for OpenVDB and NanoVDB, the file's bounding
/// box for Mitsuba's volumes and raw voxels, the unit cube for arrays.
///
/// # Errors
/// [`VolumeError::Unsupported`] for other endings and for what a format's module names,
/// [`VolumeError::Invalid`] where the bytes do not follow the format, [`VolumeError::Limit`] before
/// more is read or allocated than `limits` allow, [`VolumeError::Io`] if the file cannot be read.
pub fn read(
    path: &Path,
    options: &ReadOptions,
    limits: &VolumeLimits,
) -> Result<Grid, VolumeError> {
    let ending = path
        .extension()
        .map(|ending| ending.to_string_lossy().to_ascii_lowercase())
        .unwrap_or_default();
    if !ENDINGS.contains(&ending.as_str()) {
        let what = format!(
            "{ending:?} ({} are read)",
            ENDINGS.map(|known| format!(".{known}")).join(", ")
        );
        return Err(VolumeError::unsupported("file ending", what));
    }
    let (file, length) = regular::open(path)?;
    VolumeError::within("bytes of the file", length, limits.file_bytes)?;
    guarded("grids", || {
        decode(path, &ending, file, length, options, limits)
    })?
}

/// Reads a file whose ending is known; some formats hold parts that others' decoders read.
fn decode(
    path: &Path,
    ending: &str,
    mut file: File,
    length: u64,
    options: &ReadOptions,
    limits: &VolumeLimits,
) -> Result<Grid, VolumeError> {
    match ending {
        "vdb" => vdb::read_bytes(&whole(&mut file, length)?, options, limits),
        "nvdb" => nvdb::read_bytes(&whole(&mut file, length)?, options, limits),
        "npz" => npz::read_from(BufReader::new(file), options, limits),
        "npy" => {
            refuse_name(options)?;
            npy::read_from(&mut BufReader::new(file), length, "", limits)
        }
        "vol" => {
            refuse_name(options)?;
            vol::read_from(&mut BufReader::new(file), length, limits)
        }
        _ => {
            refuse_name(options)?;
            let sidecar = raw::sidecar(path)?;
            raw::read_from(&mut BufReader::new(file), length, &sidecar, limits)
        }
    }
}

/// Formats of one grid without a name have none of the wanted name.
pub(crate) fn refuse_name(options: &ReadOptions) -> Result<(), VolumeError> {
    match &options.grid {
        None => Ok(()),
        Some(name) => Err(VolumeError::invalid(
            "grid",
            crate::select::shown(name),
            "no name: the format holds one grid, which has none",
        )),
    }
}

/// The file's bytes, as many as it had when it was opened.
fn whole(file: &mut File, length: u64) -> Result<Vec<u8>, VolumeError> {
    let mut bytes = Vec::new();
    bytes.reserve_exact(length as usize);
    file.take(length).read_to_end(&mut bytes)?;
    Ok(bytes)
}
