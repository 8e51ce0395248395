//! What a frame is made of: planned passes, what they read and write, and how they are recorded.
//!
//! A stage or a technique plans a pass by naming its shader, what it reads and writes and what it
//! keeps from frame to frame ([`PlannedPass`]); it records it by a [`Pass`], most often a plain
//! [`Dispatch`]. This folder knows none of them by name.

mod dispatch;
mod input;
mod kept;
mod parts;
mod pass;
mod plan;
mod record;

pub(crate) use dispatch::{Dispatch, MadeBefore, Reach};
pub(crate) use input::PlanInput;
pub use input::PlanLimits;
pub(crate) use kept::{Filled, Kept, KeptKind, KeptStates, Preparation};
pub(crate) use parts::Parts;
pub(crate) use pass::{NewPass, Pass, PipelineList, Programs, Traces};
pub use pass::{PassId, PlannedPass};
pub use plan::{FramePlan, SkippedPass};
pub(crate) use record::record;
