//! The device and what runs on it: pipelines, resources, recording, times, readback.
//!
//! Knows nothing of scenes and techniques. Files lower in this list use those above: `device`;
//! `adapter` (choosing one); `bindings`, `constants`, `permutation` (what a shader is given);
//! `pipelines`; `bands` (cutting long
//! dispatches); `resources` and `pool` (textures and buffers that passes declare); `timing`;
//! `recording`, which alone submits; `readback`; `self_test`; `open`.

mod adapter;
mod bands;
mod bindings;
mod constants;
mod device;
mod memory;
mod open;
mod permutation;
mod pipelines;
mod pool;
mod raster;
mod readback;
mod recording;
mod resources;
mod self_test;
mod timing;

pub use adapter::{AdapterKind, AdapterSummary, DeviceOptions};
pub(crate) use bands::{most_frame_iterations, most_iterations};
pub(crate) use bindings::Bindings;
pub(crate) use constants::Constants;
pub use device::{Device, SelfTest};
pub(crate) use permutation::Permutation;
pub(crate) use pipelines::{Pipelines, find};
pub use pool::MemoryBudget;
pub(crate) use pool::{Pool, ViewResources, check_size};
pub(crate) use raster::{
    ColorTarget, DepthTarget, DrawCall, RasterDraw, RasterPass, RasterState, cleared, kept,
};
pub use readback::{FinishedFrame, FrameStats};
pub(crate) use readback::{FrameMeta, ReadbackRing, read_now, statistics_scale, wait};
pub(crate) use recording::{Link, Recorded, Recording, SHORT, Size};
pub(crate) use resources::{Access, AccessKind, Bytes, Extent, Life, ResourceSpec};
pub use timing::PassTime;
pub(crate) use timing::{FrameTiming, Timing};
