//! Bounds of the field in coarse cells: what tracking steps through.

use super::EMPTY_BRICK;

/// A dense grid of bounds. Cell (x, y, z) covers bricks `cell_bricks`·(x, y, z) and on, as many
/// along each axis.
#[derive(Debug, Clone, PartialEq)]
pub struct MajorantGrid {
    /// Bricks along an edge of a cell: the least power of two that keeps the cells within
    /// [`super::AtlasLimits::max_cells`]. A cell is never smaller than a brick of 8³ voxels, below
    /// which stepping costs more than it saves.
    pub cell_bricks: u32,
    /// Cells along x, y, z.
    pub size: [u32; 3],
    /// Least and largest value of the trilinear field in each cell, x fastest.
    pub ranges: Vec<[f32; 2]>,
}

impl MajorantGrid {
    /// A grid of the right size, without ranges.
    pub(super) fn empty(bricks: [u32; 3], max_cells: u64) -> Self {
        let mut cell_bricks = 1;
        loop {
            let grid = Self {
                cell_bricks,
                size: bricks.map(|count| count.div_ceil(cell_bricks)),
                ranges: Vec::new(),
            };
            if grid.cell_count() <= u128::from(max_cells.max(1)) {
                return grid;
            }
            cell_bricks *= 2;
        }
    }

    /// Cells.
    pub(super) fn cell_count(&self) -> u128 {
        self.size.map(u128::from).into_iter().product()
    }

    /// Finds the ranges from those of the bricks.
    pub(super) fn fill(&mut self, bricks: [u32; 3], table: &[u32], slots: &[[f32; 2]]) {
        self.ranges = vec![[f32::MAX, 0.0]; self.cell_count() as usize];
        let [nx, ny, _] = bricks.map(|count| count as usize);
        let [cx, cy, _] = self.size.map(|count| count as usize);
        let side = self.cell_bricks as usize;
        for (row, entries) in table.chunks_exact(nx).enumerate() {
            let (y, z) = (row % ny, row / ny);
            let first = cx * (y / side + cy * (z / side));
            for (cell, bricks) in self.ranges[first..].iter_mut().zip(entries.chunks(side)) {
                for entry in bricks {
                    let [min, max] = match *entry {
                        EMPTY_BRICK => [0.0, 0.0],
                        slot => slots[slot as usize],
                    };
                    *cell = [cell[0].min(min), cell[1].max(max)];
                }
            }
        }
    }
}
