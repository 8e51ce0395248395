//! Grids that are made: where they lie, how full they are, that they are made once.

use glam::IVec3;

use super::{Arc, Grid, Pattern, Procedural, VolumeLimits};

fn procedural(pattern: Pattern, resolution: u32) -> Procedural {
    Procedural {
        pattern,
        resolution,
        octaves: 5,
        seed: 0,
    }
}

fn mean(grid: &Grid) -> f64 {
    let size = grid.size().as_ivec3();
    let mut sum = 0.0;
    for z in 0..size.z {
        for y in 0..size.y {
            for x in 0..size.x {
                sum += f64::from(grid.voxel(IVec3::new(x, y, z)));
            }
        }
    }
    sum / size.as_dvec3().element_product()
}

#[test]
fn grids_are_made_fast_and_lie_inside_their_box() {
    for pattern in [Pattern::SmokePlume, Pattern::Cloud] {
        let made = procedural(pattern, 128);
        let start = std::time::Instant::now();
        let grid = made.generate(&VolumeLimits::default()).unwrap();
        let seconds = start.elapsed().as_secs_f64();
        let (max, mean) = (grid.max(), mean(&grid));
        println!(
            "{pattern:?}: {} voxels, {} bricks, max {max}, mean {mean:.4}, {seconds:.2} s",
            grid.size(),
            grid.stored_bricks()
        );
        assert_eq!(grid.size().to_array(), made.size());
        assert!((0.6..=1.0).contains(&max), "{max}");
        assert!((0.01..0.4).contains(&mean), "{mean}");
        let size = grid.size().as_ivec3();
        for axis in 0..3 {
            for side in [0, size[axis] - 1] {
                for i in 0..size[(axis + 1) % 3] {
                    for j in 0..size[(axis + 2) % 3] {
                        let mut at = IVec3::ZERO;
                        at[axis] = side;
                        at[(axis + 1) % 3] = i;
                        at[(axis + 2) % 3] = j;
                        // The plume comes out of the ground.
                        if pattern == Pattern::Cloud || axis != 1 {
                            assert_eq!(grid.voxel(at), 0.0, "{pattern:?} {at}");
                        }
                    }
                }
            }
        }
        let low = grid.world_from_lattice.transform_point3(grid.clip[0]);
        let high = grid.world_from_lattice.transform_point3(grid.clip[1]);
        assert!((low.x + high.x).abs() < 1e-9 && low.y.abs() < 1e-9);
        assert!(((high - low).max_element() - 1.0).abs() < 1e-9);
    }
}

#[test]
fn an_outline_stands_where_the_grid_does_and_is_nowhere_thinner() {
    let limits = VolumeLimits::default();
    for pattern in [Pattern::SmokePlume, Pattern::Cloud] {
        let made = procedural(pattern, 31);
        let (outline, grid) = (
            made.outline(&limits).unwrap(),
            made.generate(&limits).unwrap(),
        );
        assert_eq!(outline.size(), grid.size());
        assert_eq!(outline.clip, grid.clip);
        assert_eq!(outline.world_from_lattice, grid.world_from_lattice);
        assert_eq!(mean(&outline), 1.0);
        assert!(
            made.outline(&VolumeLimits {
                grid_bytes: 9,
                ..limits
            })
            .is_err()
        );
    }
}

#[test]
fn skipped_bricks_are_empty() {
    for pattern in [Pattern::SmokePlume, Pattern::Cloud] {
        for seed in 0..4 {
            let made = Procedural {
                seed,
                ..procedural(pattern, 48)
            };
            let density = match pattern {
                Pattern::SmokePlume => super::Density::Plume(super::Plume::new(&made)),
                Pattern::Cloud => super::Density::Cloud(super::Cloud::new(&made)),
            };
            let grid = made.generate(&VolumeLimits::default()).unwrap();
            let size = grid.size().as_ivec3();
            for z in (0..size.z).step_by(2) {
                for y in 0..size.y {
                    for x in 0..size.x {
                        let voxel = IVec3::new(x, y, z);
                        let p = grid.world_from_lattice.transform_point3(voxel.as_dvec3());
                        let truth = density.at(p.as_vec3()).clamp(0.0, 1.0);
                        let found = grid.voxel(voxel);
                        assert!((found - truth).abs() < 1e-3, "{pattern:?} {seed} {voxel}");
                    }
                }
            }
        }
    }
}

#[test]
fn resolution_refines_the_same_thing_and_seeds_differ() {
    for pattern in [Pattern::SmokePlume, Pattern::Cloud] {
        let limits = VolumeLimits::default();
        let coarse = procedural(pattern, 48).generate(&limits).unwrap();
        let fine = procedural(pattern, 96).generate(&limits).unwrap();
        assert!((mean(&coarse) / mean(&fine) - 1.0).abs() < 0.15);
        let other = Procedural {
            seed: 1,
            ..procedural(pattern, 48)
        };
        let other = other.generate(&limits).unwrap();
        assert_ne!(mean(&other), mean(&coarse));
        for resolution in [8, 9, 11, 31] {
            let grid = procedural(pattern, resolution).generate(&limits).unwrap();
            assert!(grid.max() > 0.0 && grid.max() <= 1.0);
        }
    }
}

#[test]
fn a_grid_is_made_once_and_memory_is_bounded() {
    let limits = VolumeLimits::default();
    let made = procedural(Pattern::Cloud, 24);
    let first = made.grid(&limits).unwrap();
    assert!(Arc::ptr_eq(&first, &made.grid(&limits).unwrap()));
    let tight = VolumeLimits {
        grid_bytes: 1000,
        ..limits
    };
    assert!(made.grid(&tight).is_err());
    for (resolution, octaves) in [(7, 5), (257, 5), (32, 0), (32, 9)] {
        let wrong = Procedural {
            resolution,
            octaves,
            ..made
        };
        assert!(wrong.grid(&limits).is_err());
    }
}
