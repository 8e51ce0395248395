//! What a queue tells of jobs and their tasks.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::id::JobId;
use crate::request::JobRequest;
use crate::spec::TaskKind;

/// Where a job stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum JobState {
    /// Nothing of it was begun.
    Queued,
    /// Some of it is being made, or is done.
    Running,
    /// Every result is stored.
    Done,
    /// A task of it cannot be done.
    Failed,
    /// Somebody cancelled it.
    Cancelled,
}

impl JobState {
    /// Every state.
    pub const ALL: [Self; 5] = [
        Self::Queued,
        Self::Running,
        Self::Done,
        Self::Failed,
        Self::Cancelled,
    ];

    /// Its JSON name.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Queued => "queued",
            Self::Running => "running",
            Self::Done => "done",
            Self::Failed => "failed",
            Self::Cancelled => "cancelled",
        }
    }

    /// Whether nothing of it changes any more.
    pub const fn is_over(self) -> bool {
        matches!(self, Self::Done | Self::Failed | Self::Cancelled)
    }
}

/// Where a task stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum TaskState {
    /// It waits for the tasks before it.
    Waiting,
    /// Any worker may take it.
    Queued,
    /// A worker has it.
    Leased,
    /// Its result is stored.
    Done,
    /// It failed too often, or for good: a dead letter.
    Dead,
    /// Its job is over without it.
    Cancelled,
}

impl TaskState {
    /// Every state.
    pub const ALL: [Self; 6] = [
        Self::Waiting,
        Self::Queued,
        Self::Leased,
        Self::Done,
        Self::Dead,
        Self::Cancelled,
    ];

    /// Its JSON name.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Waiting => "waiting",
            Self::Queued => "queued",
            Self::Leased => "leased",
            Self::Done => "done",
            Self::Dead => "dead",
            Self::Cancelled => "cancelled",
        }
    }
}

/// A result that is stored.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct StoredObject {
    /// Its name in the store.
    pub key: String,
    /// Unit: byte.
    pub bytes: u64,
    /// SHA-256 in hexadecimal.
    pub sha256: String,
}

/// A job as its queue knows it.
#[derive(Debug, Clone, PartialEq)]
pub struct JobRecord {
    /// Its name.
    pub id: JobId,
    /// Where it stands.
    pub state: JobState,
    /// What was asked for.
    pub request: JobRequest,
    /// Greater is earlier.
    pub priority: i32,
    /// When it was accepted. Unit: ms since 1970.
    pub created: u64,
    /// When its first task was begun. Unit: ms since 1970.
    pub started: Option<u64>,
    /// When it was over. Unit: ms since 1970.
    pub finished: Option<u64>,
    /// Grows with every change.
    pub revision: u64,
    /// Tasks in all.
    pub tasks: u32,
    /// Tasks whose results are stored.
    pub done: u32,
    /// Why it failed.
    pub error: Option<String>,
}

/// A task as its queue knows it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TaskRecord {
    /// Place in its job, from 0.
    pub number: u32,
    /// What it makes.
    pub kind: TaskKind,
    /// Name of its result by what it is made from.
    pub spec_hash: String,
    /// Where it stands.
    pub state: TaskState,
    /// How often it was taken.
    pub attempts: u32,
    /// Its result; of a cancelled job, what there was of it.
    pub object: Option<StoredObject>,
    /// Why it failed last.
    pub error: Option<String>,
}
