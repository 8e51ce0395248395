//! The folder of reference images and real data beside the repository; not everywhere present.

use std::path::PathBuf;

/// The folder, or `None` after saying aloud that `what` is skipped.
pub fn find(what: &str) -> Option<PathBuf> {
    let folder = std::env::var_os("TYNDALL_SHARED").map_or_else(
        || PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../shared")),
        PathBuf::from,
    );
    if folder.is_dir() {
        return Some(folder);
    }
    eprintln!("SKIPPED: {what}: {} is absent", folder.display());
    None
}
