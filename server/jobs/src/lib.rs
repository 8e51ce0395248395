//! Render jobs: what they ask for, their queue, their results. No GPU, no HTTP.
//!
//! In the order of a job's way:
//!
//! - [`request`]: what is posted; [`upload`]: the files that came with it;
//! - [`spec`]: what is rendered, a task a frame, and the names that results get from it;
//! - [`queue`]: the contract of queues; [`sqlite`]: the one that is built in; [`state`]: what they tell;
//! - [`results`]: finished pictures, written once and never changed.
//!
//! A queue is never the truth about results: a task counts as done only when its object is stored. Time
//! comes from outside, so tests need not wait.

pub mod id;
pub mod queue;
pub mod request;
pub mod results;
pub mod spec;
pub mod sqlite;
pub mod state;
pub mod upload;

pub use id::JobId;
pub use queue::{
    Counts, Failure, FailureKind, Filter, Lease, LeasedTask, Millis, NewJob, Order, Page,
    PageAsked, QueueError, Submitted, TaskQueue,
};
pub use request::{Frames, JobRequest, RenderOverrides};
pub use results::{Results, ResultsError};
pub use spec::{Spec, SpecError, TaskKind, TaskSpec};
pub use sqlite::{SqliteLimits, SqliteQueue};
pub use state::{JobRecord, JobState, StoredObject, TaskRecord, TaskState};
