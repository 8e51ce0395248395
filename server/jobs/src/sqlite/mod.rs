//! The built-in queue: one `SQLite` file, which survives whatever ends the process.
//!
//! - `schema`: its tables;
//! - `submit`: accepting a job; `lease`: taking its tasks, and what becomes of them;
//! - `read`: what is told of them; `expire`: forgetting those that are over.
//!
//! Every change is a transaction that is on the disk when the call returns. Calls run on threads that may
//! block, one at a time.

mod expire;
mod lease;
mod read;
mod schema;
mod submit;

use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use async_trait::async_trait;
use rusqlite::{Connection, Transaction, TransactionBehavior};
use tokio::sync::watch;

use crate::id::JobId;
use crate::queue::{
    Counts, Failure, Filter, Lease, LeasedTask, Millis, NewJob, Order, Page, PageAsked, QueueError,
    Submitted, TaskQueue,
};
use crate::state::{JobRecord, StoredObject, TaskRecord, TaskState};

/// How long another process may hold the file.
const BUSY_FOR: Duration = Duration::from_secs(5);

/// How much the queue may hold, and how often a task is tried.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SqliteLimits {
    /// Jobs that are not over.
    pub open_jobs: u64,
    /// Tasks of those.
    pub open_tasks: u64,
    /// Failures that make a task a dead letter.
    pub failures: u32,
    /// Lost devices that make a task a dead letter.
    pub losses: u32,
    /// Pause after the first failure, doubled after each further one.
    pub backoff: Duration,
    /// Longest pause.
    pub longest_backoff: Duration,
}

impl Default for SqliteLimits {
    fn default() -> Self {
        Self {
            open_jobs: 10_000,
            open_tasks: 100_000,
            failures: 5,
            losses: 2,
            backoff: Duration::from_secs(1),
            longest_backoff: Duration::from_mins(1),
        }
    }
}

/// A queue in one `SQLite` file.
#[derive(Debug)]
pub struct SqliteQueue {
    connection: Arc<Mutex<Connection>>,
    changes: watch::Sender<u64>,
    limits: SqliteLimits,
}

impl SqliteQueue {
    /// Opens the file, or makes it.
    ///
    /// # Errors
    /// [`QueueError::Storage`] where it is no queue of this version or cannot be written.
    pub fn open(path: &Path, limits: SqliteLimits) -> Result<Self, QueueError> {
        let connection = Connection::open(path).map_err(|error| storage(&error))?;
        connection
            .busy_timeout(BUSY_FOR)
            .map_err(|error| storage(&error))?;
        schema::prepare(&connection)?;
        Ok(Self {
            connection: Arc::new(Mutex::new(connection)),
            changes: watch::Sender::new(0),
            limits,
        })
    }

    /// Reads or changes in one transaction, on a thread that may block.
    async fn run<T: Send + 'static>(
        &self,
        work: impl FnOnce(&Transaction<'_>) -> Result<T, QueueError> + Send + 'static,
    ) -> Result<T, QueueError> {
        let connection = Arc::clone(&self.connection);
        let done = tokio::task::spawn_blocking(move || {
            let mut connection = connection.lock().unwrap_or_else(PoisonError::into_inner);
            let transaction = connection
                .transaction_with_behavior(TransactionBehavior::Immediate)
                .map_err(|error| storage(&error))?;
            let value = work(&transaction)?;
            transaction.commit().map_err(|error| storage(&error))?;
            Ok(value)
        });
        let broken = |error: tokio::task::JoinError| QueueError::Storage(error.to_string());
        done.await.map_err(broken)?
    }

    /// [`Self::run`], and tells those who wait that something changed.
    async fn change<T: Send + 'static>(
        &self,
        work: impl FnOnce(&Transaction<'_>) -> Result<T, QueueError> + Send + 'static,
    ) -> Result<T, QueueError> {
        let value = self.run(work).await?;
        self.changes
            .send_modify(|count| *count = count.wrapping_add(1));
        Ok(value)
    }
}

/// An error of `SQLite` in our words.
fn storage(error: &rusqlite::Error) -> QueueError {
    QueueError::Storage(error.to_string())
}

/// Shortens the handling of `SQLite`'s errors.
trait Stored<T> {
    fn stored(self) -> Result<T, QueueError>;
}

impl<T> Stored<T> for rusqlite::Result<T> {
    fn stored(self) -> Result<T, QueueError> {
        self.map_err(|error| storage(&error))
    }
}

#[async_trait]
impl TaskQueue for SqliteQueue {
    async fn submit(&self, job: NewJob, now: Millis) -> Result<Submitted, QueueError> {
        let limits = self.limits;
        self.change(move |db| submit::submit(db, &job, now, &limits))
            .await
    }

    async fn lease(
        &self,
        worker: &str,
        length: Duration,
        now: Millis,
    ) -> Result<Option<LeasedTask>, QueueError> {
        let (worker, limits) = (worker.to_owned(), self.limits);
        let (leased, changed) = self
            .run(move |db| {
                let ended = lease::end_late(db, now, &limits)?;
                let leased = lease::take(db, &worker, length, now)?;
                let changed = ended > 0 || leased.is_some();
                Ok((leased, changed))
            })
            .await?;
        if changed {
            self.changes
                .send_modify(|count| *count = count.wrapping_add(1));
        }
        Ok(leased)
    }

    async fn heartbeat(
        &self,
        lease: &Lease,
        length: Duration,
        now: Millis,
    ) -> Result<Order, QueueError> {
        let lease = lease.clone();
        self.run(move |db| lease::renew(db, &lease, length, now))
            .await
    }

    async fn complete(
        &self,
        lease: &Lease,
        object: StoredObject,
        now: Millis,
    ) -> Result<(), QueueError> {
        let lease = lease.clone();
        self.change(move |db| lease::complete(db, &lease, &object, now))
            .await
    }

    async fn fail(
        &self,
        lease: &Lease,
        failure: &Failure,
        now: Millis,
    ) -> Result<TaskState, QueueError> {
        let (lease, failure, limits) = (lease.clone(), failure.clone(), self.limits);
        self.change(move |db| lease::fail(db, &lease, &failure, now, &limits))
            .await
    }

    async fn give_back(&self, lease: &Lease, now: Millis) -> Result<(), QueueError> {
        let lease = lease.clone();
        self.change(move |db| lease::give_back(db, &lease, now))
            .await
    }

    async fn reclaim(&self, worker: &str, now: Millis) -> Result<u64, QueueError> {
        let (worker, limits) = (worker.to_owned(), self.limits);
        self.change(move |db| lease::reclaim(db, &worker, now, &limits))
            .await
    }

    async fn cancel(&self, job: &JobId, now: Millis) -> Result<JobRecord, QueueError> {
        let job = job.clone();
        self.change(move |db| lease::cancel(db, &job, now)).await
    }

    async fn job(&self, job: &JobId) -> Result<JobRecord, QueueError> {
        let job = job.clone();
        self.run(move |db| read::job(db, &job)).await
    }

    async fn tasks(&self, job: &JobId) -> Result<Vec<TaskRecord>, QueueError> {
        let job = job.clone();
        self.run(move |db| read::tasks(db, &job)).await
    }

    async fn list(&self, filter: Filter, page: &PageAsked) -> Result<Page, QueueError> {
        let page = page.clone();
        self.run(move |db| read::list(db, filter, &page)).await
    }

    async fn known_object(&self, spec_hash: &str) -> Result<Option<StoredObject>, QueueError> {
        let spec_hash = spec_hash.to_owned();
        self.run(move |db| read::known_object(db, &spec_hash)).await
    }

    async fn expire(
        &self,
        before: Millis,
        most: u32,
    ) -> Result<(Vec<JobId>, Vec<StoredObject>), QueueError> {
        self.change(move |db| expire::expire(db, before, most))
            .await
    }

    async fn counts(&self) -> Result<Counts, QueueError> {
        self.run(read::counts).await
    }

    fn changes(&self) -> watch::Receiver<u64> {
        self.changes.subscribe()
    }
}
