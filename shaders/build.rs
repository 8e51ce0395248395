//! Links every line of every `permutations.txt` below `wesl/`; `link/` says how.

mod link;

use std::path::{Path, PathBuf};

use link::{Sources, link};

fn main() {
    let here = PathBuf::from(std::env::var_os("CARGO_MANIFEST_DIR").expect("set by cargo"));
    let root = here.join("wesl");
    let mut lists = lists_below(&root);
    lists.sort();
    link(&Sources {
        lists,
        root,
        mounts: Vec::new(),
    });
}

/// The list of a folder and those of the folders in it.
fn lists_below(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).expect("the folder is readable");
    let paths = entries.map(|entry| entry.expect("the folder is readable").path());
    paths
        .flat_map(|path| {
            if path.is_dir() {
                lists_below(&path)
            } else if path.ends_with("permutations.txt") {
                vec![path]
            } else {
                Vec::new()
            }
        })
        .collect()
}
