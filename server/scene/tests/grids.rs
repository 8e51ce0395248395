//! Grid media: placement, sharing, facts, edits, and files that lie.

#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "helpers of tests, too, fail by unwrapping and say what they skip"
)]

use std::io::Write as _;
use std::path::Path;

use crate::support::shared;
use glam::DVec3;
use serde_json::{Value, json};
use tyndall_scene::{
    Limits, Loaded, MediumShape, SceneDescription, SceneEdit, SceneError, SharedGrid, apply_edit,
    build_with, facts,
};

/// A `.npy` array of float32, `[z][y][x]`.
fn npy(size: [usize; 3], value: impl Fn([usize; 3]) -> f32) -> Vec<u8> {
    let [x, y, z] = size;
    let mut header =
        format!("{{'descr': '<f4', 'fortran_order': False, 'shape': ({z}, {y}, {x}), }}");
    let padded = (10 + header.len() + 1).next_multiple_of(64) - 10;
    header.push_str(&" ".repeat(padded - 1 - header.len()));
    header.push('\n');
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend((header.len() as u16).to_le_bytes());
    bytes.extend(header.as_bytes());
    for k in 0..z {
        for j in 0..y {
            for i in 0..x {
                bytes.extend(value([i, j, k]).to_le_bytes());
            }
        }
    }
    bytes
}

fn npz(folder: &Path, name: &str, arrays: &[(&str, Vec<u8>)]) {
    let file = std::fs::File::create(folder.join(name)).unwrap();
    let mut writer = zip::ZipWriter::new(file);
    let stored =
        zip::write::SimpleFileOptions::default().compression_method(zip::CompressionMethod::Stored);
    for (array, bytes) in arrays {
        writer.start_file(format!("{array}.npy"), stored).unwrap();
        writer.write_all(bytes).unwrap();
    }
    writer.finish().unwrap();
}

/// A folder with `smoke.npz`: `density` 8 × 4 × 2 of 0.5, and `heat` that has voxels to mend.
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let density = npy([8, 4, 2], |_| 0.5);
    let heat = npy([8, 8, 8], |[i, j, k]| match (i, j, k) {
        (2, 2, 2) => f32::NAN,
        (3, 2, 2) => f32::INFINITY,
        (4, 1..=5, 2) => -1.0,
        _ => 3.0,
    });
    npz(
        folder.path(),
        "smoke.npz",
        &[("density", density), ("heat", heat)],
    );
    folder
}

fn description(media: &Value) -> Result<SceneDescription, SceneError> {
    let scene = json!({
        "version": 1,
        "camera": {"position": [0, 1, 4], "target": [0, 1, 0]},
        "media": media,
    });
    SceneDescription::from_json(&scene.to_string())
}

fn build_at(media: &Value, folder: &Path) -> Result<Loaded, SceneError> {
    build_with(description(media)?, Some(folder), &Limits::default())
}

fn smoke(more: &Value) -> Value {
    let mut medium = json!({"kind": "grid", "sigma_t": 2, "albedo": 0.5, "path": "smoke.npz"});
    medium
        .as_object_mut()
        .unwrap()
        .extend(more.as_object().unwrap().clone());
    medium
}

fn grid(loaded: &Loaded, index: usize) -> SharedGrid {
    match &loaded.scene.media[index].shape {
        MediumShape::Grid { grid, .. } => grid.clone(),
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_grid_is_placed_by_its_file_then_by_the_transform() {
    let folder = folder();
    let media = json!([
        smoke(&json!({"transform": {"scale": [8, 4, 2], "translation": [0, 10, 0]}})),
        smoke(&json!({"grid": "heat", "density_scale": 0.5})),
    ]);
    let loaded = build_at(&media, folder.path()).unwrap();
    assert_eq!(
        loaded.warnings,
        ["media[1].path: smoke.npz: 2 voxels were not finite and 5 were negative; they count as 0"]
    );
    let MediumShape::Grid {
        grid,
        world_from_lattice,
    } = &loaded.scene.media[0].shape
    else {
        panic!("no grid");
    };
    let [low, high] = grid
        .clip
        .map(|corner| world_from_lattice.transform_point3(corner));
    assert!((low - DVec3::new(0.0, 10.0, 0.0)).length() < 1e-12);
    assert!((high - DVec3::new(8.0, 14.0, 2.0)).length() < 1e-12);
    assert_eq!(grid.stats().mean, 0.5);

    let facts = facts(&loaded.scene);
    assert_eq!(
        (facts.grids, facts.heterogeneous, facts.media),
        (2, true, 2)
    );
    assert!((facts.bounds.min - DVec3::ZERO).length() < 1e-9);
    assert!((facts.bounds.max - DVec3::new(8.0, 14.0, 2.0)).length() < 1e-9);
    // 8 m of smoke and 1 m of heat.
    let truth = 2.0 * 8.0 * 0.5 + 3.0;
    let found = facts.optical_thickness;
    assert!((found - truth).abs() < 1e-6, "{found}");
}

#[test]
fn a_grid_is_read_once_and_kept_by_edits() {
    let folder = folder();
    let media = json!([
        smoke(&json!({})),
        smoke(&json!({"g": 0.5})),
        smoke(&json!({"grid": "heat"}))
    ]);
    let loaded = build_at(&media, folder.path()).unwrap();
    assert_eq!(grid(&loaded, 0), grid(&loaded, 1));
    assert_ne!(grid(&loaded, 0), grid(&loaded, 2));
    std::fs::remove_file(folder.path().join("smoke.npz")).unwrap();

    let edit = |media: Value| {
        let edit: SceneEdit = serde_json::from_value(json!({ "media": media })).unwrap();
        apply_edit(&loaded.description, &loaded.scene, &edit)
    };
    // Another order, another placement, other coefficients: the same grids.
    let (edited, scene) = edit(json!([
        smoke(&json!({"grid": "heat", "sigma_t": 7, "transform": {"translation": [1, 2, 3]}})),
        smoke(&json!({})),
    ]))
    .unwrap();
    let again = Loaded {
        description: edited,
        scene,
        warnings: Vec::new(),
        files: Vec::new(),
    };
    assert_eq!(grid(&again, 0), grid(&loaded, 2));
    assert_eq!(grid(&again, 1), grid(&loaded, 0));
    assert_eq!(again.scene.media[0].sigma_s, [3.5; 3]);
    let (_, scene) = edit(media).unwrap();
    assert_eq!(scene, loaded.scene);

    for (media, path) in [
        (
            json!([smoke(&json!({"path": "other.npz"}))]),
            "media[0].path",
        ),
        (json!([smoke(&json!({"grid": "fuel"}))]), "media[0].grid"),
        (
            json!([smoke(&json!({"density_scale": 1e6, "sigma_t": 3}))]),
            "media[0].density_scale",
        ),
        (
            json!([{"kind": "procedural", "pattern": "cloud", "sigma_t": 1, "albedo": 1}]),
            "media[0]",
        ),
    ] {
        let error = edit(media).unwrap_err();
        assert_eq!(error.path(), Some(path), "{error}");
    }
}

#[test]
fn procedural_grids_are_shared_and_kept_by_edits() {
    let cloud = |seed: u32| {
        json!({"kind": "procedural", "pattern": "cloud", "sigma_t": 1, "albedo": 1,
               "resolution": 24, "seed": seed, "transform": {"scale": 10}})
    };
    let build = |media: Value| tyndall_scene::build(description(&media).unwrap(), None).unwrap();
    let loaded = build(json!([cloud(1), cloud(2)]));
    assert_ne!(grid(&loaded, 0), grid(&loaded, 1));
    assert_eq!(grid(&build(json!([cloud(2)])), 0), grid(&loaded, 1));
    let bounds = facts(&loaded.scene).bounds;
    assert!((bounds.min - DVec3::new(-5.0, 0.0, -5.0)).length() < 1e-9);
    assert!((bounds.max - DVec3::new(5.0, 6.25, 5.0)).length() < 1e-9);
    let edit = |media: Value| {
        let edit: SceneEdit = serde_json::from_value(json!({ "media": media })).unwrap();
        apply_edit(&loaded.description, &loaded.scene, &edit)
    };
    let (_, scene) = edit(json!([cloud(2), cloud(2)])).unwrap();
    assert_eq!(scene.media[0], loaded.scene.media[1]);
    assert_eq!(
        edit(json!([cloud(3)])).unwrap_err().path(),
        Some("media[0]")
    );
}

#[test]
fn what_is_wrong_with_a_grid_is_named() {
    let folder = folder();
    std::fs::write(folder.path().join("text.vdb"), "no grid").unwrap();
    for (medium, path, part) in [
        (
            smoke(&json!({"path": "absent.npz"})),
            "media[0].path",
            "absent.npz",
        ),
        (
            smoke(&json!({"path": "text.vdb"})),
            "media[0].path",
            "text.vdb",
        ),
        (smoke(&json!({"grid": "fuel"})), "media[0].path", "density"),
        (
            smoke(&json!({"path": "../smoke.npz"})),
            "media[0].path",
            "'..'",
        ),
        (
            smoke(&json!({"path": "/etc/smoke.npz"})),
            "media[0].path",
            "absolute",
        ),
        (
            smoke(&json!({"path": "smoke.gif"})),
            "media[0].path",
            ".vdb",
        ),
        (
            smoke(&json!({"grid": "x".repeat(201)})),
            "media[0].grid",
            "200",
        ),
        (
            smoke(&json!({"grid": "a\nb"})),
            "media[0].grid",
            "printable",
        ),
        (
            smoke(&json!({"sigma_t": 1e6, "grid": "heat"})),
            "media[0].density_scale",
            "largest voxel",
        ),
        (
            smoke(&json!({"sigma_t": 1e3, "density_scale": 1e5})),
            "media[0].density_scale",
            "5.000e7 m⁻¹",
        ),
        (
            smoke(&json!({"emission": 1e9, "density_scale": 3})),
            "media[0].density_scale",
            "emission",
        ),
        (
            smoke(&json!({"transform": {"translation": [1e7, 0, 0]}})),
            "media[0].transform",
            "coordinates",
        ),
    ] {
        let error = build_at(&json!([medium]), folder.path()).unwrap_err();
        assert_eq!(error.path(), Some(path), "{error}");
        assert!(error.to_string().contains(part), "{error}");
    }
    let base = json!({"kind": "procedural", "pattern": "cloud", "sigma_t": 1, "albedo": 1});
    for (name, value) in [
        ("resolution", json!(7)),
        ("resolution", json!(257)),
        ("octaves", json!(0)),
        ("octaves", json!(9)),
        ("seed", json!(1_u64 << 53)),
        ("pattern", json!("fire")),
    ] {
        let mut medium = base.clone();
        medium[name] = value;
        let error = description(&json!([medium])).unwrap_err();
        assert_eq!(
            error.path(),
            Some(format!("media[0].{name}").as_str()),
            "{error}"
        );
    }
}

#[cfg(unix)]
#[test]
fn descriptions_of_raw_voxels_may_not_leave_the_folder() {
    let folder = tempfile::tempdir().unwrap();
    let outside = tempfile::tempdir().unwrap();
    let text = r#"{"size": [2, 2, 2], "type": "u8"}"#;
    std::fs::write(folder.path().join("fog.raw"), [128; 8]).unwrap();
    std::fs::write(folder.path().join("fog.json"), text).unwrap();
    let media = json!([smoke(&json!({"path": "fog.raw"}))]);
    let loaded = build_at(&media, folder.path()).unwrap();
    assert_eq!(grid(&loaded, 0).max(), 128.0 / 255.0);
    std::fs::write(outside.path().join("secret.json"), text).unwrap();
    let link = folder.path().join("fog.raw.json");
    std::os::unix::fs::symlink(outside.path().join("secret.json"), link).unwrap();
    let error = build_at(&media, folder.path()).unwrap_err();
    assert_eq!(error.path(), Some("media[0].path"));
    assert!(error.to_string().contains("link that leaves"), "{error}");
}

#[test]
fn grids_are_bounded_together() {
    let folder = folder();
    let media = json!([
        smoke(&json!({})),
        smoke(&json!({})),
        smoke(&json!({"grid": "heat"}))
    ]);
    let build = |grid_bytes, grid_file_bytes| {
        let limits = Limits {
            grid_bytes,
            grid_file_bytes,
            ..Limits::default()
        };
        build_with(description(&media).unwrap(), Some(folder.path()), &limits)
    };
    let loaded = build(1 << 20, 1 << 20).unwrap();
    let [smoke, heat] = [0, 2].map(|i| grid(&loaded, i).bytes());
    build(smoke + heat, 1 << 20).unwrap();
    for bytes in [0, smoke - 1, smoke + heat - 1] {
        let error = build(bytes, 1 << 20).unwrap_err();
        assert!(
            matches!(error, SceneError::Limit { limit, .. } if limit == bytes),
            "{error}"
        );
    }
    let error = build(1 << 20, 1000).unwrap_err();
    assert!(
        matches!(error, SceneError::Limit { limit: 1000, .. }),
        "{error}"
    );
    assert_eq!(error.path(), Some("media[0].path"));
}

#[test]
fn a_real_plume_is_read() {
    let Some(folder) = shared().map(|folder| folder.join("reference/data")) else {
        return;
    };
    let file = json!({"kind": "grid", "sigma_t": 1, "albedo": 1, "path": "density_plume.npz"});
    let loaded = build_at(&json!([file]), &folder).unwrap();
    let grid = grid(&loaded, 0);
    println!("{grid:?}");
    assert!(grid.max() <= 1.0 && grid.max() > 0.5);
    let bounds = facts(&loaded.scene).bounds;
    assert!((bounds.min - DVec3::ZERO).length() + (bounds.max - DVec3::ONE).length() < 1e-9);
}
