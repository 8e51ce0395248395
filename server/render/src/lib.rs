//! Renders participating media with wgpu: scene in, pictures out. No network.
//!
//! Read in the order of a frame: [`Device`] opens an adapter and tests it; `gpu_scene` uploads what a
//! [`Scene`](tyndall_scene::Scene) holds; [`plan()`] asks a technique (`techniques`) which passes run
//! and says why; `frame` records them in that order, each by the stage or technique that planned it;
//! `engine` alone makes resources and submits; `picture` says what the next frame adds; `correction`
//! brings the technique's picture toward the traced one. [`Renderer`] ties them together for one
//! device and any number of [`View`]s. [`Guide`] answers on the CPU where a camera may go.

mod correction;
mod engine;
mod error;
mod frame;
mod gpu_scene;
mod navigation;
mod picture;
mod plan;
mod prepare;
#[cfg(feature = "probe")]
pub mod probe;
mod renderer;
mod stages;
mod still;
mod supported;
mod techniques;
mod view;

pub use engine::{
    AdapterKind, AdapterSummary, Device, DeviceOptions, FinishedFrame, FrameStats, MemoryBudget,
    PassTime, SelfTest,
};
pub use error::{DeviceError, FailedFrame, NotRenderedYet, RenderError};
pub use frame::{FramePlan, PassId, PlanLimits, PlannedPass, SkippedPass};
pub use navigation::{Darkness, Guide, NavigationFacts, Picked, Stand};
pub use plan::plan;
pub use prepare::Prepared;
pub use renderer::{RenderOutcome, Renderer};
pub use still::{Still, StillProgress, StillRun, StillStep};
pub use supported::check_supported;
pub use techniques::{Claim, Paths, Rung, chosen, claim, ladder};
pub use view::View;
