//! Single files that are built to do harm, each refused for what it does.

#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use std::io::Read;

use tyndall_volume::{Grid, ReadOptions, VolumeError, VolumeLimits, npy, nvdb, raw, vdb, vol};

const LIMITS: VolumeLimits = VolumeLimits {
    file_bytes: 1 << 20,
    grid_bytes: 4 << 20,
};

fn fixture(name: &str) -> Vec<u8> {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/fixtures/");
    std::fs::read(format!("{folder}{name}")).unwrap()
}

fn read_vdb(bytes: &[u8]) -> Result<Grid, VolumeError> {
    vdb::read_bytes(bytes, &ReadOptions::default(), &LIMITS)
}

fn read_nvdb(bytes: &[u8]) -> Result<Grid, VolumeError> {
    nvdb::read_bytes(bytes, &ReadOptions::default(), &LIMITS)
}

/// Where `pattern` is in a file, its only time.
fn find(bytes: &[u8], pattern: &[u8]) -> usize {
    let found: Vec<usize> = (0..bytes.len() - pattern.len())
        .filter(|at| bytes[*at..].starts_with(pattern))
        .collect();
    assert_eq!(found.len(), 1);
    found[0]
}

fn put(bytes: &mut [u8], at: usize, value: &[u8]) {
    bytes[at..at + value.len()].copy_from_slice(value);
}

fn assert_says(result: Result<Grid, VolumeError>, what: &str) {
    let error = result.unwrap_err().to_string();
    assert!(error.contains(what), "{error} does not say {what}");
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

/// Where the root of a bare buffer is.
fn root(bare: &[u8]) -> usize {
    let mut offset = [0; 8];
    offset.copy_from_slice(&bare[696..704]);
    672 + u64::from_le_bytes(offset) as usize
}

#[test]
fn terabytes_in_headers_are_refused_before_anything_is_allocated() {
    // A block of values, a text and metadata of a length that the file does not have.
    let whole = fixture("none.vdb");
    let mut bytes = fixture("zip.vdb");
    let map = find(&bytes, b"UniformScaleMap");
    // After the map's 15 numbers: buffers, background, tiles, children, key, masks, kind, length.
    let length = map + 15 + 120 + 4 + 4 + 8 + 12 + 2 * 4096 + 1;
    put(&mut bytes, length, &(1_i64 << 42).to_le_bytes());
    assert_says(read_vdb(&bytes), "4398046511104 bytes at byte");
    let mut bytes = whole.clone();
    put(&mut bytes, map - 4, &u32::MAX.to_le_bytes());
    assert!(read_vdb(&bytes).is_err());

    let mut bytes = bare("fp4.nvdb");
    put(&mut bytes, 32, &(1_u64 << 42).to_le_bytes());
    assert_says(read_nvdb(&bytes), "4398046511104 bytes");
    let mut bytes = fixture("fp4.nvdb");
    put(&mut bytes, 16, &(1_u64 << 42).to_le_bytes());
    assert_says(read_nvdb(&bytes), "4398046511104 from");
    // What zlib could just expand to, but above the limit.
    let stored = u64::try_from(bytes.len()).unwrap() - 200;
    put(
        &mut bytes,
        16,
        &(5_u64 << 20).min(stored * 1000).to_le_bytes(),
    );
    assert!(read_nvdb(&bytes).is_err());

    let mut bytes = b"VOL\x03".to_vec();
    for number in [1_u32, 1 << 20, 1 << 20, 1 << 20, 1] {
        bytes.extend(number.to_le_bytes());
    }
    bytes.extend(
        [0.0_f32, 0.0, 0.0, 1.0, 1.0, 1.0]
            .into_iter()
            .flat_map(f32::to_le_bytes),
    );
    assert_says(
        vol::read_bytes(&bytes, &LIMITS),
        "bytes for 1048576 × 1048576 × 1048576",
    );

    let text = r#"{"size":[4294967295,4294967295,4294967295],"type":"u16"}"#;
    assert_says(
        raw::read_bytes(&[0; 16], text, &LIMITS),
        "bytes for 4294967295",
    );

    let header = "{'descr': '<f4', 'fortran_order': False, 'shape': (1048576, 1048576, 1048576), }";
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend((header.len() as u16).to_le_bytes());
    bytes.extend(header.bytes());
    let result = npy::read_bytes(&bytes, &ReadOptions::default(), &LIMITS);
    assert_says(result, "bytes for 1048576");
}

#[test]
fn a_lattice_above_the_limit_is_refused() {
    let error = read_vdb(&fixture("root_tile.vdb")).unwrap_err();
    assert!(matches!(error, VolumeError::Limit { .. }), "{error}");
    let tight = VolumeLimits {
        grid_bytes: 2048,
        ..LIMITS
    };
    for name in ["far_apart.vdb", "small.vdb"] {
        let result = vdb::read_bytes(&fixture(name), &ReadOptions::default(), &tight);
        assert!(matches!(result, Err(VolumeError::Limit { .. })), "{name}");
    }
    let tight = VolumeLimits {
        file_bytes: 100,
        ..LIMITS
    };
    let error = nvdb::read_bytes(&fixture("fp4.nvdb"), &ReadOptions::default(), &tight);
    assert!(matches!(error, Err(VolumeError::Limit { .. })));
}

#[test]
fn offsets_that_lead_back_are_refused() {
    // The second grid of a file would be the first again.
    let mut bytes = fixture("several.vdb");
    let name = find(&bytes, b"Tree_bool_5_4_3");
    let end = name + 15 + 4 + 16;
    put(&mut bytes, end, &100_u64.to_le_bytes());
    assert_says(read_vdb(&bytes), "ascending");

    // A root's child is the root's tree itself; a node's child the node.
    let whole = bare("fp4.nvdb");
    let root = root(&whole);
    let child_field = root + 64 + 8;
    let mut bytes = whole.clone();
    put(&mut bytes, child_field, &(-(root as i64) - 8).to_le_bytes());
    assert_says(read_nvdb(&bytes), "bytes from");
    put(&mut bytes, child_field, &i64::MAX.to_le_bytes());
    assert_says(read_nvdb(&bytes), "bytes from");
    let mut offset = [0; 8];
    offset.copy_from_slice(&whole[child_field..child_field + 8]);
    let upper = root + i64::from_le_bytes(offset) as usize;
    // All children of the upper node are one: visited again and again.
    let mut bytes = whole.clone();
    let at = (0..32768)
        .find(|at| bytes[upper + 4128 + at / 8] >> (at % 8) & 1 == 1)
        .unwrap();
    let entry = bytes[upper + 8256 + 8 * at..][..8].to_vec();
    bytes[upper + 4128..upper + 8224].fill(255);
    for at in 0..32768 {
        put(&mut bytes, upper + 8256 + 8 * at, &entry);
    }
    assert_says(read_nvdb(&bytes), "visited twice");
    // The root has one tile many times.
    let mut bytes = whole;
    put(&mut bytes, root + 24, &u32::MAX.to_le_bytes());
    assert!(read_nvdb(&bytes).is_err());
}

#[test]
fn transforms_that_cannot_be_inverted_are_refused() {
    for value in [f64::NAN, f64::INFINITY, 0.0, 1e-320] {
        let mut bytes = fixture("small.vdb");
        let map = find(&bytes, b"UniformScaleMap");
        put(&mut bytes, map + 15, &value.to_le_bytes());
        assert_says(read_vdb(&bytes), "a finite, invertible transform");
        let mut bytes = bare("fp4.nvdb");
        put(&mut bytes, 296 + 88, &value.to_le_bytes());
        assert_says(read_nvdb(&bytes), "a finite, invertible transform");
    }
    let mut bytes = fixture("small.vdb");
    let map = find(&bytes, b"UniformScaleMap");
    put(&mut bytes, map, b"NonlinearFrustu");
    assert_says(read_vdb(&bytes), "a transform of type \"NonlinearFrustu\"");
}

#[test]
fn other_versions_and_files_are_refused_by_name() {
    for version in [221_u32, 226] {
        let mut bytes = fixture("small.vdb");
        put(&mut bytes, 8, &version.to_le_bytes());
        assert_says(read_vdb(&bytes), &format!("version {version}"));
    }
    let mut bytes = fixture("fp4.nvdb");
    put(&mut bytes, 8, &(31_u32 << 21 | 3 << 10).to_le_bytes());
    assert_says(read_nvdb(&bytes), "version 31.3");
    assert_says(read_vdb(&fixture("fp4.nvdb")), "an OpenVDB file's");
    assert_says(read_nvdb(&fixture("small.vdb")), "a NanoVDB file's");
    assert_says(read_vdb(&[]), "magic number");
    assert_says(read_nvdb(&[]), "magic number");
}

#[test]
fn a_share_in_a_tree_that_is_not_there_is_refused() {
    let mut bytes = fixture("instance.vdb");
    let places: Vec<usize> = (0..bytes.len() - 5)
        .filter(|at| bytes[*at..].starts_with(b"first"))
        .collect();
    // The last time, it is the owner of the second grid's tree.
    let owner = places
        .into_iter()
        .rfind(|at| bytes[at - 4..*at] == [5, 0, 0, 0] && bytes[at + 5..at + 8] != *b"\0\0\0")
        .unwrap();
    put(&mut bytes, owner, b"other");
    let second = ReadOptions {
        grid: Some("second".to_owned()),
    };
    let result = vdb::read_bytes(&bytes, &second, &LIMITS);
    assert_says(result, "\"other\"");
}
