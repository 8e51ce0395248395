//! Renders participating media with wgpu: scene in, pictures out. No network.
//!
//! Read in the order of a frame: [`Device`] opens an adapter and tests it; `gpu_scene` uploads what a
//! [`Scene`](tyndall_scene::Scene) holds; [`plan()`] decides which passes run and says why; `frame`
//! records them in that order, `techniques` holding the transport; `engine` alone submits; `image`
//! owns the running mean; `readback` brings pictures home without blocking. [`Renderer`] ties them
//! together for one device and any number of [`View`]s.

mod correction;
mod device;
mod engine;
mod error;
mod frame;
mod gpu_scene;
mod image;
mod pixel_offsets;
mod plan;
#[cfg(feature = "probe")]
pub mod probe;
mod programs;
mod readback;
mod renderer;
mod self_test;
mod slices;
mod still;
mod supported;
mod targets;
mod techniques;
mod timing;
mod tonemap;
mod view;

pub use device::{AdapterKind, AdapterSummary, Device, DeviceOptions};
pub use error::{DeviceError, RenderError};
pub use plan::{FramePlan, PassKind, PlanLimits, PlannedPass, SkippedPass, plan};
pub use readback::{FailedFrame, FinishedFrame, FrameStats};
pub use renderer::{Prepared, RenderOutcome, Renderer};
pub use self_test::SelfTest;
pub use still::{Still, StillProgress};
pub use supported::{NotRenderedYet, approximations, check_supported};
pub use timing::PassTime;
pub use view::View;
