//! The interactive picture B, brought toward the traced one X̄.
//!
//! The residual d = X̄ − B of a few unbiased samples is noisy, the bias behind it is smooth. d is split
//! into bands; each is weighted by how much of it is signal and added to B. Two halves of the samples,
//! even and odd, tell signal from noise without a model of either: the mean of their product over a
//! window is the signal's energy, that of their squared difference the noise's, and the weight is
//! signal/(signal + noise), after James and Stein (1961). It tends to 1 with the samples, so that the
//! picture tends to X̄, and to 0 in noise, so that it stays B. Both also give its expected square error.
//!
//! `algorithms.md` §10, with two changes that measured better or alike on the reference scenes: the
//! noise comes from the halves and not from the variance of samples, and the coarse levels are kept
//! only at the cells of a grid as coarse as they are smooth.
//! Bias: vanishes with the noise of X̄. Cost: about 60 loads of a vector a pixel.

use tyndall_scene::Camera;
use tyndall_shaders::types::{HistoryView, PyramidLevel};
use wgpu::util::DeviceExt as _;

use crate::device::Device;
use crate::engine::Recording;
use crate::error::RenderError;
use crate::gpu_scene::history_view;
use crate::programs::Bindings;

/// Levels of residuals at most; coarser bands hold little else than the mean.
const MOST_LEVELS: u32 = 6;
/// The coarsest level keeps at least about so many cells along each side.
const FEWEST_CELLS: u32 = 4;

/// Samples of a half that what is carried over counts as at most: reprojection blurs, and errors of the
/// places it assumes grow.
const MOST_CARRIED: f32 = 32.0;

/// By so much the error of a corrected picture may exceed the expected one: a target is met when the
/// expected error times this is below it. Found on the reference scenes, docs/calibration.svg: from four
/// samples on at most 1.47 (fog box, black picture).
pub(crate) const SAFETY: f32 = 1.5;

/// Buffers of one view at one size.
#[derive(Debug)]
pub(crate) struct Correction {
    /// One a level of residuals, the finest first.
    levels: Vec<Level>,
    residuals: wgpu::Buffer,
    band_energies: wgpu::Buffer,
    window_energies: wgpu::Buffer,
    believed_energies: wgpu::Buffer,
    corrections: wgpu::Buffer,
    /// Expected square error of each pixel, mean of the channels: f32.
    pub square_errors: wgpu::Buffer,
    /// The technique's running mean, four f32 a pixel.
    pub base_film: wgpu::Buffer,
    /// Present where residuals are carried from picture to picture.
    history: Option<History>,
}

/// The last picture's residuals.
#[derive(Debug)]
struct History {
    view: wgpu::Buffer,
    residuals: wgpu::Buffer,
    /// f32 a pixel. Unit: m.
    depths: wgpu::Buffer,
    /// Of the picture at present.
    own_depths: wgpu::Buffer,
    pixels: u64,
}

#[derive(Debug)]
struct Level {
    value: PyramidLevel,
    buffer: wgpu::Buffer,
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

/// Bytes of the largest buffer that a picture of this size needs.
pub(crate) fn largest_buffer(width: u32, height: u32) -> u64 {
    let cells = |[w, h]: &[u32; 2]| u64::from(*w) * u64::from(*h);
    32 * sizes(width, height).iter().map(cells).sum::<u64>()
}

impl Correction {
    pub fn new(device: &Device, width: u32, height: u32, carries: bool) -> Self {
        let (levels, cells) = layout(width, height);
        let pixels = u64::from(width) * u64::from(height);
        let buffer = |label: &str, size: u64| {
            device.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(label),
                size,
                usage: wgpu::BufferUsages::STORAGE
                    | wgpu::BufferUsages::COPY_SRC
                    | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            })
        };
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
        Self {
            levels: levels.into_iter().map(uploaded).collect(),
            residuals: buffer("residuals", 32 * cells),
            band_energies: buffer("band_energies", 16 * cells),
            window_energies: buffer("window_energies", 16 * cells),
            believed_energies: buffer("believed_energies", 16 * cells),
            corrections: buffer("corrections", 16 * cells),
            square_errors: buffer("square_errors", (4 * pixels).next_multiple_of(16)),
            base_film: buffer("base_film", 16 * pixels),
            history: carries.then(|| History {
                view: buffer("history_view", size_of::<HistoryView>() as u64),
                residuals: buffer("history", 32 * pixels),
                depths: buffer("history_depths", (4 * pixels).next_multiple_of(16)),
                own_depths: buffer("residual_depths", (4 * pixels).next_multiple_of(16)),
                pixels,
            }),
        }
    }

    /// Adds what the passes after the correction read.
    pub fn bind<'a>(&'a self, bindings: &mut Bindings<'a>) {
        bindings
            .buffer("residuals", &self.residuals)
            .buffer("band_energies", &self.band_energies)
            .buffer("window_energies", &self.window_energies)
            .buffer("believed_energies", &self.believed_energies)
            .buffer("corrections", &self.corrections)
            .buffer("square_errors", &self.square_errors)
            .buffer("base_film", &self.base_film);
        if let Some(history) = &self.history {
            bindings
                .buffer("history_view", &history.view)
                .buffer("history", &history.residuals)
                .buffer("history_depths", &history.depths)
                .buffer("residual_depths", &history.own_depths);
        }
    }

    /// Sets the camera that what is carried over was seen from, if anything is. It fades as `samples` come,
    /// so that a picture at rest is free of what carrying did to it.
    pub fn look_back(&self, device: &Device, last: Option<&Camera>, camera: &Camera, samples: u32) {
        if let (Some(history), Some(finest)) = (&self.history, self.levels.first()) {
            let size = (finest.value.width, finest.value.height);
            let most = MOST_CARRIED - samples as f32;
            let last = last.filter(|_| most > 0.0);
            let value = history_view(last, camera, size, most);
            let bytes = bytemuck::bytes_of(&value);
            device.queue.write_buffer(&history.view, 0, bytes);
        }
    }

    /// Records that the residuals become the last picture's.
    pub fn carry(&self, encoder: &mut wgpu::CommandEncoder) {
        if let Some(history) = &self.history {
            let residuals = Some(32 * history.pixels);
            encoder.copy_buffer_to_buffer(&self.residuals, 0, &history.residuals, 0, residuals);
            let (own, kept) = (&history.own_depths, &history.depths);
            encoder.copy_buffer_to_buffer(own, 0, kept, 0, None);
        }
    }

    /// Records the correction; `bind` adds the view's resources.
    pub fn record<'a>(
        &'a self,
        recording: &mut Recording<'_>,
        variant: &str,
        bind: &dyn Fn(&mut Bindings<'a>),
    ) -> Result<(), RenderError> {
        let base = if variant.contains("+base") {
            "+base"
        } else {
            ""
        };
        let residual = variant.replacen("correction", "correction+residual", 1);
        let own = |level: &Level| [level.value.width, level.value.height];
        let coarse = |level: &Level| [level.value.coarse_width, level.value.coarse_height];
        let window = |level: &Level| [level.value.window_width, level.value.window_height];
        let mut links = Vec::new();
        let mut link = |name: &str, level: &'a Level, size: [u32; 2]| {
            let mut bindings = Bindings::default();
            bindings.buffer("level", &level.buffer);
            bind(&mut bindings);
            links.push((name.to_owned(), bindings, size));
        };
        let finest = &self.levels[0];
        link(&residual, finest, own(finest));
        for level in &self.levels[..self.levels.len() - 1] {
            link("correction+reduce", level, coarse(level));
        }
        for level in &self.levels {
            link("correction+band_energy", level, coarse(level));
        }
        for level in &self.levels {
            link("correction+window_energy", level, window(level));
        }
        for level in &self.levels {
            link("correction+believed_energy", level, window(level));
        }
        for level in self.levels[1..].iter().rev() {
            link("correction+combine", level, own(level));
        }
        link(
            &format!("correction+combine+finest{base}"),
            finest,
            own(finest),
        );
        recording.compute_chain("correction", &links)
    }
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
