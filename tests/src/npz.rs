//! Reads `float32` arrays from `NumPy`'s `.npz`: a zip of `.npy` files.

use std::fs::File;
use std::io::Read as _;
use std::path::Path;

/// Array `name` of `file` in C order. Refuses anything but little-endian float32.
pub fn read_f32(file: &Path, name: &str) -> Result<Vec<f32>, String> {
    let fail = |what: &dyn std::fmt::Display| format!("{}: {name}: {what}", file.display());
    let archive = File::open(file).map_err(|error| fail(&error))?;
    let mut archive = zip::ZipArchive::new(archive).map_err(|error| fail(&error))?;
    let mut member = archive
        .by_name(&format!("{name}.npy"))
        .map_err(|error| fail(&error))?;
    let mut bytes = Vec::new();
    member
        .read_to_end(&mut bytes)
        .map_err(|error| fail(&error))?;
    // Magic, version, then the header's length: 2 bytes in version 1, 4 after.
    let (length_bytes, header_at) = match bytes.get(..8) {
        Some([0x93, b'N', b'U', b'M', b'P', b'Y', 1, _]) => (2, 10),
        Some([0x93, b'N', b'U', b'M', b'P', b'Y', _, _]) => (4, 12),
        _ => return Err(fail(&"not a .npy file")),
    };
    let length = bytes[8..8 + length_bytes]
        .iter()
        .rev()
        .fold(0, |sum, byte| sum << 8 | usize::from(*byte));
    let header = String::from_utf8_lossy(&bytes[header_at..header_at + length]);
    if !header.contains("'<f4'") || !header.contains("'fortran_order': False") {
        return Err(fail(&format_args!(
            "header {header} is not C-order float32"
        )));
    }
    Ok(bytemuck::pod_collect_to_vec(&bytes[header_at + length..]))
}
