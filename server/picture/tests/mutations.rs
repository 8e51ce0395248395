//! What `tyndall compare` reads: ten thousand changed files of each kind are read or refused, and soon.

#![allow(
    clippy::unwrap_used,
    reason = "helpers of tests, too, fail by unwrapping"
)]

use std::io::{Cursor, Write as _};
use std::path::Path;
use std::time::Duration;

use tyndall_mutations::{Kind, attack};
use tyndall_picture::{Layers, Metadata, encode_png, read, write_exr};

const SOON: Duration = Duration::from_secs(2);

/// A folder for files that are written again and again, in memory where the system has one there.
fn folder() -> tempfile::TempDir {
    let memory = Path::new("/dev/shm");
    let made = if memory.is_dir() {
        tempfile::tempdir_in(memory)
    } else {
        tempfile::tempdir()
    };
    made.unwrap()
}

fn attack_file(name: &str, seed: Vec<u8>) {
    let folder = folder();
    let path = folder.path().join(name);
    attack(name, &[seed], Kind::Binary, SOON, |bytes| {
        std::fs::write(&path, bytes).unwrap();
        read(&path).is_ok()
    });
}

fn array() -> Vec<u8> {
    let header = "{'descr': '<f4', 'fortran_order': False, 'shape': (2, 2, 3), }";
    let mut bytes = b"\x93NUMPY\x01\x00\x46\x00".to_vec();
    bytes.extend(format!("{header:<69}\n").bytes());
    bytes.extend((0..12_u8).flat_map(|i| f32::from(i).to_le_bytes()));
    bytes
}

#[test]
fn changed_exr_pictures_are_harmless() {
    let folder = folder();
    let path = folder.path().join("seed.exr");
    let layers = Layers {
        width: 3,
        height: 2,
        beauty: vec![[0.5, 1.0, 2.0]; 6],
        variance: Some(vec![[0.25; 3]; 6]),
        depth: Some(vec![3.0; 6]),
        ..Layers::default()
    };
    write_exr(&path, &layers, &Metadata::default()).unwrap();
    attack_file("picture.exr", std::fs::read(&path).unwrap());
}

#[test]
fn changed_arrays_of_pixels_are_harmless() {
    attack_file("picture.npy", array());
}

#[test]
fn changed_archives_of_pixels_are_harmless() {
    let mut writer = zip::ZipWriter::new(Cursor::new(Vec::new()));
    for name in ["mean.npy", "stderr.npy"] {
        let options = zip::write::SimpleFileOptions::default();
        writer.start_file(name, options).unwrap();
        writer.write_all(&array()).unwrap();
    }
    attack_file("picture.npz", writer.finish().unwrap().into_inner());
}

#[test]
fn changed_displayed_pictures_are_harmless() {
    let pixels: Vec<[u8; 3]> = (0..32).map(|i| [i, 2 * i, 3 * i]).collect();
    attack_file("picture.png", encode_png(8, 4, &pixels).unwrap());
}
