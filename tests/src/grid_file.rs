//! Density grids that tests make: a `NumPy` file in a folder of its own.

#![allow(clippy::print_stdout, reason = "a folder that stays is told")]

use std::path::{Path, PathBuf};

/// A temporary folder with `grid.npy` in it, gone with the value.
#[derive(Debug)]
pub struct Folder(PathBuf);

impl Folder {
    /// Where it is.
    pub fn path(&self) -> &Path {
        &self.0
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        if let Err(error) = std::fs::remove_dir_all(&self.0) {
            println!("{}: {error}", self.0.display());
        }
    }
}

/// A `NumPy` file of `samples`³ values, x fastest, in a folder of its own.
pub fn folder(name: &str, samples: usize, value: impl Fn(usize) -> f32) -> Folder {
    let folder = std::env::temp_dir().join(format!("tyndall-grids-{}-{name}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a temporary folder");
    let mut header = format!(
        "{{'descr': '<f4', 'fortran_order': False, 'shape': ({samples}, {samples}, {samples}), }}"
    );
    while (header.len() + 11) % 64 != 0 {
        header.push(' ');
    }
    header.push('\n');
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend((header.len() as u16).to_le_bytes());
    bytes.extend(header.as_bytes());
    for i in 0..samples.pow(3) {
        bytes.extend(value(i).to_le_bytes());
    }
    std::fs::write(folder.join("grid.npy"), bytes).expect("a temporary file");
    Folder(folder)
}
