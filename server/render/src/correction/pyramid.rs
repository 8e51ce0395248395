//! The levels of residuals: how large each is and where it lies in the buffers that all share.

use tyndall_shaders::types::PyramidLevel;
use wgpu::util::DeviceExt as _;

use crate::engine::Device;

/// Levels of residuals at most; coarser bands hold little else than the mean.
const MOST_LEVELS: u32 = 6;
/// The coarsest level keeps at least about so many cells along each side.
const FEWEST_CELLS: u32 = 4;

/// One level on the device.
#[derive(Debug)]
pub(super) struct Level {
    pub value: PyramidLevel,
    pub buffer: wgpu::Buffer,
}

impl Level {
    /// Width and height of it.
    pub fn own(&self) -> [u32; 2] {
        [self.value.width, self.value.height]
    }

    /// Of the next coarser one.
    pub fn coarse(&self) -> [u32; 2] {
        [self.value.coarse_width, self.value.coarse_height]
    }

    /// Of the one after that.
    pub fn window(&self) -> [u32; 2] {
        [self.value.window_width, self.value.window_height]
    }
}

/// The levels of a picture of this size, the finest first.
pub(super) fn levels(device: &Device, [width, height]: [u32; 2]) -> Vec<Level> {
    let uploaded = |value: PyramidLevel| Level {
        buffer: device
            .device
            .create_buffer_init(&wgpu::util::BufferInitDescriptor {
                label: Some("pyramid_level"),
                contents: bytemuck::bytes_of(&value),
                usage: wgpu::BufferUsages::STORAGE,
            }),
        value,
    };
    layout(width, height).0.into_iter().map(uploaded).collect()
}

/// Cells of all grids together.
pub(super) fn cells([width, height]: [u32; 2]) -> u64 {
    let cells = |[w, h]: &[u32; 2]| u64::from(*w) * u64::from(*h);
    sizes(width, height).iter().map(cells).sum()
}

/// Sizes of the levels of residuals, and of the two coarser grids that the last band's energies need.
fn sizes(width: u32, height: u32) -> Vec<[u32; 2]> {
    let cells = width.min(height) / FEWEST_CELLS;
    let halvings = cells.checked_ilog2().unwrap_or(0).min(MOST_LEVELS - 1);
    let mut sizes = vec![[width, height]];
    for _ in 0..halvings + 2 {
        let [w, h] = sizes[sizes.len() - 1];
        sizes.push([w.div_ceil(2), h.div_ceil(2)]);
    }
    sizes
}

/// The levels of residuals, and the cells of all grids together.
fn layout(width: u32, height: u32) -> (Vec<PyramidLevel>, u64) {
    let sizes = sizes(width, height);
    let mut firsts = vec![0];
    for [w, h] in &sizes {
        firsts.push(firsts[firsts.len() - 1] + w * h);
    }
    let levels = (0..sizes.len() - 2)
        .map(|j| PyramidLevel {
            width: sizes[j][0],
            height: sizes[j][1],
            first: firsts[j],
            coarsest: u32::from(j + 3 == sizes.len()),
            coarse_width: sizes[j + 1][0],
            coarse_height: sizes[j + 1][1],
            coarse_first: firsts[j + 1],
            window_width: sizes[j + 2][0],
            window_height: sizes[j + 2][1],
            window_first: firsts[j + 2],
            // A cell of level j stands for 4^j pixels, and its weight is their mean.
            enough: 0.5 * 0.25_f32.powi(j as i32),
        })
        .collect();
    (levels, u64::from(firsts[sizes.len()]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn levels_halve_down_to_a_few_cells_and_fit_any_size() {
        for (width, height, count) in [
            (1, 1, 1),
            (7, 1, 1),
            (1, 300, 1),
            (33, 17, 3),
            (160, 120, 5),
            (1920, 1080, 6),
        ] {
            let (levels, cells) = layout(width, height);
            assert_eq!(levels.len(), count, "{width}×{height}");
            assert_eq!(levels[0].width * levels[0].height, width * height);
            assert_eq!(levels[count - 1].coarsest, 1);
            for pair in levels.windows(2) {
                assert_eq!(pair[0].coarse_first, pair[1].first);
                assert_eq!(pair[0].coarsest, 0);
            }
            let last = levels[count - 1];
            let end = last.window_first + last.window_width * last.window_height;
            assert_eq!(u64::from(end), cells);
        }
    }
}
