//! Real files of the shared folder, against what OpenVDB 10.0.1 counts in them.

#![allow(clippy::unreadable_literal, reason = "as Python writes them")]

use std::path::PathBuf;
use std::time::Instant;

use glam::{DVec3, IVec3};
use tyndall_volume::{Grid, ReadOptions, VolumeError, VolumeLimits, read};

/// The folder of volumes, or `None` after saying aloud that `what` is skipped.
fn folder(what: &str) -> Option<PathBuf> {
    let shared = std::env::var_os("TYNDALL_SHARED").map_or_else(
        || PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared")),
        PathBuf::from,
    );
    let folder = shared.join("data/volumes");
    if folder.is_dir() {
        return Some(folder);
    }
    eprintln!("SKIPPED: {what}: {} is absent", folder.display());
    None
}

fn options(grid: Option<&str>) -> ReadOptions {
    ReadOptions {
        grid: grid.map(str::to_owned),
    }
}

/// Number, smallest, largest and sum of the voxels above 0.
fn statistics(grid: &Grid) -> (u64, f32, f32, f64) {
    let size = grid.size().as_ivec3();
    let mut result = (0, f32::INFINITY, 0.0_f32, 0.0);
    for z in 0..size.z {
        for y in 0..size.y {
            for x in 0..size.x {
                let value = grid.voxel(IVec3::new(x, y, z));
                if value > 0.0 {
                    result.0 += 1;
                    result.1 = result.1.min(value);
                    result.2 = result.2.max(value);
                    result.3 += f64::from(value);
                }
            }
        }
    }
    result
}

/// What OpenVDB says of a grid: file, name, lowest and highest active voxel, the voxels above 0 in
/// that box (number, smallest, largest, sum), and where index (0, 0, 0) and (10, 20, 30) lie.
type Expected = (
    &'static str,
    &'static str,
    [i32; 3],
    [i32; 3],
    u64,
    f64,
    f64,
    f64,
    [f64; 3],
    [f64; 3],
);

#[rustfmt::skip]
const EXPECTED: &[Expected] = &[
    ("vdb/arnold_grids.vdb", "density[0]", [-5, -5, -5], [5, 5, 5], 491, 2.2351741790771484e-06, 10.0, 2057.87622000277, [4.0, 0.0, 0.0], [5.000000014901161, 2.0000000298023224, 3.0000000447034836]),
    ("vdb/arnold_grids.vdb", "density[1]", [-9, -13, -9], [9, 5, 12], 2222, 0.00041474896715953946, 10.0, 9430.390896742989, [2.0, 0.0, 0.0], [3.000000014901161, 2.0000000298023224, 3.0000000447034836]),
    ("vdb/arnold_grids.vdb", "density[2]", [-5, -5, -5], [5, 5, 5], 803, 2.731879249040503e-06, 10.0, 2959.6419492264313, [0.0, 0.0, 0.0], [1.0000000149011612, 2.0000000298023224, 3.0000000447034836]),
    ("vdb/arnold_torus01.vdb", "voxel_fog_density", [-25, -4, 1], [-4, 4, 22], 2450, 0.026869773864746094, 100.0, 146139.79035496712, [0.0, 0.0, 0.0], [4.032309651374817, 8.064619302749634, 12.09692895412445]),
    ("vdb/dragon.vdb", "density", [16, 1, 35], [85, 49, 65], 19660, 2.8933087378391065e-05, 1.0, 10186.861159738584, [0.0, 0.0, 0.0], [1.0000000149011612, 2.0000000298023224, 3.0000000447034836]),
    ("vdb/dragon_with_xform.vdb", "density", [-70, 1, -31], [70, 99, 31], 156161, 1.9868214167217957e-06, 1.0, 111538.4027961671, [-0.20000000298023224, 0.20000000298023224, -0.20000000298023224], [1.6335467820398026, 2.4963614835792995, 3.194824016017079]),
    ("vdb/openusd/densityAndHeat.vdb", "density", [1, 1, 31], [23, 23, 72], 6124, 0.0010011219419538975, 0.9975093603134155, 399.72408362606075, [-8.440519332885742, -8.440519332885742, -24.134912490844727], [-1.406753420829773, 5.627012491226196, -2.6412594318389893]),
    ("nvdb/converted/densityAndHeat_2grids_zip.nvdb", "density", [1, 1, 31], [23, 23, 72], 6124, 0.0010011219419538975, 0.9975093603134155, 399.72408362606075, [-8.440519332885742, -8.440519332885742, -24.134912490844727], [-1.406753420829773, 5.627012491226196, -2.6412594318389893]),
    ("vdb/openusd/densityAndHeat.vdb", "heat", [2, 2, 31], [23, 22, 62], 5224, 0.001000175136141479, 0.7595377564430237, 276.5202852204675, [-8.440519332885742, -8.440519332885742, -24.134912490844727], [-1.406753420829773, 5.627012491226196, -2.6412594318389893]),
    ("nvdb/converted/densityAndHeat_2grids_zip.nvdb", "heat", [2, 2, 31], [23, 22, 62], 5224, 0.001000175136141479, 0.7595377564430237, 276.5202852204675, [-8.440519332885742, -8.440519332885742, -24.134912490844727], [-1.406753420829773, 5.627012491226196, -2.6412594318389893]),
    ("vdb/openusd/smoke_000002.vdb", "density", [1, 1, 11], [51, 49, 90], 71983, 0.001000517513602972, 0.8721543550491333, 26291.570476724417, [-3.4476253986358643, -3.322587013244629, -2.6402316093444824], [-2.121615618467331, -0.6645172834396362, 1.3106752336025238]),
    ("vdb/openusd/smoke_000003.vdb", "density", [1, 1, 3], [51, 49, 98], 90197, 0.0010000159963965416, 0.9999847412109375, 29401.88654314354, [-3.4476253986358643, -3.322587013244629, -2.6402316093444824], [-2.121615618467331, -0.6645172834396362, 1.3106752336025238]),
    ("nvdb/converted/smoke_000003_raw.nvdb", "density", [1, 1, 3], [51, 49, 98], 90197, 0.0010000159963965416, 0.9999847412109375, 29401.88654314354, [-3.4476253986358643, -3.322587013244629, -2.6402316093444824], [-2.121615618467331, -0.6645172834396362, 1.3106752336025238]),
    ("vdb/smoke.vdb", "density", [1, 2, 1], [111, 223, 112], 1049275, 1.0013580322265625e-05, 5.71484375, 171499.69552135468, [-34.04761904761898, -13.095238095238095, -26.42857142857139], [-29.285714285714235, -3.571428571428605, -12.142857142857157]),
    ("nvdb/converted/smoke_zip.nvdb", "density", [1, 2, 1], [111, 223, 112], 1049275, 1.0013580322265625e-05, 5.71484375, 171499.69552135468, [-34.04761904761898, -13.095238095238095, -26.42857142857139], [-29.285714285714235, -3.571428571428605, -12.142857142857157]),
    ("vdb/sphere_fog_gaffer.vdb", "density", [-5, -4, -5], [5, 4, 5], 465, 1.1165833768700395e-07, 1.0, 116.32086043764735, [0.0, 2.0, 0.0], [2.0000000298023224, 6.000000059604645, 6.000000089406967]),
    ("vdb/wdas_cloud_sixteenth.vdb", "density", [-66, -21, -90], [59, 64, 63], 363037, 1.6574470795009762e-37, 1.0, 188542.10390198563, [0.0, 0.0, 0.0], [33.333332538604736, 66.66666507720947, 99.99999761581421]),
];

#[test]
fn real_trees_agree_with_openvdb() {
    let Some(folder) = folder("real OpenVDB and NanoVDB files") else {
        return;
    };
    for (file, name, low, high, count, min, max, sum, zero, other) in EXPECTED {
        let limits = VolumeLimits::default();
        let start = Instant::now();
        let grid = read(&folder.join(file), &options(Some(name)), &limits)
            .unwrap_or_else(|error| panic!("{file} {name}: {error}"));
        let millis = start.elapsed().as_millis();
        eprintln!(
            "{file} {name}: {millis} ms, {} bricks stored, {} KiB",
            grid.stored_bricks(),
            grid.bytes() / 1024
        );
        let (low, high) = (IVec3::from_array(*low), IVec3::from_array(*high));
        let span = grid.clip[1] - grid.clip[0];
        assert_eq!(span, (high - low + 2).as_dvec3(), "{file} {name}");
        let found = statistics(&grid);
        assert_eq!(
            (found.0, f64::from(found.1), f64::from(found.2)),
            (*count, *min, *max),
            "{file} {name}"
        );
        assert!(
            (found.3 - sum).abs() < 1e-9 * sum,
            "{file} {name}: {}",
            found.3
        );
        assert_eq!(f64::from(grid.max()), *max);
        // Lattice point of index (0, 0, 0): the clip begins one voxel before the lowest.
        let origin = grid.clip[0] - (low - 1).as_dvec3();
        let [zero, other] = [zero, other].map(|place| DVec3::from_array(*place));
        let to_world = |index: DVec3| grid.world_from_lattice.transform_point3(origin + index);
        assert!(
            to_world(DVec3::ZERO).abs_diff_eq(zero, 1e-9),
            "{file} {name}"
        );
        let found = to_world(DVec3::new(10.0, 20.0, 30.0));
        assert!(found.abs_diff_eq(other, 1e-9), "{file} {name}: {found}");
    }
}

#[test]
fn bricks_of_a_sparse_tree_are_those_of_its_leaves() {
    let Some(folder) = folder("real OpenVDB files") else {
        return;
    };
    let path = folder.join("vdb/wdas_cloud_sixteenth.vdb");
    let grid = read(&path, &options(None), &VolumeLimits::default()).unwrap();
    // OpenVDB counts 1,241 leaves; some of them hold nothing.
    assert!(grid.stored_bricks() <= 1241, "{}", grid.stored_bricks());
}

#[test]
fn other_kinds_of_real_grids_are_refused_by_name() {
    let Some(folder) = folder("real files of other kinds") else {
        return;
    };
    for (file, name) in [
        ("nvdb/rocks.nvdb", "level set"),
        ("nvdb/test_grid.nvdb", "level set"),
        ("nvdb/torus.nvdb", "level set"),
        ("nvdb/test_int32_grid.nvdb", "int32"),
        ("nvdb/test_vec_grid.nvdb", "vec3f"),
        ("nvdb/test_index_grid.nvdb", "onindex"),
        ("vol/albedo.vol", "3 channels"),
        ("ktx2/bunny.ktx2", "ktx2"),
    ] {
        let error = read(&folder.join(file), &options(None), &VolumeLimits::default()).unwrap_err();
        assert!(
            matches!(error, VolumeError::Unsupported { .. }) && error.to_string().contains(name),
            "{file}: {error}"
        );
    }
}

#[test]
fn real_dense_grids_agree_with_what_is_written_beside_them() {
    let Some(folder) = folder("real raw and Mitsuba files") else {
        return;
    };
    for (file, size, max, mean) in [
        (
            "raw/bunny_64x64x64.raw",
            [64, 64, 64],
            1.0,
            0.205_879_211_425_781_25,
        ),
        (
            "raw/fog_noise_64x64x64.raw",
            [64, 64, 64],
            1.0,
            0.285_334_302_051_125_4,
        ),
        (
            "raw/fire_density_23x23x42.raw",
            [23, 23, 42],
            0.997_509_36,
            0.017_991_002_056_533_61,
        ),
        (
            "raw/smoke_000003_51x49x96.raw",
            [51, 49, 96],
            0.999_984_74,
            0.122_556_883_349_731_3,
        ),
        ("vol/sigmat.vol", [16, 16, 16], 5.0, 0.609156635866384),
    ] {
        let path = folder.join(file);
        let grid = read(&path, &options(None), &VolumeLimits::default()).unwrap();
        let size = IVec3::from_array(size);
        assert_eq!(grid.size().as_ivec3(), size + 2, "{file}");
        let mut sum = 0.0;
        for z in 1..=size.z {
            for y in 1..=size.y {
                for x in 1..=size.x {
                    sum += f64::from(grid.voxel(IVec3::new(x, y, z)));
                }
            }
        }
        assert_eq!(grid.max(), max, "{file}");
        let found = sum / f64::from(size.element_product());
        assert!((found - mean).abs() < 1e-6 * mean, "{file}: {found}");
    }
    let path = folder.join("raw/smoke_000003_51x49x96.raw");
    let grid = read(&path, &options(None), &VolumeLimits::default()).unwrap();
    let first = grid.world_from_lattice.transform_point3(DVec3::ONE);
    let expected = DVec3::new(
        -3.315_024_420_619_011,
        -3.189_683_526_754_379_3,
        -2.245_140_925_049_782,
    );
    assert!(first.abs_diff_eq(expected, 1e-9), "{first}");
}
