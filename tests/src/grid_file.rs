//! Density grids that tests make: a `NumPy` file in a folder of its own.

/// A temporary folder with `grid.npy` in it, gone with the value.
pub use tempfile::TempDir as Folder;

/// A `NumPy` file of `samples`³ values, x fastest, in a folder of its own.
pub fn folder(name: &str, samples: usize, value: impl Fn(usize) -> f32) -> Folder {
    let folder = tempfile::Builder::new()
        .prefix(&format!("tyndall-{name}-"))
        .tempdir()
        .expect("a temporary folder");
    let header = format!(
        "{{'descr': '<f4', 'fortran_order': False, 'shape': ({samples}, {samples}, {samples}), }}\n"
    );
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend((header.len() as u16).to_le_bytes());
    bytes.extend(header.as_bytes());
    for i in 0..samples.pow(3) {
        bytes.extend(value(i).to_le_bytes());
    }
    std::fs::write(folder.path().join("grid.npy"), bytes).expect("a temporary file");
    folder
}
