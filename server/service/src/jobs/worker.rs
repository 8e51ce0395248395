//! Takes tasks and brings each to its end: done, failed, given back, or stopped with what there was.

use std::sync::Arc;
use std::time::{Duration, Instant};

use tokio_util::sync::CancellationToken;
use tyndall_jobs::{Failure, FailureKind, LeasedTask, Order, QueueError};

use super::make::Made;
use super::{Jobs, now};
use crate::bell::lock;
use crate::stills::StillWatch;
use crate::telemetry;

/// The name of this process at the queue: its folder is nobody else's, so one is enough.
pub(super) const WORKER: &str = "local";
/// Length of a lease.
const LEASE: Duration = Duration::from_secs(30);
/// How often it is renewed.
const HEARTBEAT_EVERY: Duration = Duration::from_secs(5);
/// A task whose progress stands still for so long is not renewed any more.
const STALLED_AFTER: Duration = Duration::from_mins(3);
/// How often the queue is asked without a change: tasks that pause come free by time alone.
const ASK_EVERY: Duration = Duration::from_millis(500);

/// Works until the service goes down.
pub(crate) async fn work(jobs: Arc<Jobs>, shutdown: CancellationToken) {
    let mut changes = jobs.queue.changes();
    while !shutdown.is_cancelled() {
        changes.mark_unchanged();
        match jobs.queue.lease(WORKER, LEASE, now()).await {
            Ok(Some(task)) => run(&jobs, &task, &shutdown).await,
            Ok(None) => {
                tokio::select! {
                    () = shutdown.cancelled() => return,
                    () = tokio::time::sleep(ASK_EVERY) => {}
                    // The queue lives as long as the jobs.
                    _changed = changes.changed() => {}
                }
            }
            Err(error) => {
                tracing::error!(%error, "no task could be taken");
                tokio::time::sleep(ASK_EVERY).await;
            }
        }
    }
}

/// Brings one task to its end.
async fn run(jobs: &Arc<Jobs>, task: &LeasedTask, shutdown: &CancellationToken) {
    let lease = &task.lease;
    let watch = Arc::new(StillWatch::default());
    let place = (lease.job.clone(), lease.number);
    lock(&jobs.live).insert(place.clone(), Arc::clone(&watch));
    let began = Instant::now();
    let made = watched(jobs, task, &watch, shutdown).await;
    lock(&jobs.live).remove(&place);
    let outcome = match &made {
        Ok(Made::Stored(_)) if watch.is_stopped() => "stopped",
        Ok(Made::Stored(_)) => "done",
        Ok(Made::Nothing | Made::Interrupted) => "given back",
        Err(_) => "failed",
    };
    let ended = end(jobs, task, made, &watch, shutdown).await;
    telemetry::task_ended(outcome, began.elapsed());
    // The audit log: one line a task.
    let seconds = began.elapsed().as_secs_f32();
    match ended {
        Ok(()) => {
            tracing::info!(job = %lease.job, task = lease.number, attempt = lease.attempt, outcome, seconds, "a task of a job ended");
        }
        Err(error) => {
            tracing::warn!(job = %lease.job, task = lease.number, attempt = lease.attempt, %error, "the end of a task could not be noted");
        }
    }
}

/// Makes the task's result, and meanwhile renews the lease as long as there is progress.
async fn watched(
    jobs: &Arc<Jobs>,
    task: &LeasedTask,
    watch: &Arc<StillWatch>,
    shutdown: &CancellationToken,
) -> Result<Made, Failure> {
    let making = jobs.make(task, watch);
    tokio::pin!(making);
    let mut tick = tokio::time::interval(HEARTBEAT_EVERY);
    tick.set_missed_tick_behavior(tokio::time::MissedTickBehavior::Delay);
    let mut last = (watch.progress().frames, Instant::now());
    let mut going_down = false;
    loop {
        tokio::select! {
            made = &mut making => return made,
            () = shutdown.cancelled(), if !going_down => {
                going_down = true;
                watch.stop();
                jobs.desk.wake();
            }
            _ = tick.tick() => {
                let frames = watch.progress().frames;
                if frames != last.0 {
                    last = (frames, Instant::now());
                }
                if last.1.elapsed() > STALLED_AFTER {
                    continue;
                }
                match jobs.queue.heartbeat(&task.lease, LEASE, now()).await {
                    Ok(Order::GoOn) => {}
                    Ok(Order::Stop) | Err(QueueError::LeaseLost { .. }) => {
                        watch.stop();
                        jobs.desk.wake();
                    }
                    Err(error) => tracing::warn!(%error, "a lease could not be renewed"),
                }
            }
        }
    }
}

/// Tells the queue what became of the task.
async fn end(
    jobs: &Jobs,
    task: &LeasedTask,
    made: Result<Made, Failure>,
    watch: &StillWatch,
    shutdown: &CancellationToken,
) -> Result<(), QueueError> {
    let (queue, lease) = (&jobs.queue, &task.lease);
    match made {
        // A stop that is no cancellation: the task is another's, from its beginning.
        Ok(Made::Stored(object)) if watch.is_stopped() && shutdown.is_cancelled() => {
            if queue.job(&lease.job).await?.state.is_over() {
                return queue.complete(lease, object, now()).await;
            }
            jobs.results.remove(&object.key).await.unwrap_or_default();
            queue.give_back(lease, now()).await
        }
        Ok(Made::Stored(object)) => match queue.complete(lease, object, now()).await {
            Err(QueueError::ObjectGone { key }) => {
                let failure = Failure {
                    kind: FailureKind::Passing,
                    reason: format!("the object {key} is not kept any more"),
                };
                queue.fail(lease, &failure, now()).await.map(|_state| ())
            }
            other => other,
        },
        Ok(Made::Nothing | Made::Interrupted) => queue.give_back(lease, now()).await,
        Err(failure) => queue.fail(lease, &failure, now()).await.map(|_state| ()),
    }
}
