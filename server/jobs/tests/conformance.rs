//! What every queue does alike. Time comes from the tests, so nothing waits.

#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use std::collections::BTreeSet;
use std::sync::Arc;
use std::time::Duration;

use tyndall_jobs::{
    Failure, FailureKind, Filter, JobId, JobRequest, JobState, Lease, LeasedTask, NewJob, Order,
    PageAsked, QueueError, StoredObject, TaskKind, TaskQueue, TaskSpec, TaskState,
};

const LENGTH: Duration = Duration::from_secs(30);

/// What the suite asks a queue to allow.
#[derive(Debug, Clone, Copy)]
pub struct Limits {
    pub open_jobs: u64,
    pub failures: u32,
    pub losses: u32,
    pub backoff: Duration,
}

impl Default for Limits {
    fn default() -> Self {
        Self {
            open_jobs: 10_000,
            failures: 3,
            losses: 2,
            backoff: Duration::from_secs(1),
        }
    }
}

type Queue = Arc<dyn TaskQueue>;

/// Runs the whole suite, each part on a new queue of the backend.
pub async fn run<Q: TaskQueue>(mut new: impl FnMut(Limits) -> Arc<Q>) {
    let mut queue = || -> Queue { new(Limits::default()) };
    tasks_are_taken_by_priority_then_fairly_then_in_order(queue()).await;
    a_task_is_anothers_only_after_its_lease_has_ended(queue()).await;
    failures_wait_longer_each_time_and_end_in_a_dead_letter(queue()).await;
    two_lost_devices_and_hopeless_tasks_are_dead_letters(queue()).await;
    what_is_given_back_or_reclaimed_is_free_at_once(queue()).await;
    a_cancelled_job_stops_and_keeps_what_it_has(queue()).await;
    a_key_accepts_one_request_once(queue()).await;
    lists_have_pages_and_filters(queue()).await;
    a_video_waits_for_its_frames(queue()).await;
    results_are_known_until_no_job_has_them(queue()).await;
    those_who_wait_hear_of_changes(queue()).await;
    many_clients_and_workers_do_every_task_once(queue()).await;
    let few = Limits {
        open_jobs: 2,
        ..Limits::default()
    };
    a_full_queue_says_so(new(few)).await;
}

/// A job of so many frames.
pub fn job(number: u64, frames: u32, priority: i32) -> NewJob {
    let request = JobRequest {
        preset: Some("cloud".to_owned()),
        priority,
        name: Some(format!("job {number}")),
        ..JobRequest::default()
    };
    let task = |frame| TaskSpec {
        kind: TaskKind::Frame,
        spec_hash: format!("{number}-{frame}"),
    };
    NewJob {
        id: JobId::new(number).unwrap(),
        request,
        request_hash: number.to_string(),
        idempotency_key: None,
        tasks: (0..frames).map(task).collect(),
    }
}

/// An object that the suite stored.
pub fn of_suite(key: &str) -> StoredObject {
    StoredObject {
        key: key.to_owned(),
        bytes: 3,
        sha256: "ab".repeat(32),
    }
}

fn own(lease: &Lease) -> StoredObject {
    of_suite(&format!("jobs/{}/{}.png", lease.job, lease.number))
}

async fn submit(queue: &Queue, job: NewJob) -> JobId {
    let submitted = queue.submit(job, 1).await.unwrap();
    assert!(submitted.is_new);
    submitted.job.id
}

async fn take(queue: &Queue, now: u64) -> LeasedTask {
    let leased = queue.lease("worker", LENGTH, now).await.unwrap();
    leased.expect("a task is free")
}

async fn is_idle(queue: &Queue, now: u64) -> bool {
    queue.lease("worker", LENGTH, now).await.unwrap().is_none()
}

fn passing() -> Failure {
    Failure {
        kind: FailureKind::Passing,
        reason: "the test says so".to_owned(),
    }
}

async fn tasks_are_taken_by_priority_then_fairly_then_in_order(queue: Queue) {
    assert!(is_idle(&queue, 0).await);
    let low = submit(&queue, job(1, 2, 0)).await;
    let second = submit(&queue, job(2, 1, 0)).await;
    let high = submit(&queue, job(3, 1, 5)).await;
    let mut taken = Vec::new();
    for now in 1..=4 {
        let leased = take(&queue, now).await;
        taken.push((leased.lease.job.clone(), leased.lease.number));
        assert_eq!(leased.job.state, JobState::Running);
        assert_eq!(
            leased.spec_hash.split('-').nth(1),
            Some(&*leased.lease.number.to_string())
        );
    }
    let expected = [(high, 0), (low.clone(), 0), (second, 0), (low, 1)];
    assert_eq!(taken, expected);
    assert!(is_idle(&queue, 5).await);
    let counts = queue.counts().await.unwrap();
    assert_eq!(
        (counts.open_jobs, counts.queued_tasks, counts.leased_tasks),
        (3, 0, 4)
    );
}

async fn a_task_is_anothers_only_after_its_lease_has_ended(queue: Queue) {
    let id = submit(&queue, job(1, 1, 0)).await;
    let first = take(&queue, 1000).await.lease;
    assert!(is_idle(&queue, 30_000).await);
    assert_eq!(
        queue.heartbeat(&first, LENGTH, 30_000).await.unwrap(),
        Order::GoOn
    );
    assert!(is_idle(&queue, 59_000).await, "the lease was renewed");
    assert!(
        is_idle(&queue, 60_001).await,
        "it has ended, and the task pauses"
    );
    let second = take(&queue, 62_000).await.lease;
    assert!(second.attempt > first.attempt);
    for late in [
        queue.heartbeat(&first, LENGTH, 62_001).await.map(|_| ()),
        queue.complete(&first, own(&first), 62_001).await,
        queue.fail(&first, &passing(), 62_001).await.map(|_| ()),
        queue.give_back(&first, 62_001).await,
    ] {
        assert!(
            matches!(late, Err(QueueError::LeaseLost { .. })),
            "{late:?}"
        );
    }
    queue.complete(&second, own(&second), 62_002).await.unwrap();
    let twice = queue.complete(&second, own(&second), 62_003).await;
    assert!(
        matches!(twice, Err(QueueError::LeaseLost { .. })),
        "{twice:?}"
    );
    let known = queue.job(&id).await.unwrap();
    assert_eq!((known.state, known.done), (JobState::Done, 1));
    assert_eq!((known.started, known.finished), (Some(1000), Some(62_002)));
    let tasks = queue.tasks(&id).await.unwrap();
    assert_eq!(tasks[0].object, Some(own(&second)));
    assert_eq!((tasks[0].attempts, tasks[0].state), (2, TaskState::Done));
}

async fn failures_wait_longer_each_time_and_end_in_a_dead_letter(queue: Queue) {
    let id = submit(&queue, job(1, 2, 0)).await;
    let mut now = 10_000;
    for (pause, end) in [(1000, TaskState::Queued), (2000, TaskState::Queued)] {
        let lease = take(&queue, now).await.lease;
        assert_eq!(lease.number, 0);
        assert_eq!(queue.fail(&lease, &passing(), now).await.unwrap(), end);
        let other = take(&queue, now + pause - 1).await.lease;
        assert_eq!(other.number, 1, "the first one pauses");
        queue.give_back(&other, now + pause - 1).await.unwrap();
        now += pause;
    }
    let lease = take(&queue, now).await.lease;
    assert_eq!(
        queue.fail(&lease, &passing(), now).await.unwrap(),
        TaskState::Dead
    );
    assert!(is_idle(&queue, now + 1_000_000).await, "the job has failed");
    let known = queue.job(&id).await.unwrap();
    assert_eq!((known.state, known.finished), (JobState::Failed, Some(now)));
    assert!(
        known
            .error
            .is_some_and(|why| why.contains("the test says so"))
    );
    let states: Vec<TaskState> = queue
        .tasks(&id)
        .await
        .unwrap()
        .iter()
        .map(|task| task.state)
        .collect();
    assert_eq!(states, [TaskState::Dead, TaskState::Cancelled]);
    assert_eq!(queue.counts().await.unwrap().dead_tasks, 1);
}

async fn two_lost_devices_and_hopeless_tasks_are_dead_letters(queue: Queue) {
    let lost = Failure {
        kind: FailureKind::DeviceLost,
        reason: "the device is lost".to_owned(),
    };
    submit(&queue, job(1, 1, 0)).await;
    let lease = take(&queue, 0).await.lease;
    assert_eq!(
        queue.fail(&lease, &lost, 0).await.unwrap(),
        TaskState::Queued
    );
    let lease = take(&queue, 10_000).await.lease;
    assert_eq!(
        queue.fail(&lease, &lost, 10_000).await.unwrap(),
        TaskState::Dead
    );
    let hopeless = Failure {
        kind: FailureKind::ForGood,
        ..lost
    };
    let id = submit(&queue, job(2, 1, 0)).await;
    let lease = take(&queue, 20_000).await.lease;
    assert_eq!(
        queue.fail(&lease, &hopeless, 20_000).await.unwrap(),
        TaskState::Dead
    );
    assert_eq!(queue.job(&id).await.unwrap().state, JobState::Failed);
}

async fn what_is_given_back_or_reclaimed_is_free_at_once(queue: Queue) {
    submit(&queue, job(1, 1, 0)).await;
    for _ in 0..10 {
        let lease = take(&queue, 5).await.lease;
        queue.give_back(&lease, 5).await.unwrap();
    }
    let lease = take(&queue, 6).await.lease;
    assert_eq!(queue.reclaim("nobody", 7).await.unwrap(), 0);
    assert_eq!(queue.reclaim("worker", 7).await.unwrap(), 1);
    let late = queue.complete(&lease, own(&lease), 8).await;
    assert!(
        matches!(late, Err(QueueError::LeaseLost { .. })),
        "{late:?}"
    );
    assert!(take(&queue, 1_007).await.lease.attempt > lease.attempt);
}

async fn a_cancelled_job_stops_and_keeps_what_it_has(queue: Queue) {
    let id = submit(&queue, job(1, 3, 0)).await;
    let done = take(&queue, 1).await.lease;
    queue.complete(&done, own(&done), 2).await.unwrap();
    let running = take(&queue, 3).await.lease;
    let cancelled = queue.cancel(&id, 4).await.unwrap();
    assert_eq!(
        (cancelled.state, cancelled.finished),
        (JobState::Cancelled, Some(4))
    );
    assert!(is_idle(&queue, 5).await);
    assert_eq!(
        queue.heartbeat(&running, LENGTH, 5).await.unwrap(),
        Order::Stop
    );
    let partial = of_suite(&format!("jobs/{id}/1-partial.png"));
    queue.complete(&running, partial.clone(), 6).await.unwrap();
    let tasks = queue.tasks(&id).await.unwrap();
    let found: Vec<_> = tasks
        .iter()
        .map(|task| (task.state, task.object.clone()))
        .collect();
    let expected = [
        (TaskState::Done, Some(own(&done))),
        (TaskState::Cancelled, Some(partial)),
        (TaskState::Cancelled, None),
    ];
    assert_eq!(found, expected);
    let again = queue.cancel(&id, 7).await.unwrap();
    assert_eq!(
        (again.state, again.finished),
        (JobState::Cancelled, Some(4))
    );
    let missing = JobId::new(9).unwrap();
    for refused in [queue.cancel(&missing, 8).await, queue.job(&missing).await] {
        assert!(
            matches!(refused, Err(QueueError::NoSuchJob(_))),
            "{refused:?}"
        );
    }
}

async fn a_key_accepts_one_request_once(queue: Queue) {
    let with_key = |number| NewJob {
        idempotency_key: Some("key".to_owned()),
        ..job(number, 1, 0)
    };
    let first = queue.submit(with_key(1), 1).await.unwrap();
    let again = NewJob {
        id: JobId::new(2).unwrap(),
        ..with_key(1)
    };
    let again = queue.submit(again, 2).await.unwrap();
    assert!(first.is_new && !again.is_new);
    assert_eq!(first.job.id, again.job.id);
    let other = queue.submit(with_key(3), 3).await;
    assert!(matches!(other, Err(QueueError::KeyReused { job }) if job == first.job.id));
    assert_eq!(queue.counts().await.unwrap().jobs, 1);
}

async fn a_full_queue_says_so<Q: TaskQueue>(queue: Arc<Q>) {
    let queue: Queue = queue;
    let first = submit(&queue, job(1, 1, 0)).await;
    submit(&queue, job(2, 1, 0)).await;
    let refused = queue.submit(job(3, 1, 0), 1).await;
    let full = matches!(
        refused,
        Err(QueueError::Full {
            found: 3,
            limit: 2,
            ..
        })
    );
    assert!(full, "{refused:?}");
    queue.cancel(&first, 2).await.unwrap();
    submit(&queue, job(4, 1, 0)).await;
}

async fn lists_have_pages_and_filters(queue: Queue) {
    let mut ids = Vec::new();
    for number in 0..5 {
        ids.push(submit(&queue, job(number, 1, 0)).await);
    }
    queue.cancel(&ids[1], 9).await.unwrap();
    let mut after = None;
    let mut seen = Vec::new();
    loop {
        let page = PageAsked { limit: 2, after };
        let page = queue.list(Filter::default(), &page).await.unwrap();
        seen.extend(page.jobs.iter().map(|job| job.id.clone()));
        if !page.more {
            break;
        }
        after = page.jobs.last().map(|job| job.id.clone());
    }
    let newest_first: Vec<JobId> = ids.iter().rev().cloned().collect();
    assert_eq!(seen, newest_first);
    let state = Some(JobState::Cancelled);
    let page = PageAsked {
        limit: 9,
        after: None,
    };
    let found = queue.list(Filter { state }, &page).await.unwrap();
    assert_eq!(found.jobs.len(), 1);
    assert_eq!(found.jobs[0].id, ids[1]);
}

async fn a_video_waits_for_its_frames(queue: Queue) {
    let mut wanted = job(1, 2, 0);
    wanted.tasks.push(TaskSpec {
        kind: TaskKind::Video,
        spec_hash: "video".to_owned(),
    });
    let id = submit(&queue, wanted).await;
    let frames = [take(&queue, 1).await, take(&queue, 1).await];
    for (number, frame) in (0..).zip(&frames) {
        assert_eq!((frame.kind, frame.lease.number), (TaskKind::Frame, number));
        assert!(is_idle(&queue, 2).await, "a frame is missing");
        queue
            .complete(&frame.lease, own(&frame.lease), 2)
            .await
            .unwrap();
    }
    let video = take(&queue, 3).await;
    assert_eq!(video.kind, TaskKind::Video);
    assert_eq!(queue.job(&id).await.unwrap().state, JobState::Running);
    queue
        .complete(&video.lease, own(&video.lease), 4)
        .await
        .unwrap();
    assert_eq!(queue.job(&id).await.unwrap().state, JobState::Done);
}

async fn results_are_known_until_no_job_has_them(queue: Queue) {
    let first = submit(&queue, job(1, 1, 0)).await;
    assert_eq!(queue.known_object("1-0").await.unwrap(), None);
    let lease = take(&queue, 1).await.lease;
    let object = own(&lease);
    queue.complete(&lease, object.clone(), 10).await.unwrap();
    assert_eq!(
        queue.known_object("1-0").await.unwrap(),
        Some(object.clone())
    );
    // Another job that makes the same refers to it.
    submit(&queue, job(2, 1, 0)).await;
    let other = take(&queue, 11).await.lease;
    queue.complete(&other, object.clone(), 20).await.unwrap();
    let (jobs, objects) = queue.expire(15, 10).await.unwrap();
    assert_eq!(
        (jobs, objects),
        (vec![first.clone()], vec![]),
        "the other one has it"
    );
    assert!(matches!(
        queue.job(&first).await,
        Err(QueueError::NoSuchJob(_))
    ));
    let (jobs, objects) = queue.expire(100, 10).await.unwrap();
    assert_eq!((jobs.len(), objects), (1, vec![object.clone()]));
    // Who found it before it was forgotten must not refer to it any more.
    submit(&queue, job(3, 1, 0)).await;
    let late = take(&queue, 101).await.lease;
    let refused = queue.complete(&late, object, 102).await;
    assert!(
        matches!(refused, Err(QueueError::ObjectGone { .. })),
        "{refused:?}"
    );
    queue.complete(&late, own(&late), 103).await.unwrap();
}

async fn those_who_wait_hear_of_changes(queue: Queue) {
    let mut changes = queue.changes();
    changes.mark_unchanged();
    let id = submit(&queue, job(1, 1, 0)).await;
    assert!(changes.has_changed().unwrap());
    changes.mark_unchanged();
    let before = queue.job(&id).await.unwrap().revision;
    let lease = take(&queue, 1).await.lease;
    assert!(changes.has_changed().unwrap());
    assert!(queue.job(&id).await.unwrap().revision > before);
    changes.mark_unchanged();
    assert_eq!(
        queue.heartbeat(&lease, LENGTH, 2).await.unwrap(),
        Order::GoOn
    );
    assert!(
        !changes.has_changed().unwrap(),
        "a heartbeat changes nothing that is told"
    );
    queue.complete(&lease, own(&lease), 3).await.unwrap();
    assert!(changes.has_changed().unwrap());
}

/// 32 clients submit 10 jobs each while 4 workers take them.
async fn many_clients_and_workers_do_every_task_once(queue: Queue) {
    const CLIENTS: u64 = 32;
    const JOBS: u64 = 10;
    let clients: Vec<_> = (0..CLIENTS)
        .map(|client| {
            let queue = Arc::clone(&queue);
            tokio::spawn(async move {
                for number in 0..JOBS {
                    submit(&queue, job(client * JOBS + number, 1, 0)).await;
                }
            })
        })
        .collect();
    let workers: Vec<_> = (0..4)
        .map(|_| {
            let queue = Arc::clone(&queue);
            tokio::spawn(async move {
                let mut done = Vec::new();
                while queue.counts().await.unwrap().jobs < CLIENTS * JOBS
                    || queue.counts().await.unwrap().queued_tasks > 0
                {
                    if let Some(leased) = queue.lease("worker", LENGTH, 1).await.unwrap() {
                        let lease = leased.lease;
                        queue.complete(&lease, own(&lease), 2).await.unwrap();
                        done.push(lease.job);
                    }
                }
                done
            })
        })
        .collect();
    for client in clients {
        client.await.unwrap();
    }
    let mut done = Vec::new();
    for worker in workers {
        done.extend(worker.await.unwrap());
    }
    assert_eq!(done.len() as u64, CLIENTS * JOBS, "none twice");
    assert_eq!(done.iter().collect::<BTreeSet<_>>().len(), done.len());
    assert_eq!(queue.counts().await.unwrap().open_jobs, 0);
}
