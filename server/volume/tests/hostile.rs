//! Broken files: 10,000 of each format, made from whole ones by small changes that follow from a fixed seed,
//! more with `TYNDALL_MUTATIONS`. Reading one never panics, never takes much memory, and is quick.

#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use std::io::{Cursor, Read, Write};
use std::path::PathBuf;
use std::sync::OnceLock;
use std::time::Instant;

use proptest::prelude::*;
use proptest::test_runner::{RngAlgorithm, TestRng, TestRunner};
use tyndall_mutations::cases;
use tyndall_volume::{Grid, ReadOptions, VolumeError, VolumeLimits, npy, npz, nvdb, raw, vdb, vol};

const LIMITS: VolumeLimits = VolumeLimits {
    file_bytes: 1 << 20,
    grid_bytes: 4 << 20,
};
/// What all the reading of a test may add to the process. The harness's threads reserve 64 MiB of
/// addresses each. Unit: KiB.
const MAX_GROWTH: u64 = 1 << 20;

fn fixture(name: &str) -> Vec<u8> {
    let folder = PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/fixtures"));
    std::fs::read(folder.join(name)).unwrap()
}

/// A change to a file. Places are fractions of its length; small ones favour headers.
#[derive(Debug, Clone)]
enum Change {
    Truncate(f64),
    Flip(f64, u8),
    Number(f64, u64, usize),
    Splice(f64, f64, usize),
}

fn place() -> impl Strategy<Value = f64> {
    prop_oneof![0.0..1.0_f64, (0.0..1.0_f64).prop_map(|at| at.powi(6))]
}

fn change() -> impl Strategy<Value = Change> {
    let extreme = prop_oneof![
        Just(0),
        Just(1),
        Just(u64::MAX),
        Just(i64::MAX as u64),
        Just(i64::MIN as u64),
        Just(0x7fff_ffff),
        Just(0x8000_0000),
        Just(0x7ff8_0000_0000_0000),
        Just(0x7fc0_0000),
        any::<u64>(),
        0..4096_u64,
    ];
    prop_oneof![
        1 => place().prop_map(Change::Truncate),
        3 => (place(), any::<u8>()).prop_map(|(at, bit)| Change::Flip(at, bit % 8)),
        4 => (place(), extreme, prop_oneof![Just(1), Just(2), Just(4), Just(8)])
            .prop_map(|(at, value, bytes)| Change::Number(at, value, bytes)),
        2 => (place(), place(), 1..256_usize).prop_map(|(from, to, n)| Change::Splice(from, to, n)),
    ]
}

fn apply(bytes: &mut Vec<u8>, change: &Change) {
    let length = bytes.len();
    if length == 0 {
        return;
    }
    let at = |fraction: f64| ((fraction * length as f64) as usize).min(length - 1);
    match *change {
        Change::Truncate(end) => bytes.truncate(at(1.0 - end)),
        Change::Flip(place, bit) => bytes[at(place)] ^= 1 << bit,
        Change::Number(place, value, size) => {
            // Half of all numbers lie on multiples of 4, which finds fields more often.
            let start = if value.is_multiple_of(2) {
                at(place)
            } else {
                at(place) & !3
            };
            let end = (start + size).min(length);
            bytes[start..end].copy_from_slice(&value.to_le_bytes()[..end - start]);
        }
        Change::Splice(from, to, count) => {
            let from = at(from);
            let end = (from + count).min(length);
            let piece = bytes[from..end].to_vec();
            let to = at(to);
            bytes.splice(to..(to + count / 2).min(length), piece);
        }
    }
}

/// Addresses that the process has ever had at once. Unit: KiB.
fn peak() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find(|line| line.starts_with("VmPeak:"));
    line.and_then(|line| line.split_whitespace().nth(1)?.parse().ok())
        .unwrap_or(0)
}

/// Reads [`cases`] changed copies of the seeds; each has to end in a grid within the limits or an
/// error.
fn attack(format: &str, seeds: &[Vec<u8>], read: impl Fn(&[u8]) -> Result<Grid, VolumeError>) {
    for seed in seeds {
        read(seed).unwrap_or_else(|error| panic!("{format}: a whole file is refused: {error}"));
    }
    let start = Instant::now();
    let before = peak();
    let slowest = std::cell::Cell::new(0);
    let fine = std::cell::Cell::new(0);
    let config = ProptestConfig {
        cases: cases() as u32,
        failure_persistence: None,
        max_shrink_iters: 200,
        ..ProptestConfig::default()
    };
    let strategy = (0..seeds.len(), prop::collection::vec(change(), 1..4));
    TestRunner::new_with_rng(config, TestRng::deterministic_rng(RngAlgorithm::ChaCha))
        .run(&strategy, |(seed, changes)| {
            let mut bytes = seeds[seed].clone();
            for change in &changes {
                apply(&mut bytes, change);
            }
            let begin = Instant::now();
            if let Ok(grid) = read(&bytes) {
                fine.set(fine.get() + 1);
                prop_assert!(grid.bytes() <= LIMITS.grid_bytes);
                prop_assert!(grid.max().is_finite());
                prop_assert!(grid.world_from_lattice.is_finite());
            }
            slowest.set(slowest.get().max(begin.elapsed().as_millis()));
            Ok(())
        })
        .unwrap();
    let grown = peak() - before;
    eprintln!(
        "{format}: {} files, {} of them read, in {:.1} s, the slowest in {} ms; {} MiB more addresses",
        cases(),
        fine.get(),
        start.elapsed().as_secs_f64(),
        slowest.get(),
        grown / 1024
    );
    assert!(grown < MAX_GROWTH, "{format}: {grown} KiB");
    assert!(slowest.get() < 2000, "{format}: {} ms", slowest.get());
}

fn any_grid() -> ReadOptions {
    ReadOptions::default()
}

/// A NanoVDB buffer out of its zip.
fn bare(name: &str) -> Vec<u8> {
    let bytes = fixture(name);
    let mut bare = Vec::new();
    let mut data = flate2::read::ZlibDecoder::new(&bytes[16 + 176 + 8 + 8..]);
    data.read_to_end(&mut bare).unwrap();
    bare[7] = b'1';
    bare
}

fn array() -> &'static [u8] {
    static ARRAY: OnceLock<Vec<u8>> = OnceLock::new();
    ARRAY.get_or_init(|| {
        let mut bytes = b"\x93NUMPY\x01\x00\x46\x00".to_vec();
        let header = "{'descr': '<f4', 'fortran_order': False, 'shape': (5, 4, 3), }";
        bytes.extend(format!("{header:<69}\n").bytes());
        bytes.extend((0..60).flat_map(|i| (i as f32).to_le_bytes()));
        bytes
    })
}

/// Names of an array's axes in errors.
const AXES: &str = "(z, y, x)";

/// What is read as plain numbers is as long as its shape says.
fn check_numbers(array: Option<npy::Array>) {
    if let Some(npy::Array { shape, values }) = array {
        let [z, y, x] = shape.map(|side| side as usize);
        assert_eq!(values.len(), z * y * x);
    }
}

fn archive(method: zip::CompressionMethod) -> Vec<u8> {
    let mut writer = zip::ZipWriter::new(Cursor::new(Vec::new()));
    let options = zip::write::SimpleFileOptions::default().compression_method(method);
    for name in ["density.npy", "heat.npy"] {
        writer.start_file(name, options).unwrap();
        writer.write_all(array()).unwrap();
    }
    writer.finish().unwrap().into_inner()
}

fn volume() -> Vec<u8> {
    let mut bytes = b"VOL\x03".to_vec();
    for number in [1_u32, 5, 4, 3, 1] {
        bytes.extend(number.to_le_bytes());
    }
    for number in [0.0_f32, 0.0, 0.0, 1.0, 2.0, 3.0] {
        bytes.extend(number.to_le_bytes());
    }
    bytes.extend((0..60).flat_map(|i| (i as f32).to_le_bytes()));
    bytes
}

#[test]
fn broken_openvdb_files_are_harmless() {
    let seeds: Vec<Vec<u8>> = ["small", "small_half", "zip", "none", "instance", "inactive"]
        .map(|name| fixture(&format!("{name}.vdb")))
        .into();
    attack("vdb", &seeds, |bytes| {
        vdb::read_bytes(bytes, &any_grid(), &LIMITS)
    });
}

#[test]
fn broken_nanovdb_files_are_harmless() {
    let seeds = [
        bare("fp4.nvdb"),
        bare("fpN.nvdb"),
        fixture("fp8.nvdb"),
        fixture("float_blosc.nvdb"),
    ];
    attack("nvdb", &seeds, |bytes| {
        nvdb::read_bytes(bytes, &any_grid(), &LIMITS)
    });
}

#[test]
fn broken_mitsuba_volumes_are_harmless() {
    attack("vol", &[volume()], |bytes| vol::read_bytes(bytes, &LIMITS));
}

#[test]
fn broken_arrays_are_harmless() {
    let seeds = [array().to_vec()];
    attack("npy", &seeds, |bytes| {
        let length = bytes.len() as u64;
        check_numbers(npy::Array::read(&mut { bytes }, length, LIMITS.file_bytes, AXES).ok());
        npy::read_bytes(bytes, &any_grid(), &LIMITS)
    });
}

#[test]
fn broken_archives_are_harmless() {
    let seeds = [
        archive(zip::CompressionMethod::Stored),
        archive(zip::CompressionMethod::Deflated),
    ];
    attack("npz", &seeds, |bytes| {
        let numbers = npz::read_array(Cursor::new(bytes), "heat", LIMITS.file_bytes, AXES);
        check_numbers(numbers.ok().flatten());
        npz::read_bytes(bytes, &any_grid(), &LIMITS)
    });
}

#[test]
fn broken_raw_voxels_are_harmless() {
    // The description and the voxels in one, so that both change.
    let text =
        r#"{"size":[5,4,3],"type":"u16","endian":"big","bounds_min":[0,0,0],"bounds_max":[1,2,3]}"#;
    let mut seed = text.as_bytes().to_vec();
    seed.push(b'\n');
    seed.extend((0..60_u16).flat_map(u16::to_be_bytes));
    attack("raw", &[seed], |bytes| {
        let end = bytes
            .iter()
            .position(|byte| *byte == b'\n')
            .unwrap_or(bytes.len());
        let text = String::from_utf8_lossy(&bytes[..end]);
        raw::read_bytes(&bytes[(end + 1).min(bytes.len())..], &text, &LIMITS)
    });
}
