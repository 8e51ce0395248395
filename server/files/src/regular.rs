//! Regular files and nothing else: opening a pipe waits for its other end, and a device has no end.

use std::fs::{File, FileType, Metadata, OpenOptions};
use std::io::{self, ErrorKind, Read as _};
use std::path::Path;

/// Why a file was not read.
#[derive(Debug, thiserror::Error)]
pub enum ReadError {
    /// It cannot be opened or read, or is no regular file.
    #[error(transparent)]
    Io(#[from] io::Error),
    /// It holds more than allowed.
    #[error("{found} bytes, the limit is {limit}")]
    TooLarge {
        /// Its length. Unit: byte.
        found: u64,
        /// How long it may be. Unit: byte.
        limit: u64,
    },
}

/// Opens a regular file, which the second value gives the length of. Unit: byte.
///
/// # Errors
/// The system's reason, or which kind of file it is instead.
pub fn open(path: &Path) -> io::Result<(File, u64)> {
    check(&path.metadata()?)?;
    let mut options = OpenOptions::new();
    options.read(true);
    // What the path names may be another file by now; with this flag no file keeps its opener waiting.
    #[cfg(unix)]
    std::os::unix::fs::OpenOptionsExt::custom_flags(&mut options, libc::O_NONBLOCK);
    let file = options.open(path)?;
    let metadata = file.metadata()?;
    check(&metadata)?;
    Ok((file, metadata.len()))
}

/// Reads a whole regular file of at most `limit` bytes.
///
/// # Errors
/// [`ReadError`].
pub fn read(path: &Path, limit: u64) -> Result<Vec<u8>, ReadError> {
    let (file, length) = open(path)?;
    if length > limit {
        return Err(ReadError::TooLarge {
            found: length,
            limit,
        });
    }
    let mut bytes = Vec::with_capacity(usize::try_from(length).unwrap_or(0));
    // The file may grow while it is read.
    let found = file.take(limit.saturating_add(1)).read_to_end(&mut bytes)? as u64;
    if found > limit {
        return Err(ReadError::TooLarge { found, limit });
    }
    Ok(bytes)
}

/// Refuses what is no regular file by the name of its kind.
///
/// # Errors
/// [`ErrorKind::InvalidInput`].
pub fn check(metadata: &Metadata) -> io::Result<()> {
    if metadata.is_file() {
        return Ok(());
    }
    let message = format!("{}, not a regular file", kind(metadata.file_type()));
    Err(io::Error::new(ErrorKind::InvalidInput, message))
}

fn kind(found: FileType) -> &'static str {
    if found.is_dir() {
        return "a folder";
    }
    #[cfg(unix)]
    {
        use std::os::unix::fs::FileTypeExt as _;
        if found.is_fifo() {
            return "a named pipe";
        }
        if found.is_socket() {
            return "a socket";
        }
        if found.is_block_device() || found.is_char_device() {
            return "a device";
        }
    }
    "something else"
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_regular_files_are_opened_and_others_keep_nobody_waiting() {
        let folder = tempfile::tempdir().unwrap();
        let text = |path: &Path| open(path).unwrap_err().to_string();
        assert_eq!(text(folder.path()), "a folder, not a regular file");
        #[cfg(unix)]
        {
            assert_eq!(text(Path::new("/dev/zero")), "a device, not a regular file");
            let socket = folder.path().join("socket");
            let _listener = std::os::unix::net::UnixListener::bind(&socket).unwrap();
            assert_eq!(text(&socket), "a socket, not a regular file");
            let pipe = folder.path().join("pipe");
            let made = std::process::Command::new("mkfifo").arg(&pipe).status();
            assert!(made.unwrap().success());
            assert_eq!(text(&pipe), "a named pipe, not a regular file");
        }
        let file = folder.path().join("file");
        std::fs::write(&file, b"seven b").unwrap();
        assert_eq!(open(&file).unwrap().1, 7);
        assert_eq!(read(&file, 7).unwrap(), b"seven b");
        let error = read(&file, 6).unwrap_err();
        assert_eq!(error.to_string(), "7 bytes, the limit is 6");
    }
}
