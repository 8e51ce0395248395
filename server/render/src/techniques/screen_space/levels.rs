//! The levels of the picture: how large each is, how wide its kernel, and where it lies in the buffers that
//! all share.

use std::sync::Arc;

use tyndall_scene::{LevelFetch, Scene, ScreenSpaceFilter, ScreenSpaceSettings};
use tyndall_shaders::types::{FilterLevel, GatherRows};
use wgpu::util::DeviceExt as _;

use crate::engine::{Bindings, Device};
use crate::error::RenderError;
use crate::frame::{Kept, Preparation};

/// More levels are never needed: the last one's cells are thousands of pixels wide.
const MOST_LEVELS: u32 = 12;
/// The gathering filter is for pictures of at most so many pixels.
pub(super) const MOST_GATHERED: u64 = 1280 * 720;
/// Loop iterations of an invocation of the gathering filter at most.
const MOST_ITERATIONS: u64 = 60_000;
/// As in `gather.wesl`: deviations after which a kernel ends, the widest window, images of a row.
const DEVIATIONS: f32 = 4.5;
const WIDEST: f32 = 3000.0;
const IMAGES: u64 = 10;

/// What the filter keeps for one size and one setting.
#[derive(Debug)]
pub(super) struct Levels {
    size: [u32; 2],
    kept_for: ScreenSpaceSettings,
    /// Each with the next coarser one, the finest first; at least one.
    pub steps: Arc<Vec<Level>>,
    /// The same, in one buffer.
    all: wgpu::Buffer,
    /// Of the gathering filter, otherwise empty.
    pub rows: Arc<Vec<wgpu::Buffer>>,
    /// Loop iterations of each of those, a pixel.
    pub row_iterations: u64,
}

/// One level on the device.
#[derive(Debug)]
pub(super) struct Level {
    pub value: FilterLevel,
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
}

impl Levels {
    /// Before a picture's size is known.
    pub fn empty(device: &Device) -> Self {
        Self::new(device, [1, 1], ScreenSpaceSettings::default())
    }

    fn new(device: &Device, size: [u32; 2], settings: ScreenSpaceSettings) -> Self {
        let values = layout(size, &settings);
        let all = uploaded(device, "filter_levels", bytemuck::cast_slice(&values));
        let (rows, row_iterations) = if settings.filter == ScreenSpaceFilter::Gather {
            let (rows, iterations) = rows(size[1], values[0].largest_variance);
            let on_device =
                |value: &GatherRows| uploaded(device, "gather_rows", bytemuck::bytes_of(value));
            (rows.iter().map(on_device).collect(), iterations)
        } else {
            (Vec::new(), 0)
        };
        let level = |value: &FilterLevel| Level {
            buffer: uploaded(device, "filter_level", bytemuck::bytes_of(value)),
            value: *value,
        };
        Self {
            size,
            kept_for: settings,
            steps: Arc::new(values.iter().map(level).collect()),
            all,
            rows: Arc::new(rows),
            row_iterations,
        }
    }
}

fn uploaded(device: &Device, label: &str, contents: &[u8]) -> wgpu::Buffer {
    let descriptor = wgpu::util::BufferInitDescriptor {
        label: Some(label),
        contents,
        usage: wgpu::BufferUsages::STORAGE,
    };
    device.device.create_buffer_init(&descriptor)
}

impl Kept for Levels {
    fn next(&self, preparation: &Preparation<'_>) -> Result<Box<dyn Kept>, RenderError> {
        let settings = preparation.scene.render.screen_space;
        if self.size == preparation.size && self.kept_for == settings {
            return Ok(Box::new(Self {
                size: self.size,
                kept_for: settings,
                steps: Arc::clone(&self.steps),
                all: self.all.clone(),
                rows: Arc::clone(&self.rows),
                row_iterations: self.row_iterations,
            }));
        }
        let new = Self::new(preparation.device, preparation.size, settings);
        Ok(Box::new(new))
    }

    fn upload(&self, _device: &Device, _scene: &Scene) {}

    fn bind<'a>(&'a self, bindings: &mut Bindings<'a>) {
        bindings.buffer("filter_levels", &self.all);
    }

    fn settle(&mut self, _submitted: bool) {}
}

/// Cells of all levels together.
pub(super) fn cells(size: [u32; 2]) -> u64 {
    let cells = |[w, h]: &[u32; 2]| u64::from(*w) * u64::from(*h);
    sizes(size).iter().map(cells).sum()
}

/// Sizes of all levels, halved until one side is one cell; at least two.
fn sizes(size: [u32; 2]) -> Vec<[u32; 2]> {
    let shortest = size[0].min(size[1]);
    let halvings = shortest.checked_ilog2().unwrap_or(0).clamp(1, MOST_LEVELS);
    let mut sizes = vec![size];
    for _ in 0..halvings {
        let [w, h] = sizes[sizes.len() - 1];
        sizes.push([w.div_ceil(2), h.div_ceil(2)]);
    }
    sizes
}

/// Each level with the next coarser one.
fn layout(size: [u32; 2], settings: &ScreenSpaceSettings) -> Vec<FilterLevel> {
    let sizes = sizes(size);
    let mut firsts = vec![0];
    for [w, h] in &sizes {
        firsts.push(firsts[firsts.len() - 1] + w * h);
    }
    let last = sizes.len() - 2;
    (0..=last)
        .map(|j| FilterLevel {
            width: sizes[j][0],
            height: sizes[j][1],
            first: firsts[j],
            coarse_width: sizes[j + 1][0],
            coarse_height: sizes[j + 1][1],
            coarse_first: firsts[j + 1],
            pixels: firsts[1],
            last: u32::from(j == last),
            variance: variance(settings, j),
            coarse_variance: variance(settings, j + 1),
            next_variance: variance(settings, j + 2),
            largest_variance: variance(settings, last + 1),
        })
        .collect()
}

/// Variance along an axis of what reaches the picture from level `j`: down by the kernel, back by what reads
/// between cells. A cell of level j is 4^j pixels². Unit: px².
fn variance(settings: &ScreenSpaceSettings, j: usize) -> f32 {
    if j == 0 {
        return 0.0;
    }
    let area = 4.0_f32.powi(j as i32);
    let down = match settings.kernel {
        2 => 0.25,
        4 => 0.77,
        _ => 1.25,
    };
    let halved = (area - 1.0) / 3.0;
    match (settings.filter, settings.fetch) {
        // Back level by level, each with the weights 3/4 and 1/4.
        (ScreenSpaceFilter::Splat | ScreenSpaceFilter::Gather, _) => (down + 0.75) * halved,
        // At once, by a tent or the cubic B-spline.
        (ScreenSpaceFilter::Hierarchical, LevelFetch::LinearBilinear) => down * halved + area / 6.0,
        (ScreenSpaceFilter::Hierarchical, _) => down * halved + area / 3.0,
    }
}

/// Rows in as many parts as keep invocations short, and the iterations of one.
fn rows(height: u32, largest_variance: f32) -> (Vec<GatherRows>, u64) {
    let reach = (DEVIATIONS * largest_variance.sqrt()).ceil().min(WIDEST) as u64;
    let per_row = IMAGES * (2 * reach + 1);
    let count = (MOST_ITERATIONS / per_row).clamp(1, u64::from(height)) as u32;
    let parts = (0..height).step_by(count as usize).map(|first| {
        let end = (first + count).min(height);
        GatherRows {
            first,
            end,
            last: u32::from(end == height),
            padding: 0,
        }
    });
    (parts.collect(), per_row * u64::from(count))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn levels_halve_down_to_one_cell_and_fit_any_size() {
        for (size, count) in [
            ([1, 1], 1),
            ([7, 1], 1),
            ([33, 17], 4),
            ([640, 360], 8),
            ([1920, 1080], 10),
            ([16384, 16384], 12),
        ] {
            let levels = layout(size, &ScreenSpaceSettings::default());
            assert_eq!(levels.len(), count, "{size:?}");
            for pair in levels.windows(2) {
                assert_eq!(pair[0].coarse_first, pair[1].first);
                assert_eq!(
                    (pair[0].last, pair[0].coarse_variance),
                    (0, pair[1].variance)
                );
            }
            let last = levels[count - 1];
            assert_eq!(
                (last.last, last.largest_variance),
                (1, last.coarse_variance)
            );
            let end = last.coarse_first + last.coarse_width * last.coarse_height;
            assert_eq!(u64::from(end), cells(size));
        }
    }

    #[test]
    fn every_row_is_gathered_once_and_no_invocation_is_long() {
        for (height, variance) in [(1, 0.5), (90, 100.0), (720, 130_000.0)] {
            let (parts, iterations) = rows(height, variance);
            assert!(iterations <= 65_000);
            assert_eq!((parts[0].first, parts[parts.len() - 1].end), (0, height));
            for pair in parts.windows(2) {
                assert_eq!((pair[0].end, pair[0].last), (pair[1].first, 0));
            }
        }
    }
}
