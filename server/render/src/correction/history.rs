//! What is carried over from picture to picture.
//!
//! The last picture's residuals are looked up where the present one sees the same places. They predict
//! the new samples; what of the difference is change and not noise, by the halves, tells how much of them is
//! forgotten (a Kalman filter whose variances are estimated).
//! Bias: follows sudden changes within a few frames where samples are few; fades with the samples at
//! rest. Cost: two passes over the pixels, two over tiles of 16×16.

use tyndall_scene::Camera;
use tyndall_shaders::types::{HISTORY_TILE, HistoryView, TileChange};

use crate::device::Device;
use crate::gpu_scene::history_view;
use crate::programs::Bindings;

/// Part of the distance by which two may differ and still be of one place.
const SAME_PLACE: f32 = 0.1;
/// Standard deviations of the technique's picture about a pixel that what was carried of it may lie off. A
/// camera at rest sees the same places, wherever in a pixel an edge is looked for: from a row that this
/// time saw another surface the rows beside it differ by 1.4.
const SPREAD: f32 = 1.0;
const SPREAD_AT_REST: f32 = 1.5;
/// Samples of a half that what is carried over counts as at most: reprojection blurs, and errors of the
/// places it assumes grow.
const MOST_CARRIED: f32 = 32.0;
/// The same of the technique's own samples: beyond, another finds little that these did not.
const MOST_CARRIED_BASE: f32 = 16.0;

/// The picture that residuals were found in.
#[derive(Debug, Clone)]
pub(crate) struct Seen {
    /// Its camera.
    pub camera: Camera,
    /// Whether more than the camera is another since.
    pub changed: bool,
}

/// The last picture's residuals, and what the present one makes of them.
#[derive(Debug)]
pub(super) struct History {
    view: wgpu::Buffer,
    residuals: wgpu::Buffer,
    /// Distance and number of the technique's samples, two f32 a pixel. Unit: m.
    places: wgpu::Buffer,
    base: wgpu::Buffer,
    /// Of the picture at present.
    own_places: wgpu::Buffer,
    carried: wgpu::Buffer,
    carried_base: wgpu::Buffer,
    base_scales: wgpu::Buffer,
    tile_changes: wgpu::Buffer,
    forgetting: wgpu::Buffer,
    size: [u32; 2],
    /// Whether anything carried counts at present.
    counts: bool,
    /// Whether more than the camera is another.
    changed: bool,
}

impl History {
    pub fn new(size: [u32; 2], buffer: &dyn Fn(&str, u64) -> wgpu::Buffer) -> Self {
        let pixels = u64::from(size[0]) * u64::from(size[1]);
        let [columns, rows] = tiles(size);
        let tiles = u64::from(columns) * u64::from(rows);
        Self {
            view: buffer("history_view", size_of::<HistoryView>() as u64),
            residuals: buffer("history", 32 * pixels),
            places: buffer("history_places", (8 * pixels).next_multiple_of(16)),
            base: buffer("history_base", 16 * pixels),
            own_places: buffer("residual_places", (8 * pixels).next_multiple_of(16)),
            carried: buffer("carried", 32 * pixels),
            carried_base: buffer("carried_base", 16 * pixels),
            base_scales: buffer("base_scales", 16 * tiles),
            tile_changes: buffer("tile_changes", size_of::<TileChange>() as u64 * tiles),
            forgetting: buffer("forgetting", (4 * tiles).next_multiple_of(16)),
            size,
            counts: false,
            changed: false,
        }
    }

    pub fn bind<'a>(&'a self, bindings: &mut Bindings<'a>) {
        bindings
            .buffer("history_view", &self.view)
            .buffer("history", &self.residuals)
            .buffer("history_places", &self.places)
            .buffer("history_base", &self.base)
            .buffer("residual_places", &self.own_places)
            .buffer("carried", &self.carried)
            .buffer("carried_base", &self.carried_base)
            .buffer("base_scales", &self.base_scales)
            .buffer("tile_changes", &self.tile_changes)
            .buffer("forgetting", &self.forgetting);
    }

    /// Sets the picture that is looked back to, if any. What it said fades as `samples` come, so that a
    /// picture at rest is free of what carrying did to it.
    pub fn look_back(
        &mut self,
        device: &Device,
        last: Option<&Seen>,
        camera: &Camera,
        (samples, base_samples): (u32, u32),
    ) {
        let most = MOST_CARRIED - samples as f32;
        let last = last.filter(|_| most > 0.0);
        self.counts = last.is_some();
        self.changed = last.is_some_and(|last| last.changed);
        let mut value = HistoryView::default();
        if let Some(last) = last {
            value = history_view(&last.camera, camera, self.size);
            value.most = most;
            value.most_base = (MOST_CARRIED_BASE - base_samples as f32).max(0.0);
            value.changed = last.changed.into();
            let rests = last.camera == *camera;
            value.same_place = if rests { 1e6 } else { SAME_PLACE };
            value.spread = if rests { SPREAD_AT_REST } else { SPREAD };
        }
        value.base_samples = base_samples as f32;
        let bytes = bytemuck::bytes_of(&value);
        device.queue.write_buffer(&self.view, 0, bytes);
    }

    /// Records that `residuals` of the picture `base` become the last one's.
    pub fn carry(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        residuals: &wgpu::Buffer,
        base: &wgpu::Buffer,
    ) {
        let size = self.residuals.size();
        encoder.copy_buffer_to_buffer(residuals, 0, &self.residuals, 0, size);
        encoder.copy_buffer_to_buffer(base, 0, &self.base, 0, None);
        encoder.copy_buffer_to_buffer(&self.own_places, 0, &self.places, 0, None);
    }

    /// The passes before the residual's, and those after it: variant and size of each. `looks` where the
    /// picture is a new one; `grids` where media are density grids.
    pub fn passes(&self, looks: bool, grids: bool) -> [Vec<(&'static str, [u32; 2])>; 2] {
        let cells = self.size.map(|side| side.div_ceil(2));
        let (mut before, mut after) = (Vec::new(), Vec::new());
        if looks && grids {
            before.push(("correction+carried+grids", self.size));
        } else if looks {
            before.push(("correction+carried", self.size));
        }
        // From another place the same is seen: nothing to compare.
        if self.changed {
            before.push(("correction+base_scale", cells));
            after.push(("correction+changes", cells));
            after.push(("correction+forgetting", tiles(self.size)));
        }
        if self.counts {
            after.push(("correction+join", self.size));
        }
        before.push(("correction+steady_base", self.size));
        [before, after]
    }
}

fn tiles(size: [u32; 2]) -> [u32; 2] {
    size.map(|side| side.div_ceil(HISTORY_TILE))
}
