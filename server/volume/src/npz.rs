//! Several arrays of numpy in one zip file (`.npz`).

use std::io::{Cursor, Read, Seek};

use zip::ZipArchive;
use zip::read::ZipFile;
use zip::result::ZipError;

use crate::npy;
use crate::select::{Candidate, choose};
use crate::{Grid, ReadOptions, VolumeError, VolumeLimits};

/// Most arrays that a file may hold.
const MAX_ARRAYS: usize = 4096;
/// Bytes that an array may have however few of them are stored.
const FREE_BYTES: u64 = 64 << 20;
/// Bytes that an array may have for each byte that is stored, beyond the free ones: smoke in empty space
/// needs less, and a thousand zeros a byte, the most that deflate can do, are work without content.
const MOST_INFLATION: u64 = 256;

/// Reads an array of a file that is held whole, as [`npy::read_bytes`] does.
///
/// The array is `options.grid`, else the one named "density", else the only one.
///
/// # Errors
/// As [`npy::read_bytes`]; [`VolumeError::Invalid`] too if no array has the name, or none was named
/// where there are several.
pub fn read_bytes(
    bytes: &[u8],
    options: &ReadOptions,
    limits: &VolumeLimits,
) -> Result<Grid, VolumeError> {
    VolumeError::within("bytes of the file", bytes.len() as u64, limits.file_bytes)?;
    read_from(Cursor::new(bytes), options, limits)
}

/// Reads the array `name` as [`npy::Array::read`] does; `None` if the file holds none of that name.
///
/// # Errors
/// As [`npy::Array::read`]; [`VolumeError::Invalid`] too if the file is no zip file of arrays.
pub fn read_array(
    source: impl Read + Seek,
    name: &str,
    most_bytes: u64,
    axes: &str,
) -> Result<Option<npy::Array>, VolumeError> {
    let mut archive = open(source)?;
    let mut file = match archive.by_name(&format!("{name}.npy")) {
        Ok(file) => file,
        Err(ZipError::FileNotFound) => return Ok(None),
        Err(error) => return Err(broken(error)),
    };
    let length = inflated(&file)?;
    npy::Array::read(&mut file, length, most_bytes, axes).map(Some)
}

/// Reads an array of a file.
pub(crate) fn read_from(
    source: impl Read + Seek,
    options: &ReadOptions,
    limits: &VolumeLimits,
) -> Result<Grid, VolumeError> {
    let mut archive = open(source)?;
    let candidates: Vec<Candidate> = archive
        .file_names()
        .map(|name| {
            let name = name.strip_suffix(".npy").unwrap_or(name);
            Candidate {
                name: name.to_owned(),
                address: name.to_owned(),
                obstacle: None,
            }
        })
        .collect();
    let only = options.grid.is_none() && !candidates.iter().any(|one| one.name == "density");
    if only && candidates.len() > 1 {
        let named = choose(&candidates, Some("density"));
        return named.and(Err(VolumeError::invalid("grid", "none named", "a name")));
    }
    let index = choose(&candidates, options.grid.as_deref())?;
    let mut file = archive.by_index(index).map_err(broken)?;
    let length = inflated(&file)?;
    npy::read_from(&mut file, length, &candidates[index].name, limits)
}

/// Length of an array once it is inflated, if what is stored can be worth it. Unit: byte.
fn inflated<R: Read>(file: &ZipFile<'_, R>) -> Result<u64, VolumeError> {
    let (length, stored) = (file.size(), file.compressed_size());
    let most = FREE_BYTES.saturating_add(stored.saturating_mul(MOST_INFLATION));
    if length > most {
        let found = format!("{length} bytes from {stored}");
        let allowed = format!("at most {most} from so few");
        return Err(VolumeError::invalid("array", found, allowed));
    }
    Ok(length)
}

fn open<R: Read + Seek>(source: R) -> Result<ZipArchive<R>, VolumeError> {
    let archive = ZipArchive::new(source).map_err(broken)?;
    if archive.len() > MAX_ARRAYS {
        let found = format!("{}", archive.len());
        let allowed = format!("at most {MAX_ARRAYS}");
        return Err(VolumeError::invalid("arrays", found, allowed));
    }
    Ok(archive)
}

fn broken(error: ZipError) -> VolumeError {
    match error {
        ZipError::Io(error) => error.into(),
        ZipError::UnsupportedArchive(what) => VolumeError::unsupported("archive", what),
        other => VolumeError::invalid("archive", other.to_string(), "a zip file of arrays"),
    }
}
