//! The files that come with a job: into a folder of their own, within bounds, whatever their names say.

use std::collections::BTreeMap;
use std::fs::{File, OpenOptions};
use std::io::{self, Read, Seek, Write as _};
use std::path::{Path, PathBuf};

use sha2::{Digest as _, Sha256};
use tyndall_files::relative::why_not_relative;
use tyndall_files::{DecoderFailed, guarded};
use zip::ZipArchive;
use zip::result::ZipError;

use crate::results::{hex, sha256};

/// Longest name of a file. Unit: byte.
const LONGEST_NAME: usize = 512;
/// Bytes that an archive may unpack to however short it is.
const FREE_BYTES: u64 = 64 << 20;
/// Bytes that an archive may unpack to for each of its own, beyond the free ones.
const MOST_INFLATION: u64 = 256;

/// How much may be uploaded with one job.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct UploadLimits {
    /// Files.
    pub files: usize,
    /// All files together, unpacked. Unit: byte.
    pub bytes: u64,
}

impl Default for UploadLimits {
    fn default() -> Self {
        Self {
            files: 1000,
            bytes: 1 << 30,
        }
    }
}

/// Why an upload was refused.
#[derive(Debug, thiserror::Error)]
pub enum UploadError {
    /// A file's name is no plain relative path, or was used before.
    #[error("the file \"{name}\", {why}; allowed are relative paths inside the upload, each once")]
    Name {
        /// The name, cut short.
        name: String,
        /// What is wrong with it.
        why: &'static str,
    },
    /// There is too much of something.
    #[error("{what} is {found}, the limit is {limit}")]
    TooLarge {
        /// Of what.
        what: &'static str,
        /// How much there is.
        found: u64,
        /// How much there may be.
        limit: u64,
    },
    /// The archive does not follow its format.
    #[error("the archive is no zip file that can be read: {0}")]
    Archive(String),
    /// The decoder is at fault.
    #[error(transparent)]
    Decoder(#[from] DecoderFailed),
    /// A file cannot be written.
    #[error("the upload cannot be stored: {0}")]
    Io(#[from] io::Error),
}

/// A folder that receives the files of one job.
#[derive(Debug)]
pub struct Upload {
    folder: PathBuf,
    limits: UploadLimits,
    bytes: u64,
    /// Hashes by name.
    files: BTreeMap<String, String>,
}

/// A file that is being received.
#[derive(Debug)]
pub struct Receiving<'a> {
    upload: &'a mut Upload,
    file: File,
    hash: Sha256,
    name: String,
}

impl Upload {
    /// Receives into a new folder.
    ///
    /// # Errors
    /// [`UploadError::Io`] where the folder is there already or cannot be made.
    pub fn new(folder: PathBuf, limits: UploadLimits) -> Result<Self, UploadError> {
        if let Some(parent) = folder.parent() {
            std::fs::create_dir_all(parent)?;
        }
        std::fs::create_dir(&folder)?;
        Ok(Self {
            folder,
            limits,
            bytes: 0,
            files: BTreeMap::new(),
        })
    }

    /// Where the files are.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.files.is_empty()
    }

    /// Whether there is one of this name.
    pub fn has(&self, name: &str) -> bool {
        self.files.contains_key(name)
    }

    /// A hash of all names and contents; empty without files.
    pub fn content(&self) -> String {
        if self.files.is_empty() {
            return String::new();
        }
        let lines = self
            .files
            .iter()
            .map(|(name, hash)| format!("{hash} {name}\n"));
        sha256(lines.collect::<String>().as_bytes())
    }

    /// Begins a file.
    ///
    /// # Errors
    /// [`UploadError`] where the name is unfit or there are too many files.
    pub fn begin(&mut self, name: &str) -> Result<Receiving<'_>, UploadError> {
        let refuse = |why| UploadError::Name {
            name: name.chars().take(80).filter(|c| !c.is_control()).collect(),
            why,
        };
        if name.len() > LONGEST_NAME {
            return Err(refuse("which is too long"));
        }
        if let Some(why) = why_not_relative(name) {
            return Err(refuse(why));
        }
        if name.split('/').any(|part| part.is_empty() || part == ".") {
            return Err(refuse("which has an empty part"));
        }
        let found = self.files.len() as u64 + 1;
        if found > self.limits.files as u64 {
            return Err(UploadError::TooLarge {
                what: "the number of uploaded files",
                found,
                limit: self.limits.files as u64,
            });
        }
        let path = self.folder.join(name);
        let parent = path.parent().unwrap_or(&self.folder);
        // A part of the path may be a file by now.
        let taken = |error: io::Error| match error.kind() {
            io::ErrorKind::AlreadyExists | io::ErrorKind::NotADirectory => {
                refuse("which was there before")
            }
            _ => UploadError::Io(error),
        };
        std::fs::create_dir_all(parent).map_err(taken)?;
        let file = OpenOptions::new().write(true).create_new(true).open(&path);
        Ok(Receiving {
            file: file.map_err(taken)?,
            hash: Sha256::new(),
            name: name.to_owned(),
            upload: self,
        })
    }

    /// Unpacks a zip file of `length` bytes.
    ///
    /// # Errors
    /// [`UploadError`] at the first entry that is unfit.
    pub fn unpack(
        &mut self,
        archive: impl Read + Seek + Send,
        length: u64,
    ) -> Result<(), UploadError> {
        let most = length
            .saturating_mul(MOST_INFLATION)
            .saturating_add(FREE_BYTES);
        guarded("zip", || self.unpack_at_most(archive, most))?
    }

    fn unpack_at_most(&mut self, archive: impl Read + Seek, most: u64) -> Result<(), UploadError> {
        let broken = |error: ZipError| UploadError::Archive(error.to_string());
        let mut archive = ZipArchive::new(archive).map_err(broken)?;
        let before = self.bytes;
        for index in 0..archive.len() {
            let mut entry = archive.by_index(index).map_err(broken)?;
            let name = entry.name().to_owned();
            if entry.is_symlink() {
                let name = name.chars().take(80).filter(|c| !c.is_control()).collect();
                let why = "which is a link";
                return Err(UploadError::Name { name, why });
            }
            if entry.is_dir() {
                continue;
            }
            let mut receiving = self.begin(&name)?;
            let mut buffer = vec![0; 64 << 10];
            loop {
                let read = entry.read(&mut buffer);
                let read = read.map_err(|error| UploadError::Archive(error.to_string()))?;
                if read == 0 {
                    break;
                }
                receiving.write(&buffer[..read])?;
                let found = receiving.upload.bytes - before;
                if found > most {
                    return Err(UploadError::TooLarge {
                        what: "what the archive unpacks to, in bytes, for its own size,",
                        found,
                        limit: most,
                    });
                }
            }
            receiving.finish()?;
        }
        Ok(())
    }
}

impl Receiving<'_> {
    /// Takes a piece of the file.
    ///
    /// # Errors
    /// [`UploadError`] where there are too many bytes or the disk is full.
    pub fn write(&mut self, bytes: &[u8]) -> Result<(), UploadError> {
        let found = self.upload.bytes.saturating_add(bytes.len() as u64);
        if found > self.upload.limits.bytes {
            return Err(UploadError::TooLarge {
                what: "the size of all uploaded files in bytes",
                found,
                limit: self.upload.limits.bytes,
            });
        }
        self.upload.bytes = found;
        self.hash.update(bytes);
        Ok(self.file.write_all(bytes)?)
    }

    /// The file is whole.
    ///
    /// # Errors
    /// [`UploadError::Io`].
    pub fn finish(mut self) -> Result<(), UploadError> {
        self.file.flush()?;
        let hash = hex(&self.hash.finalize());
        self.upload.files.insert(self.name, hash);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use std::io::Cursor;

    use super::*;
    use zip::write::{SimpleFileOptions, ZipWriter};

    const LIMITS: UploadLimits = UploadLimits {
        files: 3,
        bytes: 1000,
    };

    fn upload(folder: &tempfile::TempDir, name: &str) -> Upload {
        Upload::new(folder.path().join(name), LIMITS).unwrap()
    }

    fn add(upload: &mut Upload, name: &str, bytes: &[u8]) -> Result<(), UploadError> {
        let mut receiving = upload.begin(name)?;
        receiving.write(bytes)?;
        receiving.finish()
    }

    fn archive(entries: &[(&str, &[u8])]) -> Vec<u8> {
        let mut writer = ZipWriter::new(Cursor::new(Vec::new()));
        for (name, bytes) in entries {
            writer
                .start_file(*name, SimpleFileOptions::default())
                .unwrap();
            writer.write_all(bytes).unwrap();
        }
        writer.finish().unwrap().into_inner()
    }

    fn unpack(upload: &mut Upload, archive: &[u8]) -> Result<(), UploadError> {
        upload.unpack(Cursor::new(archive), archive.len() as u64)
    }

    #[test]
    fn files_lie_where_their_names_say_and_content_is_names_and_bytes() {
        let folder = tempfile::tempdir().unwrap();
        let (mut one, mut two) = (upload(&folder, "one"), upload(&folder, "two"));
        add(&mut one, "scene.json", b"{}").unwrap();
        add(&mut one, "maps/sky.exr", b"sky").unwrap();
        let zipped = archive(&[("maps/sky.exr", b"sky"), ("scene.json", b"{}")]);
        unpack(&mut two, &zipped).unwrap();
        assert_eq!(one.content(), two.content());
        let sky = std::fs::read(two.folder().join("maps/sky.exr")).unwrap();
        assert_eq!(sky, b"sky");
        add(&mut two, "more", b"").unwrap();
        assert_ne!(one.content(), two.content());
    }

    #[test]
    fn tricks_with_names_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        let mut upload = upload(&folder, "upload");
        add(&mut upload, "a", b"1").unwrap();
        for name in [
            "",
            "/etc/passwd",
            "../a",
            "b/../../a",
            "c:\\a",
            "a",
            "a/b",
            "b//c",
            "./b",
            "b/.",
            "\0",
        ] {
            let refused = add(&mut upload, name, b"2");
            assert!(
                matches!(refused, Err(UploadError::Name { .. })),
                "{name:?}: {refused:?}"
            );
        }
        let outside = unpack(&mut upload, &archive(&[("../../a", b"x")]));
        assert!(
            matches!(outside, Err(UploadError::Name { .. })),
            "{outside:?}"
        );
        let mut writer = ZipWriter::new(Cursor::new(Vec::new()));
        let options = SimpleFileOptions::default();
        writer.add_symlink("link", "/etc/passwd", options).unwrap();
        let link = writer.finish().unwrap().into_inner();
        let refused = unpack(&mut upload, &link);
        assert!(
            matches!(refused, Err(UploadError::Name { .. })),
            "{refused:?}"
        );
        assert!(!upload.folder().join("link").exists());
    }

    #[test]
    fn too_much_is_refused_before_it_is_written() {
        let folder = tempfile::tempdir().unwrap();
        let mut many = upload(&folder, "many");
        for name in ["a", "b", "c"] {
            add(&mut many, name, b"").unwrap();
        }
        assert!(matches!(
            add(&mut many, "d", b""),
            Err(UploadError::TooLarge { .. })
        ));
        let mut long = upload(&folder, "long");
        let refused = add(&mut long, "a", &[0; 1001]);
        assert!(
            matches!(refused, Err(UploadError::TooLarge { .. })),
            "{refused:?}"
        );
        let mut bomb = Upload::new(
            folder.path().join("bomb"),
            UploadLimits {
                files: 10,
                bytes: 1 << 40,
            },
        )
        .unwrap();
        let zeros = vec![0; 96 << 20];
        let refused = unpack(&mut bomb, &archive(&[("zeros", &zeros)]));
        assert!(
            matches!(refused, Err(UploadError::TooLarge { .. })),
            "{refused:?}"
        );
        assert!(matches!(
            unpack(&mut bomb, b"PK no zip"),
            Err(UploadError::Archive(_))
        ));
    }
}
