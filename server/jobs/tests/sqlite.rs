//! The built-in queue: it passes the suite of all queues, and outlives its process.

#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use std::path::Path;
use std::time::Duration;

use tyndall_jobs::{JobState, SqliteLimits, SqliteQueue, TaskQueue, TaskState};

use crate::conformance::{self, Limits, job, of_suite};

fn limits(limits: Limits) -> SqliteLimits {
    SqliteLimits {
        open_jobs: limits.open_jobs,
        failures: limits.failures,
        losses: limits.losses,
        backoff: limits.backoff,
        ..SqliteLimits::default()
    }
}

fn open(path: &Path) -> SqliteQueue {
    SqliteQueue::open(path, limits(Limits::default())).unwrap()
}

#[tokio::test(flavor = "multi_thread")]
async fn it_passes_the_suite_of_all_queues() {
    let folder = tempfile::tempdir().unwrap();
    let mut count = 0;
    conformance::run(|of_suite| {
        count += 1;
        let path = folder.path().join(format!("{count}.sqlite"));
        std::sync::Arc::new(SqliteQueue::open(&path, limits(of_suite)).unwrap())
    })
    .await;
}

#[tokio::test]
async fn what_it_accepted_outlives_it() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("queue.sqlite");
    let (id, lease) = {
        let queue = open(&path);
        let submitted = queue.submit(job(1, 2, 0), 5).await.unwrap();
        let leased = queue
            .lease("one", Duration::from_secs(30), 10)
            .await
            .unwrap();
        (submitted.job.id, leased.unwrap().lease)
        // Dropped without a word, as by `kill -9`.
    };
    let queue = open(&path);
    let known = queue.job(&id).await.unwrap();
    assert_eq!(
        (known.state, known.tasks, known.created),
        (JobState::Running, 2, 5)
    );
    assert_eq!(queue.reclaim("another", 20).await.unwrap(), 0);
    assert_eq!(queue.reclaim("one", 20).await.unwrap(), 1);
    let tasks = queue.tasks(&id).await.unwrap();
    assert_eq!(tasks[0].state, TaskState::Queued);
    let late = queue.complete(&lease, of_suite("late"), 30).await;
    assert!(late.is_err(), "the lease was taken back");
}

#[tokio::test]
async fn a_file_that_is_no_queue_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let text = folder.path().join("text");
    std::fs::write(
        &text,
        "not a database, but long enough to look like one might",
    )
    .unwrap();
    let refused = SqliteQueue::open(&text, SqliteLimits::default());
    assert!(refused.unwrap_err().to_string().contains("not a database"));
    assert!(SqliteQueue::open(folder.path(), SqliteLimits::default()).is_err());
}
