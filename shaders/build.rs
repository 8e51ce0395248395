//! Links every line of `permutations.txt`; `link/` says how.

mod link;

use std::path::PathBuf;

use link::{Sources, link};

fn main() {
    let here = PathBuf::from(std::env::var_os("CARGO_MANIFEST_DIR").expect("set by cargo"));
    link(&Sources {
        list: here.join("permutations.txt"),
        root: here.join("wesl"),
        mounts: Vec::new(),
    });
}
