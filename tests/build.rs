//! Links the tests' own shaders, `probes.txt`, with the product's sources: the product has none of them.

// The code of another crate's build script: a crate for both would be built once more for the target,
// with all of WESL's compiler.
#[path = "../shaders/link/mod.rs"]
mod link;

use std::path::PathBuf;

use link::{Sources, link};

fn main() {
    let here = PathBuf::from(std::env::var_os("CARGO_MANIFEST_DIR").expect("set by cargo"));
    link(&Sources {
        lists: vec![here.join("probes.txt")],
        root: here.join("../shaders/wesl"),
        mounts: vec![("probes".to_owned(), here.join("probes"))],
    });
}
