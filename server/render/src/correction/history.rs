//! What is carried over from picture to picture.
//!
//! The last picture's residuals are looked up where the present one sees the same places. They predict
//! the new samples; what of the difference is change and not noise, by the halves, tells how much of them is
//! forgotten (a Kalman filter whose variances are estimated).
//! Bias: follows sudden changes within a few frames where samples are few; fades with the samples at
//! rest. Cost: two passes over the pixels, two over tiles of 16×16.

use std::cell::Cell;

use tyndall_scene::Camera;
use tyndall_shaders::types::{HISTORY_TILE, HistoryView};

use crate::engine::{Bindings, Device};
use crate::gpu_scene::history_view;

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
    /// Width and height. Unit: pixel.
    pub size: [u32; 2],
    /// Whether more than the camera is another since.
    pub changed: bool,
}

/// What is said of the last picture, and which passes that takes.
#[derive(Debug, Clone)]
pub(super) struct History {
    view: wgpu::Buffer,
    size: [u32; 2],
    /// Whether anything carried counts at present.
    counts: Cell<bool>,
    /// Whether more than the camera is another.
    changed: Cell<bool>,
}

impl History {
    pub fn new(device: &Device, size: [u32; 2]) -> Self {
        Self {
            view: device.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("history_view"),
                size: size_of::<HistoryView>() as u64,
                usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            }),
            size,
            counts: Cell::new(false),
            changed: Cell::new(false),
        }
    }

    pub fn bind<'a>(&'a self, bindings: &mut Bindings<'a>) {
        bindings.buffer("history_view", &self.view);
    }

    /// Sets the picture that is looked back to, if any. What it said fades as `samples` come, so that a
    /// picture at rest is free of what carrying did to it.
    pub fn look_back(
        &self,
        device: &Device,
        last: Option<&Seen>,
        camera: &Camera,
        (samples, base_samples): (u32, u32),
    ) {
        let most = MOST_CARRIED - samples as f32;
        let last = last.filter(|_| most > 0.0);
        self.counts.set(last.is_some());
        self.changed.set(last.is_some_and(|last| last.changed));
        let mut value = HistoryView::default();
        if let Some(last) = last {
            value = history_view(&last.camera, camera, last.size);
            // Of a smaller picture one sample stands for several pixels, and counts once in all of them.
            let pixels = |[width, height]: [u32; 2]| width as f32 * height as f32;
            value.count_scale = (pixels(last.size) / pixels(self.size)).min(1.0);
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

    /// The passes before the residual's, and those after it: variant and size of each. `looks` where the
    /// picture is a new one; `grids` where media are density grids.
    pub fn passes(&self, looks: bool, grids: bool) -> [Vec<(&'static str, [u32; 2])>; 2] {
        let cells = self.size.map(|side| side.div_ceil(2));
        let (mut before, mut after) = (Vec::new(), Vec::new());
        if looks {
            before.push((carried(grids), self.size));
        }
        // From another place the same is seen: nothing to compare.
        if self.changed.get() {
            before.push(("correction+base_scale", cells));
            after.push(("correction+changes", cells));
            after.push(("correction+forgetting", tiles(self.size)));
        }
        if self.counts.get() {
            after.push(("correction+join", self.size));
        }
        before.push(("correction+steady_base", self.size));
        [before, after]
    }
}

/// Permutations of all these passes.
pub(super) fn programs(grids: bool) -> [&'static str; 6] {
    [
        carried(grids),
        "correction+base_scale",
        "correction+changes",
        "correction+forgetting",
        "correction+join",
        "correction+steady_base",
    ]
}

fn carried(grids: bool) -> &'static str {
    if grids {
        "correction+carried+grids"
    } else {
        "correction+carried"
    }
}

fn tiles(size: [u32; 2]) -> [u32; 2] {
    size.map(|side| side.div_ceil(HISTORY_TILE))
}
