//! Files of a scene: nothing outside the scene's folder is ever opened.

use std::collections::BTreeSet;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, PoisonError};

use tyndall_files::regular::{self, ReadError};
use tyndall_files::relative::why_not_relative;

use crate::error::{SceneError, abbreviate};
use crate::limits::Limits;

/// Checks that `file` is a plain relative path that can't leave the folder it is relative to.
///
/// # Errors
/// [`SceneError::Invalid`] at `path` that says why.
pub(crate) fn check_relative(path: &str, file: &str) -> Result<(), SceneError> {
    match why_not_relative(file) {
        None => Ok(()),
        Some(why) => Err(SceneError::invalid(
            path,
            format!("\"{}\", {why}", abbreviate(file)),
            "a relative path inside the scene's folder",
        )),
    }
}

/// The folder that all files of a scene lie in, with a budget of bytes to read from it.
pub(crate) struct Folder<'a> {
    /// Canonical; `None` if the scene has no folder.
    root: Option<PathBuf>,
    limits: &'a Limits,
    bytes_read: AtomicU64,
    /// Every file that was found, by its name in the folder.
    found: Mutex<BTreeSet<String>>,
}

impl<'a> Folder<'a> {
    /// Opens a scene's folder, or stands for none.
    pub(crate) fn open(folder: Option<&Path>, limits: &'a Limits) -> Result<Self, SceneError> {
        let root = folder.map(Path::canonicalize).transpose();
        let root = root.map_err(|source| SceneError::Io {
            path: String::new(),
            file: folder.map_or_else(String::new, |folder| folder.display().to_string()),
            source,
        })?;
        Ok(Self {
            root,
            limits,
            bytes_read: AtomicU64::new(0),
            found: Mutex::default(),
        })
    }

    /// The real place of a file, checked to be a regular file below the folder.
    pub(crate) fn locate(&self, path: &str, file: &str) -> Result<PathBuf, SceneError> {
        check_relative(path, file)?;
        let Some(root) = &self.root else {
            return Err(SceneError::invalid(
                path,
                format!("the file \"{file}\" in a scene without a folder"),
                "no files, as the scene was not loaded from one",
            ));
        };
        let io = |source: io::Error| SceneError::Io {
            path: path.to_owned(),
            file: file.to_owned(),
            source,
        };
        let real = root.join(file).canonicalize().map_err(io)?;
        if !real.starts_with(root) {
            return Err(SceneError::invalid(
                path,
                format!("\"{file}\", a link that leaves the scene's folder"),
                "a file inside the scene's folder",
            ));
        }
        regular::check(&real.metadata().map_err(io)?).map_err(io)?;
        self.note(file);
        Ok(real)
    }

    fn note(&self, file: &str) {
        let mut found = self.found.lock().unwrap_or_else(PoisonError::into_inner);
        let parts = file
            .split('/')
            .filter(|part| !part.is_empty() && *part != ".");
        found.insert(parts.collect::<Vec<_>>().join("/"));
    }

    /// The files that were found, by their names in the folder.
    pub(crate) fn found(&self) -> Vec<String> {
        let found = self.found.lock().unwrap_or_else(PoisonError::into_inner);
        found.iter().cloned().collect()
    }

    /// Checks that a file beside a located one, which a reader may open, doesn't leave the folder.
    pub(crate) fn check_companion(&self, path: &str, companion: &Path) -> Result<(), SceneError> {
        let Some(root) = &self.root else {
            return Ok(());
        };
        match companion.canonicalize() {
            Ok(real) if !real.starts_with(root) => {
                let name = companion.file_name().unwrap_or_default().to_string_lossy();
                Err(SceneError::invalid(
                    path,
                    format!("\"{name}\" beside the file, a link that leaves the scene's folder"),
                    "a file inside the scene's folder",
                ))
            }
            Ok(_inside) => {
                let name = companion.strip_prefix(root).ok().and_then(Path::to_str);
                if let Some(name) = name {
                    self.note(name);
                }
                Ok(())
            }
            // Absent ones are the reader's concern.
            Err(_absent) => Ok(()),
        }
    }

    /// Reads a whole file, if it is inside the folder and within the limits.
    pub(crate) fn read(&self, path: &str, file: &str) -> Result<Vec<u8>, SceneError> {
        let real = self.locate(path, file)?;
        let bytes = regular::read(&real, self.limits.file_bytes).map_err(|error| match error {
            ReadError::Io(source) => SceneError::Io {
                path: path.to_owned(),
                file: file.to_owned(),
                source,
            },
            ReadError::TooLarge { found, limit } => SceneError::Limit {
                path: path.to_owned(),
                what: "size of the file in bytes",
                found,
                limit,
            },
        })?;
        self.spend(path, bytes.len() as u64)?;
        Ok(bytes)
    }

    /// Takes bytes from the budget of the whole scene.
    pub(crate) fn spend(&self, path: &str, bytes: u64) -> Result<(), SceneError> {
        let before = self.bytes_read.fetch_add(bytes, Ordering::Relaxed);
        let found = before.saturating_add(bytes);
        if found > self.limits.total_bytes {
            return Err(SceneError::Limit {
                path: path.to_owned(),
                what: "size of all files in bytes",
                found,
                limit: self.limits.total_bytes,
            });
        }
        Ok(())
    }
}
