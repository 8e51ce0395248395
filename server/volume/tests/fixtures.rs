//! Small files written by Debian's OpenVDB and NanoVDB (`make_vdb.py`), voxel by voxel.

#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use std::collections::HashMap;
use std::io::Read;
use std::path::PathBuf;

use glam::{DVec3, IVec3};
use serde_json::Value;
use tyndall_volume::{Grid, ReadOptions, VolumeError, VolumeLimits, nvdb, read, vdb};

fn path(name: &str) -> PathBuf {
    PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/fixtures")).join(name)
}

fn named(grid: &str) -> ReadOptions {
    ReadOptions {
        grid: Some(grid.to_owned()),
    }
}

fn read_fixture(name: &str, options: &ReadOptions) -> Result<Grid, VolumeError> {
    read(&path(name), options, &VolumeLimits::default())
}

fn vector(value: &Value) -> Vec<f64> {
    let list = value.as_array().unwrap();
    list.iter().map(|number| number.as_f64().unwrap()).collect()
}

fn point(value: &Value) -> DVec3 {
    DVec3::from_slice(&vector(value))
}

/// The grids of an expectation with the addresses that reach them.
fn expectations(name: &str) -> Vec<(String, Value)> {
    let text = std::fs::read_to_string(path(name)).unwrap();
    let grids: Vec<Value> = serde_json::from_str(&text).unwrap();
    let name = |grid: &Value| grid["name"].as_str().unwrap().to_owned();
    let mut counts = HashMap::<String, usize>::new();
    for grid in &grids {
        *counts.entry(name(grid)).or_default() += 1;
    }
    let mut seen = HashMap::<String, usize>::new();
    grids
        .into_iter()
        .map(|grid| {
            let name = name(&grid);
            let number = seen.entry(name.clone()).or_default();
            let address = if counts[&name] > 1 {
                format!("{name}[{number}]")
            } else {
                name
            };
            *number += 1;
            (address, grid)
        })
        .collect()
}

/// Compares a grid with what OpenVDB says of it.
fn compare(grid: &Grid, expected: &Value, what: &str) {
    let world = expected["world"].as_array().unwrap();
    let empty = expected["active"] == 0;
    let low = if empty {
        DVec3::ONE
    } else {
        point(&expected["low"])
    };
    // Lattice point of index (0, 0, 0): the clip begins one voxel before the lowest.
    let origin = grid.clip[0] - (low - 1.0);
    for (index, place) in [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z]
        .iter()
        .zip(world)
    {
        let found = grid.world_from_lattice.transform_point3(origin + *index);
        assert!(
            found.abs_diff_eq(point(place), 1e-9),
            "{what}: {found} {place}"
        );
    }
    if empty {
        assert_eq!((grid.max(), grid.stored_bricks()), (0.0, 0), "{what}");
        return;
    }
    let high = point(&expected["high"]);
    assert_eq!(grid.clip[1] - grid.clip[0], high - low + 2.0, "{what}");
    let mut mended = [0, 0];
    let mut values = HashMap::new();
    for voxel in expected["voxels"].as_array().unwrap() {
        let numbers = vector(voxel);
        let value = f32::from_bits(numbers[3] as u32);
        mended[0] += u64::from(!value.is_finite());
        mended[1] += u64::from(value < 0.0 && value.is_finite());
        let clean = if value.is_finite() {
            value.max(0.0)
        } else {
            0.0
        };
        let place = (DVec3::from_slice(&numbers) + origin).as_ivec3();
        assert_eq!(grid.voxel(place), clean, "{what}: {numbers:?}");
        values.insert(place, clean);
    }
    if expected["sampled"] == true {
        return;
    }
    assert_eq!(
        [grid.report.non_finite, grid.report.negative],
        mended,
        "{what}"
    );
    let size = grid.size().as_ivec3();
    for z in 0..size.z {
        for y in 0..size.y {
            for x in 0..size.x {
                let voxel = IVec3::new(x, y, z);
                let value = values.get(&voxel).copied().unwrap_or(0.0);
                assert_eq!(grid.voxel(voxel), value, "{what}: {voxel}");
            }
        }
    }
}

#[test]
fn every_openvdb_file_agrees_with_openvdb() {
    for (file, source) in [
        ("plain", "plain"),
        ("small", "small"),
        ("small_half", "small_half"),
        ("zip", "small"),
        ("zip_half", "small_half"),
        ("zip_mask", "small"),
        ("none", "small"),
        ("none_half", "small_half"),
        ("transforms", "transforms"),
        ("tiles", "tiles"),
        ("root_tile", "root_tile"),
        ("far_apart", "far_apart"),
        ("inactive", "inactive"),
        ("zip_inactive", "inactive"),
        ("odd_values", "odd_values"),
        ("empty", "empty"),
        ("instance", "instance"),
    ] {
        for (address, expected) in expectations(&format!("{source}.json")) {
            let what = format!("{file}.vdb {address}");
            let grid = read_fixture(&format!("{file}.vdb"), &named(&address))
                .unwrap_or_else(|error| panic!("{what}: {error}"));
            compare(&grid, &expected, &what);
        }
    }
}

#[test]
fn every_nanovdb_file_agrees_with_openvdb() {
    for file in [
        "fp4",
        "fp8",
        "fp16",
        "fpN",
        "float_blosc",
        "tiles",
        "several",
    ] {
        for (address, expected) in expectations(&format!("{file}.nvdb.json")) {
            let what = format!("{file}.nvdb {address}");
            let grid = read_fixture(&format!("{file}.nvdb"), &named(&address))
                .unwrap_or_else(|error| panic!("{what}: {error}"));
            compare_quantised(&grid, &expected, &what, file.starts_with("fp"));
        }
    }
}

/// NanoVDB's own arithmetic may round once more or less than ours: then within 10⁻⁶.
fn compare_quantised(grid: &Grid, expected: &Value, what: &str, quantised: bool) {
    if !quantised {
        return compare(grid, expected, what);
    }
    let origin = grid.clip[0] - (point(&expected["low"]) - 1.0);
    let voxels = expected["voxels"].as_array().unwrap();
    assert!(voxels.len() > 80, "{what}");
    for voxel in voxels {
        let numbers = vector(voxel);
        let value = f32::from_bits(numbers[3] as u32);
        let place = (DVec3::from_slice(&numbers) + origin).as_ivec3();
        let found = grid.voxel(place);
        assert!(
            (found - value).abs() <= 1e-6,
            "{what} {place}: {found} {value}"
        );
    }
}

#[test]
fn tiles_cost_table_entries_only() {
    let grid = read_fixture("root_tile.vdb", &named("density")).unwrap();
    assert_eq!(grid.max(), 0.125);
    assert_eq!(grid.stored_bricks(), 1);
    assert_eq!(grid.voxel(IVec3::splat(8 + 4095)), 0.125);
    assert_eq!(grid.voxel(IVec3::splat(8 + 4096)), 0.0);
    let grid = read_fixture("tiles.vdb", &named("density")).unwrap();
    assert!(grid.stored_bricks() < 100, "{}", grid.stored_bricks());
}

#[test]
fn a_grid_is_chosen_by_name() {
    let several = |grid: Option<&str>| {
        let options = ReadOptions {
            grid: grid.map(str::to_owned),
        };
        read_fixture("several.vdb", &options)
    };
    // Without a name: density, though heat comes before it and velocity first.
    let first = several(None).unwrap();
    assert_eq!(first.name, "density");
    assert_eq!(first, several(Some("density")).unwrap());
    assert_eq!(first, several(Some("density[0]")).unwrap());
    let second = several(Some("density[1]")).unwrap();
    assert!(second.max() > first.max());
    assert_eq!(several(Some("heat")).unwrap().name, "heat");
    let error = several(Some("smoke")).unwrap_err().to_string();
    for name in [
        "smoke",
        "density[0]",
        "density[1]",
        "heat",
        "velocity",
        "mask",
    ] {
        assert!(error.contains(name), "{error}");
    }
    let error = several(Some("velocity")).unwrap_err();
    assert!(matches!(error, VolumeError::Unsupported { .. }));
    assert!(error.to_string().contains("Tree_vec3s_5_4_3"), "{error}");
}

#[test]
fn a_level_set_is_refused_by_its_background() {
    let error = read_fixture("level_set.vdb", &ReadOptions::default()).unwrap_err();
    assert!(matches!(error, VolumeError::Unsupported { .. }));
    assert!(error.to_string().contains("0.3 (a level set?)"), "{error}");
}

#[test]
fn the_first_grid_of_a_stream_without_offsets_is_read() {
    let mut bytes = std::fs::read(path("small.vdb")).unwrap();
    let limits = VolumeLimits::default();
    let with = vdb::read_bytes(&bytes, &ReadOptions::default(), &limits).unwrap();
    bytes[20] = 0;
    let without = vdb::read_bytes(&bytes, &ReadOptions::default(), &limits).unwrap();
    assert_eq!(with, without);
}

#[test]
fn bare_nanovdb_buffers_are_read() {
    let bytes = std::fs::read(path("fp4.nvdb")).unwrap();
    let limits = VolumeLimits::default();
    let options = ReadOptions::default();
    let framed = nvdb::read_bytes(&bytes, &options, &limits).unwrap();
    let mut bare = Vec::new();
    // Header, record, "density" and its 0, and the length of the data.
    let mut data = flate2::read::ZlibDecoder::new(&bytes[16 + 176 + 8 + 8..]);
    data.read_to_end(&mut bare).unwrap();
    assert_eq!(bare[7], b'0');
    bare[7] = b'1';
    assert_eq!(framed, nvdb::read_bytes(&bare, &options, &limits).unwrap());
    // Twice: two grids of one name.
    let mut twice = bare.clone();
    twice.extend(&bare);
    let second = nvdb::read_bytes(&twice, &named("density[1]"), &limits).unwrap();
    assert_eq!(framed, second);
    assert!(nvdb::read_bytes(&twice, &named("density[2]"), &limits).is_err());
}
