//! A density grid that scenes share, with what the planner asks about it.

use std::fmt;
use std::sync::Arc;

use glam::{IVec3, UVec3};
use tyndall_volume::{BRICK_SIDE, Brick, Grid};

/// A grid shared between scenes that differ in camera, lights, coefficients or placement only.
///
/// Equality is identity (`Arc::ptr_eq`), as for [`crate::SharedGeometry`].
#[derive(Clone)]
pub struct SharedGrid {
    grid: Arc<Grid>,
    stats: GridStats,
}

/// What is computed once of a grid. Lengths are in steps of the lattice.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct GridStats {
    /// Mean of the samples inside the lattice.
    pub mean: f64,
    /// Integral of the density along the lattice's x, y and z through the densest column of
    /// bricks, averaged over the column's samples (8 × 8, fewer at the lattice's end).
    pub columns: [f64; 3],
}

impl SharedGrid {
    /// Takes a grid in. Cost: one pass over its samples.
    pub fn new(grid: Arc<Grid>) -> Self {
        let stats = stats(&grid);
        Self { grid, stats }
    }

    /// The grid, for those who keep it.
    pub fn arc(&self) -> &Arc<Grid> {
        &self.grid
    }

    /// What was computed when it was taken in.
    pub fn stats(&self) -> GridStats {
        self.stats
    }
}

/// Without the voxels.
impl fmt::Debug for SharedGrid {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("SharedGrid")
            .field("name", &self.grid.name)
            .field("size", &self.grid.size())
            .field("bricks", &self.grid.stored_bricks())
            .field("max", &self.grid.max())
            .field("stats", &self.stats)
            .finish()
    }
}

impl PartialEq for SharedGrid {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.grid, &other.grid)
    }
}

impl std::ops::Deref for SharedGrid {
    type Target = Grid;

    fn deref(&self) -> &Grid {
        &self.grid
    }
}

fn stats(grid: &Grid) -> GridStats {
    let counts = grid.brick_counts();
    let plane = |axis: usize| {
        let [a, b] = [(axis + 1) % 3, (axis + 2) % 3];
        vec![0.0_f64; counts[a] as usize * counts[b] as usize]
    };
    let mut columns = [plane(0), plane(1), plane(2)];
    let sum = |brick: &Brick| brick.iter().copied().map(f64::from).sum();
    let sums: Vec<f64> = grid.stored().iter().map(sum).collect();
    let mut total = 0.0;
    let size = grid.size();
    for z in 0..counts.z {
        for y in 0..counts.y {
            for x in 0..counts.x {
                let at = IVec3::new(x as i32, y as i32, z as i32);
                let Some(slot) = grid.brick_slot(at) else {
                    continue;
                };
                let sum = sums[slot as usize];
                total += sum;
                let at = UVec3::new(x, y, z);
                for (axis, columns) in columns.iter_mut().enumerate() {
                    let [a, b] = [(axis + 1) % 3, (axis + 2) % 3];
                    let rays: f64 = [a, b]
                        .map(|i| f64::from((size[i] - BRICK_SIDE * at[i]).min(BRICK_SIDE)))
                        .into_iter()
                        .product();
                    columns[at[a] as usize + counts[a] as usize * at[b] as usize] += sum / rays;
                }
            }
        }
    }
    // Samples outside the clip box count, too, but never for more than the box's length.
    let most = f64::from(grid.max()) * (grid.clip[1] - grid.clip[0]);
    let densest = columns.map(|columns| columns.into_iter().fold(0.0, f64::max));
    GridStats {
        mean: total / grid.size().as_dvec3().element_product(),
        columns: std::array::from_fn(|axis| densest[axis].min(most[axis])),
    }
}
