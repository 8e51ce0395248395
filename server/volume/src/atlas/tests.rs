//! The atlas against the grid that it was made from.

use glam::{DAffine3, DVec3, IVec3, UVec3};

use super::{AtlasLimits, BrickAtlas, EMPTY_BRICK};
use crate::{BRICK_SIDE, BRICK_VOXELS, Grid, GridBuilder, VolumeError, VolumeLimits};

/// A fixed generator of numbers in [0, 1).
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(0x5851_f42d_4c95_7f2d)
            .wrapping_add(0x1405_7b7e_f767_814f);
        (self.0 >> 40) as f64 / (1_u64 << 24) as f64
    }

    fn below(&mut self, n: u32) -> u32 {
        (self.next() * f64::from(n)) as u32
    }
}

fn grid(size: [u32; 3], clip: [DVec3; 2], value: impl Fn(UVec3) -> f32) -> Grid {
    let mut builder = GridBuilder::new(size, &VolumeLimits::default()).unwrap();
    let bricks = size.map(|side| side.div_ceil(BRICK_SIDE));
    for z in 0..bricks[2] {
        for y in 0..bricks[1] {
            for x in 0..bricks[0] {
                let brick = UVec3::new(x, y, z);
                let values = std::array::from_fn(|i| {
                    let i = i as u32;
                    value(brick * 8 + UVec3::new(i % 8, i / 8 % 8, i / 64))
                });
                builder.set_brick(brick, &values).unwrap();
            }
        }
    }
    builder.finish("test", DAffine3::IDENTITY, clip)
}

fn atlas(grid: &Grid) -> BrickAtlas {
    BrickAtlas::new(grid, &AtlasLimits::default()).unwrap()
}

/// Points inside the clip box: random, on brick borders, on the clip's faces.
fn points(grid: &Grid, random: &mut Random) -> Vec<DVec3> {
    let [low, high] = grid.clip;
    let mut points = Vec::new();
    for i in 0..4000 {
        let mut p = low + (high - low) * DVec3::new(random.next(), random.next(), random.next());
        match i % 4 {
            1 => {
                p[i / 4 % 3] =
                    ((p[i / 4 % 3] / 8.0).round() * 8.0).clamp(low[i / 4 % 3], high[i / 4 % 3]);
            }
            2 => p[i / 4 % 3] = if i % 8 == 2 { low } else { high }[i / 4 % 3],
            3 => p = p.round().clamp(low, high),
            _ => {}
        }
        points.push(p);
    }
    points.extend([low, high]);
    points
}

/// Half a quantisation step of the brick at `p`, plus rounding.
fn tolerance(atlas: &BrickAtlas, p: DVec3) -> f64 {
    let cell = (p - atlas.origin.as_dvec3()).floor().as_uvec3();
    let brick = cell.min(UVec3::from_array(atlas.cells) - 1) / 8;
    let [nx, ny, _] = atlas.bricks;
    match atlas.table[(brick.x + nx * (brick.y + ny * brick.z)) as usize] {
        EMPTY_BRICK => 0.0,
        slot => {
            let [min, max] = atlas.ranges[slot as usize].map(f64::from);
            (max - min) / 65535.0 * 0.51 + 1e-6 * max
        }
    }
}

fn assert_equal(grid: &Grid, seed: u64) {
    let atlas = atlas(grid);
    for p in points(grid, &mut Random(seed)) {
        let (found, truth) = (f64::from(atlas.sample(p)), grid.sample(p));
        let error = (found - truth).abs();
        assert!(error <= tolerance(&atlas, p), "{p}: {found} is not {truth}");
        let brick = (p - atlas.origin.as_dvec3()).floor().as_uvec3();
        let brick = brick.min(UVec3::from_array(atlas.cells) - 1) / 8;
        let cell = brick / atlas.majorants.cell_bricks;
        let [nx, ny, _] = atlas.majorants.size;
        let index = (cell.x + nx * (cell.y + ny * cell.z)) as usize;
        let [min, max] = atlas.majorants.ranges[index].map(f64::from);
        let slack = 1e-6 * max;
        assert!(
            (min - slack..=max + slack).contains(&truth),
            "{p}: {truth} outside {min}..{max}"
        );
    }
    for p in [grid.clip[0] - 0.01, grid.clip[1] + 0.01] {
        assert_eq!(atlas.sample(p), 0.0);
    }
}

/// Not constant anywhere, not aligned with bricks.
fn waves(v: UVec3) -> f32 {
    let v = v.as_vec3();
    (v.x * 0.7).sin().abs() * (1.0 + 40.0 * (v.y * 0.31).cos().abs()) + 0.02 * v.z
}

#[test]
fn the_atlas_decodes_to_the_grid() {
    let size = [37, 20, 9];
    let top = DVec3::new(36.0, 19.0, 8.0);
    for (seed, clip) in [
        [DVec3::ZERO, top],
        [DVec3::splat(-0.5), top + 0.5],
        [DVec3::splat(-1.0), top + 1.0],
        [DVec3::splat(-11.25), top + 20.5],
        [DVec3::new(3.25, 8.0, 2.0), DVec3::new(24.0, 16.0, 7.75)],
    ]
    .into_iter()
    .enumerate()
    {
        assert_equal(&grid(size, clip, waves), seed as u64 + 1);
    }
}

#[test]
fn a_grid_with_holes_decodes_to_itself() {
    let size = [64, 64, 64];
    let clip = [DVec3::splat(-0.5), DVec3::splat(63.5)];
    let ball = |v: UVec3| (20.0 - (v.as_vec3() - 31.5).length()).max(0.0);
    let grid = grid(size, clip, ball);
    assert_equal(&grid, 9);
    let atlas = atlas(&grid);
    assert_eq!(atlas.origin, IVec3::splat(-1));
    assert!(atlas.slots() < 300, "{}", atlas.slots());
}

#[test]
fn majorants_are_the_largest_sample_of_their_cells() {
    let grid = grid(
        [64, 40, 24],
        [DVec3::ZERO, DVec3::new(63.0, 39.0, 23.0)],
        waves,
    );
    let limits = AtlasLimits {
        max_cells: 30,
        ..AtlasLimits::default()
    };
    let atlas = BrickAtlas::new(&grid, &limits).unwrap();
    let cells = &atlas.majorants;
    assert_eq!((cells.cell_bricks, cells.size), (2, [4, 3, 2]));
    for (i, [min, max]) in cells.ranges.iter().enumerate() {
        let cell = UVec3::new(i as u32 % 4, i as u32 / 4 % 3, i as u32 / 12) * 16;
        let (mut low, mut high) = (f32::MAX, 0.0_f32);
        // A cell of 16³ cells of the lattice has 17³ samples, fewer at the end of the lattice.
        for z in cell.z..=(cell.z + 16).min(23) {
            for y in cell.y..=(cell.y + 16).min(39) {
                for x in cell.x..=(cell.x + 16).min(63) {
                    let value = grid.voxel(IVec3::new(x as i32, y as i32, z as i32));
                    (low, high) = (low.min(value), high.max(value));
                }
            }
        }
        assert_eq!(*min, low, "cell {i}");
        assert!(
            (high..=high * 1.000_001).contains(max),
            "cell {i}: {max} is not {high}"
        );
    }
}

#[test]
fn no_decoded_value_leaves_its_range() {
    let mut random = Random(5);
    for _ in 0..20_000 {
        let min = (random.next() * 10_f64.powf(random.next() * 20.0 - 10.0)) as f32;
        let max = min + (random.next() * 10_f64.powf(random.next() * 20.0 - 10.0)) as f32;
        let pair = grid([2, 1, 1], [DVec3::ZERO, DVec3::X], |v| {
            if v.x == 0 { min } else { max }
        });
        let atlas = atlas(&pair);
        let [low, high] = atlas.ranges[0];
        assert!(low <= min && max <= high, "{min} {max}");
        for q in [0, 1, 32_768, 65_534, 65_535] {
            let value = super::decode_sample([low, high], q);
            assert!(
                (low..=high).contains(&value),
                "{q} of {low}..{high} is {value}"
            );
        }
    }
}

#[test]
fn constant_bricks_share_slots() {
    let clip = [DVec3::ZERO, DVec3::splat(63.0)];
    let one = atlas(&grid([64; 3], clip, |_| 0.75));
    assert_eq!((one.slots(), one.bricks), (1, [8; 3]));
    assert!(one.table.iter().all(|slot| *slot == 0));
    assert_eq!(one.sample(DVec3::splat(63.0)), 0.75);
    let two = atlas(&grid([64; 3], clip, |v| if v.x < 33 { 1.0 } else { 2.0 }));
    // Those below, those above, and the layer of bricks between: one slot each for the first two.
    assert_eq!(two.slots(), 2 + 64);
}

#[test]
fn an_empty_grid_has_no_slots() {
    let grid = grid(
        [20, 20, 20],
        [DVec3::splat(-0.5), DVec3::splat(19.5)],
        |_| 0.0,
    );
    let atlas = atlas(&grid);
    assert_eq!((atlas.slots(), atlas.values.len()), (0, 0));
    assert!(atlas.table.iter().all(|slot| *slot == EMPTY_BRICK));
    assert!(
        atlas
            .majorants
            .ranges
            .iter()
            .all(|range| *range == [0.0; 2])
    );
    assert_eq!(atlas.sample(DVec3::splat(3.0)), 0.0);
}

#[test]
fn a_single_voxel_is_a_point_or_a_tent() {
    let point = grid([1; 3], [DVec3::ZERO; 2], |_| 3.0);
    let sampled = atlas(&point);
    assert_eq!(sampled.cells, [1; 3]);
    assert_eq!(sampled.sample(DVec3::ZERO), 3.0);
    assert_eq!(sampled.sample(DVec3::splat(0.01)), 0.0);
    let tent = grid([1; 3], [DVec3::splat(-0.5), DVec3::splat(0.5)], |_| 3.0);
    assert_equal(&tent, 7);
    assert_eq!(atlas(&tent).sample(DVec3::splat(-0.5)), 3.0 / 8.0);
}

#[test]
fn a_huge_sparse_grid_stays_small() {
    let side: u32 = 2000;
    let bricks = side / BRICK_SIDE;
    let mut builder = GridBuilder::new([side; 3], &VolumeLimits::default()).unwrap();
    let mut random = Random(11);
    let active = u64::from(bricks).pow(3) / 1000;
    for _ in 0..active {
        let brick = UVec3::new(
            random.below(bricks),
            random.below(bricks),
            random.below(bricks),
        );
        let value = random.next() as f32 + 0.1;
        let mut values = [value; BRICK_VOXELS];
        values[random.below(512) as usize] = 0.0;
        builder.set_brick(brick, &values).unwrap();
    }
    let clip = [DVec3::splat(-0.5), DVec3::splat(f64::from(side) - 0.5)];
    let grid = builder.finish("sparse", DAffine3::IDENTITY, clip);
    let atlas = atlas(&grid);
    let megabytes = atlas.bytes() >> 20;
    println!(
        "{} of {active} bricks, {} slots, {megabytes} MiB",
        grid.stored_bricks(),
        atlas.slots()
    );
    assert_eq!(atlas.majorants.cell_bricks, 4);
    assert!(atlas.majorants.ranges.len() <= 64 * 64 * 64);
    // A table of 251³ entries, and each brick with the neighbours whose apron it fills.
    assert!(atlas.slots() as u64 <= active * 8);
    assert!(megabytes < 250, "{megabytes} MiB");
    let dense = u64::from(side).pow(3) * 2;
    assert!(atlas.bytes() < dense / 60);
}

#[test]
fn too_large_is_refused_before_it_is_allocated() {
    let grid = grid([64; 3], [DVec3::ZERO, DVec3::splat(63.0)], waves);
    let needed = atlas(&grid).bytes();
    for bytes in [0, 100, needed - 1] {
        let limits = AtlasLimits {
            bytes,
            ..AtlasLimits::default()
        };
        let error = BrickAtlas::new(&grid, &limits).unwrap_err();
        assert!(
            matches!(error, VolumeError::Limit { limit, .. } if limit == bytes),
            "{error}"
        );
    }
    let limits = AtlasLimits {
        bytes: needed,
        ..AtlasLimits::default()
    };
    BrickAtlas::new(&grid, &limits).unwrap();
    let mut wide = grid;
    wide.clip = [DVec3::splat(-9e8), DVec3::splat(9e8)];
    let error = BrickAtlas::new(&wide, &AtlasLimits::default()).unwrap_err();
    assert!(matches!(error, VolumeError::Limit { .. }), "{error}");
    for bad in [DVec3::NAN, DVec3::splat(1e300), DVec3::splat(-9.1e8)] {
        wide.clip[1] = bad;
        let error = BrickAtlas::new(&wide, &AtlasLimits::default()).unwrap_err();
        assert!(matches!(error, VolumeError::Invalid { .. }), "{error}");
    }
}
