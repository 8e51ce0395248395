//! Grids whose voxels are all stored: where they lie, in which order, and in which numbers.

#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use std::io::{Cursor, Write};

use glam::{DVec3, IVec3};
use tyndall_volume::{Grid, ReadOptions, VolumeError, VolumeLimits, npy, npz, raw, read, vol};

/// Voxels along x, y, z of every grid here.
const SIZE: [i32; 3] = [3, 4, 17];

/// The voxel (x, y, z): a different small integer each.
fn value(x: i32, y: i32, z: i32) -> f32 {
    (1 + x + 3 * (y + 4 * z)) as f32
}

/// The voxels, x fastest.
fn values() -> impl Iterator<Item = f32> {
    (1..=3 * 4 * 17).map(|number| number as f32)
}

fn limits() -> VolumeLimits {
    VolumeLimits::default()
}

fn array(descr: &str, fortran: &str, shape: &str, data: &[u8]) -> Vec<u8> {
    let header = format!("{{'descr': {descr}, 'fortran_order': {fortran}, 'shape': {shape}, }}\n");
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend((header.len() as u16).to_le_bytes());
    bytes.extend(header.bytes());
    bytes.extend(data);
    bytes
}

fn read_array(bytes: &[u8]) -> Result<Grid, VolumeError> {
    npy::read_bytes(bytes, &ReadOptions::default(), &limits())
}

/// Each voxel once, and a copy of the edge around them.
fn assert_voxels(grid: &Grid, scale: f32, what: &str) {
    let size = IVec3::from_array(SIZE);
    assert_eq!(grid.size().as_ivec3(), size + 2, "{what}");
    for z in 0..size.z + 2 {
        for y in 0..size.y + 2 {
            for x in 0..size.x + 2 {
                let lattice = IVec3::new(x, y, z);
                let voxel = (lattice - 1).clamp(IVec3::ZERO, size - 1);
                let expected = value(voxel.x, voxel.y, voxel.z) * scale;
                assert_eq!(grid.voxel(lattice), expected, "{what}: {lattice}");
            }
        }
    }
}

fn assert_box(grid: &Grid, low: DVec3, high: DVec3) {
    let place = |point| grid.world_from_lattice.transform_point3(point);
    assert!(
        place(grid.clip[0]).abs_diff_eq(low, 1e-12),
        "{:?}",
        grid.clip
    );
    assert!(
        place(grid.clip[1]).abs_diff_eq(high, 1e-12),
        "{:?}",
        grid.clip
    );
    let size = DVec3::new(3.0, 4.0, 17.0);
    let last = low + (size - 0.5) / size * (high - low);
    assert!(place(size).abs_diff_eq(last, 1e-12));
}

#[test]
fn every_kind_of_number_is_read() {
    macro_rules! check {
        ($($name:literal: $type:ty),*) => {$(
            let little: Vec<u8> = values().flat_map(|v| (v as $type).to_le_bytes()).collect();
            let big: Vec<u8> = values().flat_map(|v| (v as $type).to_be_bytes()).collect();
            for (order, data) in [("<", little), (">", big)] {
                let descr = format!("'{order}{}'", $name);
                let grid = read_array(&array(&descr, "False", "(17, 4, 3)", &data)).unwrap();
                assert_voxels(&grid, 1.0, &descr);
                assert_box(&grid, DVec3::ZERO, DVec3::ONE);
            }
        )*};
    }
    check!("f4": f32, "f8": f64, "u1": u8, "u2": u16, "u4": u32, "u8": u64,
        "i2": i16, "i4": i32, "i8": i64);
    let halves: Vec<u8> = values()
        .flat_map(|v| half::f16::from_f32(v).to_le_bytes())
        .collect();
    let grid = read_array(&array("'<f2'", "False", "(17, 4, 3)", &halves)).unwrap();
    assert_voxels(&grid, 1.0, "f2");
    let bytes: Vec<u8> = values().map(|v| (v / 2.0) as i8 as u8).collect();
    let grid = read_array(&array("'|i1'", "False", "(17, 4, 3)", &bytes)).unwrap();
    assert_eq!(grid.voxel(IVec3::new(2, 1, 1)), 1.0);
}

/// Reads an array as plain numbers.
fn read_numbers(bytes: &[u8]) -> Result<npy::Array, VolumeError> {
    npy::Array::read(&mut { bytes }, bytes.len() as u64, 4096, "(z, y, x)")
}

#[test]
fn floats_are_read_without_a_grid_too() {
    let halves: Vec<u8> = values()
        .flat_map(|v| half::f16::from_f32(v).to_be_bytes())
        .collect();
    let singles: Vec<u8> = values().flat_map(f32::to_le_bytes).collect();
    let doubles: Vec<u8> = values().flat_map(|v| f64::from(v).to_le_bytes()).collect();
    for (descr, data) in [("'>f2'", halves), ("'<f4'", singles), ("'<f8'", doubles)] {
        let bytes = array(descr, "False", "(17, 4, 3)", &data);
        let numbers = read_numbers(&bytes).unwrap();
        assert_eq!(numbers.shape, [17, 4, 3], "{descr}");
        assert!(numbers.values.into_iter().eq(values()), "{descr}");
    }
    let archive = archive(&["heat.npy"]);
    let named = |name| npz::read_array(Cursor::new(&archive), name, 4096, "(z, y, x)").unwrap();
    assert!(named("heat").unwrap().values.into_iter().eq(values()));
    assert_eq!(named("fuel"), None);
}

#[test]
fn other_numbers_are_refused_by_name() {
    let data: Vec<u8> = values().flat_map(f32::to_le_bytes).collect();
    for (descr, fortran, shape, name) in [
        ("'<i4'", "False", "(17, 4, 3)", "integers"),
        ("'<f4'", "True", "(17, 4, 3)", "fortran_order"),
        ("'<f4'", "False", "(17, 12)", "three axes: (z, y, x)"),
        (
            "'<f4'",
            "False",
            "(17, 4, 4)",
            "1088 bytes for the shape [17, 4, 4]",
        ),
    ] {
        let error = read_numbers(&array(descr, fortran, shape, &data)).unwrap_err();
        assert!(error.to_string().contains(name), "{descr} {shape}: {error}");
    }
    let long = array("'<f8'", "False", "(17, 4, 8)", &[0; 8 * 17 * 4 * 8]);
    let error = read_numbers(&long).unwrap_err();
    assert!(matches!(error, VolumeError::Limit { .. }), "{error}");
    // An archive may say that an array is longer than it is.
    let short = array("'<f4'", "False", "(1024, 1024, 256)", &data);
    let claimed = (short.len() - data.len()) as u64 + (1 << 30);
    let error = npy::Array::read(&mut &short[..], claimed, 1 << 31, "(z, y, x)").unwrap_err();
    assert!(error.to_string().contains("end of the data"), "{error}");
}

#[test]
fn fortran_order_changes_the_first_index_fastest() {
    let mut data = Vec::new();
    for x in 0..3 {
        for y in 0..4 {
            for z in 0..17 {
                data.extend(value(x, y, z).to_le_bytes());
            }
        }
    }
    let grid = read_array(&array("'<f4'", "True", "(17, 4, 3)", &data)).unwrap();
    assert_voxels(&grid, 1.0, "Fortran order");
}

#[test]
fn the_edge_holds_up_to_the_faces_of_the_box() {
    let data: Vec<u8> = values().flat_map(f32::to_le_bytes).collect();
    let grid = read_array(&array("'<f4'", "False", "(17, 4, 3)", &data)).unwrap();
    let [low, high] = grid.clip;
    assert_eq!(grid.sample(low), 1.0);
    assert_eq!(grid.sample(high), f64::from(value(2, 3, 16)));
    assert_eq!(grid.sample(low - 1e-9), 0.0);
    // Midway between the first two voxels along x.
    let middle = grid.sample(DVec3::new(1.5, 1.0, 1.0));
    assert_eq!(middle, 1.5);
}

#[test]
fn other_arrays_are_refused_by_name() {
    let data: Vec<u8> = values().flat_map(f32::to_le_bytes).collect();
    for (descr, shape, name) in [
        ("'<f4'", "(17, 12)", "three axes"),
        ("'<f4'", "(17, 4, 3, 1)", "three axes"),
        ("'<f4'", "()", "three axes"),
        ("'<f4'", "(17, 4, -3)", "three axes"),
        ("'<c8'", "(17, 4, 3)", "<c8"),
        ("'|O'", "(17, 4, 3)", "|O"),
        ("[('a', '<f4')]", "(17, 4, 3)", "records"),
        ("'<f4'", "(17, 4, 4)", "1088 bytes for 4 × 4 × 17 voxels"),
        ("'<f4'", "(0, 4, 3)", "0 bytes for 3 × 4 × 0 voxels"),
        ("'<f8'", "(4000000, 4000000, 4000000)", "bytes for"),
    ] {
        let error = read_array(&array(descr, "False", shape, &data)).unwrap_err();
        assert!(error.to_string().contains(name), "{descr} {shape}: {error}");
    }
    let error = read_array(&array("'<f4'", "False", "(0, 4, 3)", &[])).unwrap_err();
    assert!(error.to_string().contains("at least 1"), "{error}");
}

fn archive(names: &[&str]) -> Vec<u8> {
    let data: Vec<u8> = values().flat_map(f32::to_le_bytes).collect();
    let mut writer = zip::ZipWriter::new(Cursor::new(Vec::new()));
    for name in names {
        let options = zip::write::SimpleFileOptions::default();
        writer.start_file(*name, options).unwrap();
        let array = array("'<f4'", "False", "(17, 4, 3)", &data);
        writer.write_all(&array).unwrap();
    }
    writer.finish().unwrap().into_inner()
}

#[test]
fn an_array_of_an_archive_is_chosen_by_name() {
    let choose = |names: &[&str], grid: Option<&str>| {
        let grid = grid.map(str::to_owned);
        npz::read_bytes(&archive(names), &ReadOptions { grid }, &limits())
    };
    let grid = choose(&["heat.npy", "density.npy"], None).unwrap();
    assert_eq!(grid.name, "density");
    assert_voxels(&grid, 1.0, "npz");
    assert_eq!(
        choose(&["heat.npy", "fuel.npy"], Some("fuel"))
            .unwrap()
            .name,
        "fuel"
    );
    assert_eq!(choose(&["heat.npy"], None).unwrap().name, "heat");
    for wanted in [None, Some("smoke")] {
        let error = choose(&["heat.npy", "fuel.npy"], wanted)
            .unwrap_err()
            .to_string();
        assert!(error.contains("heat") && error.contains("fuel"), "{error}");
    }
    assert!(choose(&[], None).is_err());
}

fn volume(kind: u32, channels: u32, data: &[u8]) -> Vec<u8> {
    let mut bytes = b"VOL\x03".to_vec();
    for number in [kind, 3, 4, 17, channels] {
        bytes.extend(number.to_le_bytes());
    }
    for number in [-1.0_f32, 0.0, 2.0, 5.0, 8.0, 4.0] {
        bytes.extend(number.to_le_bytes());
    }
    bytes.extend(data);
    bytes
}

#[test]
fn mitsuba_volumes_fill_their_box() {
    let floats: Vec<u8> = values().flat_map(f32::to_le_bytes).collect();
    let grid = vol::read_bytes(&volume(1, 1, &floats), &limits()).unwrap();
    assert_voxels(&grid, 1.0, "vol");
    assert_box(&grid, DVec3::new(-1.0, 0.0, 2.0), DVec3::new(5.0, 8.0, 4.0));
    let bytes: Vec<u8> = values().map(|value| value as u8).collect();
    let grid = vol::read_bytes(&volume(3, 1, &bytes), &limits()).unwrap();
    assert_voxels(&grid, 1.0 / 255.0, "vol of bytes");
    for (bytes, name) in [
        (volume(2, 1, &floats), "half floats"),
        (volume(4, 1, &floats), "quantised directions"),
        (volume(1, 3, &floats), "3 channels"),
    ] {
        let error = vol::read_bytes(&bytes, &limits()).unwrap_err();
        assert!(matches!(error, VolumeError::Unsupported { .. }));
        assert!(error.to_string().contains(name), "{error}");
    }
    let mut flat = volume(1, 1, &floats);
    flat[24..28].copy_from_slice(&5.0_f32.to_le_bytes());
    let error = vol::read_bytes(&flat, &limits()).unwrap_err().to_string();
    assert!(error.contains("low below high"), "{error}");
}

#[test]
fn raw_voxels_are_what_their_description_says() {
    let floats: Vec<u8> = values().flat_map(f32::to_le_bytes).collect();
    let shorts: Vec<u8> = values().flat_map(|v| (v as u16).to_be_bytes()).collect();
    let grid = raw::read_bytes(&floats, r#"{"size":[3,4,17],"type":"f32"}"#, &limits()).unwrap();
    assert_voxels(&grid, 1.0, "raw");
    assert_box(&grid, DVec3::ZERO, DVec3::ONE);
    let text = r#"{"size":[3,4,17],"type":"u16","endian":"big","bounds_min":[0,-1,0],"bounds_max":[1,1,9]}"#;
    let grid = raw::read_bytes(&shorts, text, &limits()).unwrap();
    assert_voxels(&grid, 1.0 / 65535.0, "raw of 16 bits");
    assert_box(&grid, DVec3::new(0.0, -1.0, 0.0), DVec3::new(1.0, 1.0, 9.0));
    let text = r#"{"dims_xyz":[3,4,17],"dtype":"float32 little-endian","order":"x fastest",
        "voxel_size":[1,2,3],"world_of_ijk_min":[0.5,1,1.5],"source":"x"}"#;
    let grid = raw::read_bytes(&floats, text, &limits()).unwrap();
    assert_box(&grid, DVec3::ZERO, DVec3::new(3.0, 8.0, 51.0));
    for (text, name) in [
        (r#"{"size":[3,4,17],"type":"f32","spacing":1}"#, "spacing"),
        (r#"{"size":[3,4,17],"type":"f64"}"#, "f64"),
        (r#"{"size":[3,4],"type":"f32"}"#, "length 2"),
        (r#"{"size":[3,4,16],"type":"f32"}"#, "768 bytes for"),
        (
            r#"{"dims_xyz":[3,4,17],"dtype":"float32","order":"z fastest"}"#,
            "z fastest",
        ),
        (
            r#"{"dims_xyz":[3,4,17],"dtype":"int32","order":"x fastest"}"#,
            "int32",
        ),
        ("", "description"),
    ] {
        let error = raw::read_bytes(&floats, text, &limits())
            .unwrap_err()
            .to_string();
        assert!(error.contains(name), "{text}: {error}");
    }
}

#[test]
fn files_are_read_by_their_ending() {
    let folder = tempfile::tempdir().unwrap();
    let floats: Vec<u8> = values().flat_map(f32::to_le_bytes).collect();
    let array = array("'<f4'", "False", "(17, 4, 3)", &floats);
    let description = r#"{"size":[3,4,17],"type":"f32"}"#;
    for (name, bytes) in [
        ("fog.NPY", array.as_slice()),
        ("fog.npz", &archive(&["density.npy"])),
        ("fog.vol", &volume(1, 1, &floats)),
        ("fog.raw", &floats),
        ("other.raw", &floats),
        ("fog.raw.json", description.as_bytes()),
        ("other.json", description.as_bytes()),
    ] {
        std::fs::write(folder.path().join(name), bytes).unwrap();
    }
    let read = |name: &str, limits: &VolumeLimits| {
        read(&folder.path().join(name), &ReadOptions::default(), limits)
    };
    for name in ["fog.NPY", "fog.npz", "fog.vol", "fog.raw", "other.raw"] {
        assert_voxels(&read(name, &limits()).unwrap(), 1.0, name);
        let small = VolumeLimits {
            file_bytes: 100,
            ..limits()
        };
        let error = read(name, &small).unwrap_err();
        assert!(
            matches!(error, VolumeError::Limit { .. }),
            "{name}: {error}"
        );
    }
    std::fs::write(folder.path().join("lone.raw"), &floats).unwrap();
    let error = read("lone.raw", &limits()).unwrap_err().to_string();
    assert!(error.contains("the same name and .json"), "{error}");
    let error = read("fog.exr", &limits()).unwrap_err().to_string();
    assert!(error.contains("exr") && error.contains(".nvdb"), "{error}");
    let named = ReadOptions {
        grid: Some("density".to_owned()),
    };
    let error = tyndall_volume::read(&folder.path().join("fog.vol"), &named, &limits());
    assert!(error.unwrap_err().to_string().contains("no name"));
}
