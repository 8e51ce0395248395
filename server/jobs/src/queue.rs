//! The contract of queues: what every backend does alike, held by one suite of tests.
//!
//! A task is taken on a lease that ends by itself unless it is renewed. Each lease has the number of its
//! attempt: what an earlier holder still says is refused. A task that fails waits longer each time and
//! becomes a dead letter after some failures; its job has failed then.

use std::time::Duration;

use async_trait::async_trait;
use tokio::sync::watch;

use crate::id::JobId;
use crate::request::JobRequest;
use crate::spec::{TaskKind, TaskSpec};
use crate::state::{JobRecord, JobState, StoredObject, TaskRecord, TaskState};

/// A moment. Unit: ms since 1970.
pub type Millis = u64;

/// A job that is to be accepted.
#[derive(Debug, Clone)]
pub struct NewJob {
    /// Its name.
    pub id: JobId,
    /// What was asked for.
    pub request: JobRequest,
    /// Tells requests apart under one key: hash of what was posted.
    pub request_hash: String,
    /// With a key, the same request is accepted once only.
    pub idempotency_key: Option<String>,
    /// Its tasks in order. The last one may be a video, which waits for all others.
    pub tasks: Vec<TaskSpec>,
}

/// What became of a submission.
#[derive(Debug, Clone, PartialEq)]
pub struct Submitted {
    /// The job.
    pub job: JobRecord,
    /// Whether it is new: not the answer to a repeated request.
    pub is_new: bool,
}

/// The right to work on a task for a while.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub struct Lease {
    /// The task's job.
    pub job: JobId,
    /// The task's place in it.
    pub number: u32,
    /// Fences off earlier holders.
    pub attempt: u32,
}

/// A task and the right to work on it.
#[derive(Debug, Clone, PartialEq)]
pub struct LeasedTask {
    /// The right.
    pub lease: Lease,
    /// The job that it belongs to.
    pub job: JobRecord,
    /// What it makes.
    pub kind: TaskKind,
    /// Name of its result by what it is made from.
    pub spec_hash: String,
}

/// What the holder of a lease is to do.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Order {
    /// Go on.
    GoOn,
    /// Stop: the job was cancelled.
    Stop,
}

/// How a task failed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FailureKind {
    /// Another attempt may succeed.
    Passing,
    /// The device was lost: twice, and the task is a dead letter.
    DeviceLost,
    /// No attempt can succeed.
    ForGood,
}

/// A failure and its reason.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Failure {
    /// How.
    pub kind: FailureKind,
    /// Why, in one sentence.
    pub reason: String,
}

/// Which jobs are listed.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Filter {
    /// Only those in this state.
    pub state: Option<JobState>,
}

/// Which part of a list is asked for, newest first.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct PageAsked {
    /// At most so many.
    pub limit: u32,
    /// Those that follow this one.
    pub after: Option<JobId>,
}

/// A part of a list.
#[derive(Debug, Clone, PartialEq)]
pub struct Page {
    /// Newest first.
    pub jobs: Vec<JobRecord>,
    /// Whether more follow.
    pub more: bool,
}

/// How much a queue holds.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Counts {
    /// Jobs that are not over.
    pub open_jobs: u64,
    /// Jobs in all.
    pub jobs: u64,
    /// Tasks that wait to be taken.
    pub queued_tasks: u64,
    /// Tasks that a worker has.
    pub leased_tasks: u64,
    /// Dead letters.
    pub dead_tasks: u64,
}

/// Why a queue refused.
#[derive(Debug, thiserror::Error)]
pub enum QueueError {
    /// There is no such job.
    #[error("there is no job {0}")]
    NoSuchJob(JobId),
    /// The lease has ended and the task may be another's.
    #[error("the lease on task {number} of job {job} has ended")]
    LeaseLost {
        /// The task's job.
        job: JobId,
        /// The task's place in it.
        number: u32,
    },
    /// The key was used for another request.
    #[error("the idempotency key was used for another request, by job {job}")]
    KeyReused {
        /// The job that has it.
        job: JobId,
    },
    /// There are as many as there may be.
    #[error("the queue is full: {found} {what}, the limit is {limit}")]
    Full {
        /// Of what there are too many.
        what: &'static str,
        /// How many there would be.
        found: u64,
        /// How many there may be.
        limit: u64,
    },
    /// The object belongs to a job that was forgotten meanwhile.
    #[error("the object {key} is not kept any more")]
    ObjectGone {
        /// Its name in the store.
        key: String,
    },
    /// What is stored cannot be read or written.
    #[error("the queue's storage failed: {0}")]
    Storage(String),
}

/// The folder of a job's own objects in the store.
pub fn objects_of(job: &JobId) -> String {
    format!("jobs/{job}/")
}

/// A queue of tasks.
#[async_trait]
pub trait TaskQueue: Send + Sync + 'static {
    /// Accepts a job with all its tasks, or none of it.
    async fn submit(&self, job: NewJob, now: Millis) -> Result<Submitted, QueueError>;

    /// Takes the task that is next: of the highest priority, of the job with the fewest tasks taken, of
    /// the oldest one, the first that may be tried.
    async fn lease(
        &self,
        worker: &str,
        length: Duration,
        now: Millis,
    ) -> Result<Option<LeasedTask>, QueueError>;

    /// Renews a lease.
    async fn heartbeat(
        &self,
        lease: &Lease,
        length: Duration,
        now: Millis,
    ) -> Result<Order, QueueError>;

    /// The task's result is stored: an object of its own, or another job's that is kept. Also ends the lease
    /// of a cancelled job's task, whose object is then what there was of it.
    async fn complete(
        &self,
        lease: &Lease,
        object: StoredObject,
        now: Millis,
    ) -> Result<(), QueueError>;

    /// The task failed; where it stands now.
    async fn fail(
        &self,
        lease: &Lease,
        failure: &Failure,
        now: Millis,
    ) -> Result<TaskState, QueueError>;

    /// The worker goes away: the task is free again at once, and no failure is counted.
    async fn give_back(&self, lease: &Lease, now: Millis) -> Result<(), QueueError>;

    /// Frees what a worker of this name had before it ended without a word, a failure each; how many tasks
    /// that were.
    async fn reclaim(&self, worker: &str, now: Millis) -> Result<u64, QueueError>;

    /// Cancels a job, unless it is over.
    async fn cancel(&self, job: &JobId, now: Millis) -> Result<JobRecord, QueueError>;

    /// A job.
    async fn job(&self, job: &JobId) -> Result<JobRecord, QueueError>;

    /// The tasks of a job in order.
    async fn tasks(&self, job: &JobId) -> Result<Vec<TaskRecord>, QueueError>;

    /// Jobs, newest first.
    async fn list(&self, filter: Filter, page: &PageAsked) -> Result<Page, QueueError>;

    /// The stored result of this name, if any task made it.
    async fn known_object(&self, spec_hash: &str) -> Result<Option<StoredObject>, QueueError>;

    /// Forgets at most `most` jobs that were over before a moment; those jobs, and the objects that no
    /// other job refers to.
    async fn expire(
        &self,
        before: Millis,
        most: u32,
    ) -> Result<(Vec<JobId>, Vec<StoredObject>), QueueError>;

    /// How much it holds.
    async fn counts(&self) -> Result<Counts, QueueError>;

    /// Changes whenever something may have changed.
    fn changes(&self) -> watch::Receiver<u64>;
}
