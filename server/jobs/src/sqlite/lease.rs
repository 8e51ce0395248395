//! Taking tasks, and what becomes of them.
//!
//! A job's counters of its tasks change together with the tasks, in [`moved`] alone.

use std::time::Duration;

use rusqlite::{OptionalExtension as _, Transaction, params};

use super::read::{self, JOB, job_of, kind_of};
use super::{SqliteLimits, Stored as _};
use crate::id::JobId;
use crate::queue::{
    Failure, FailureKind, Lease, LeasedTask, Millis, Order, QueueError, objects_of,
};
use crate::state::{JobRecord, JobState, StoredObject, TaskState};

/// A task in the tables.
struct Row {
    seq: i64,
    number: u32,
    failures: u32,
    losses: u32,
}

/// Why a lease that nobody renewed is a failure.
const FELL_SILENT: &str = "the worker fell silent";
/// Why a lease of a worker that has started anew is a failure.
const ENDED: &str = "the worker ended";

pub(super) fn take(
    db: &Transaction<'_>,
    worker: &str,
    length: Duration,
    now: Millis,
) -> Result<Option<LeasedTask>, QueueError> {
    let sql = "SELECT j.seq, t.number, t.kind, t.spec_hash, t.attempt FROM jobs j JOIN tasks t
        ON t.job = j.seq AND t.number = (SELECT min(number) FROM tasks
            WHERE job = j.seq AND state = 'queued' AND not_before <= ?1)
        WHERE j.queued > 0 ORDER BY j.priority DESC, j.leased, j.seq LIMIT 1";
    let found = db.query_row(sql, [now], |row| {
        let kind: String = row.get(2)?;
        Ok((
            row.get::<_, i64>(0)?,
            row.get::<_, u32>(1)?,
            kind_of(2, &kind)?,
            row.get::<_, String>(3)?,
            row.get::<_, u32>(4)?,
        ))
    });
    let Some((seq, number, kind, spec_hash, attempt)) = found.optional().stored()? else {
        return Ok(None);
    };
    let attempt = attempt.saturating_add(1);
    let until = now.saturating_add(length.as_millis() as u64);
    db.execute(
        "UPDATE tasks SET attempt = ?3, worker = ?4, lease_until = ?5 WHERE job = ?1 AND number = ?2",
        params![seq, number, attempt, worker, until],
    )
    .stored()?;
    moved(db, seq, number, TaskState::Queued, TaskState::Leased)?;
    db.execute(
        "UPDATE jobs SET state = 'running', started = coalesce(started, max(?2, created)) WHERE seq = ?1",
        params![seq, now],
    )
    .stored()?;
    let job = record(db, seq)?;
    Ok(Some(LeasedTask {
        lease: Lease {
            job: job.id.clone(),
            number,
            attempt,
        },
        job,
        kind,
        spec_hash,
    }))
}

pub(super) fn renew(
    db: &Transaction<'_>,
    lease: &Lease,
    length: Duration,
    now: Millis,
) -> Result<Order, QueueError> {
    let row = held(db, lease)?;
    let until = now.saturating_add(length.as_millis() as u64);
    db.execute(
        "UPDATE tasks SET lease_until = ?3 WHERE job = ?1 AND number = ?2",
        params![row.seq, row.number, until],
    )
    .stored()?;
    let over = record(db, row.seq)?.state.is_over();
    Ok(if over { Order::Stop } else { Order::GoOn })
}

pub(super) fn complete(
    db: &Transaction<'_>,
    lease: &Lease,
    object: &StoredObject,
    now: Millis,
) -> Result<(), QueueError> {
    let row = held(db, lease)?;
    if !object.key.starts_with(&objects_of(&lease.job)) {
        let sql = "SELECT 1 FROM tasks WHERE object_key = ?1 LIMIT 1";
        let kept = db.query_row(sql, [&object.key], |_| Ok(())).optional();
        if kept.stored()?.is_none() {
            let key = object.key.clone();
            return Err(QueueError::ObjectGone { key });
        }
    }
    db.execute(
        "UPDATE tasks SET object_key = ?3, object_bytes = ?4, object_sha256 = ?5, error = NULL
         WHERE job = ?1 AND number = ?2",
        params![row.seq, row.number, object.key, object.bytes, object.sha256],
    )
    .stored()?;
    let over = record(db, row.seq)?.state.is_over();
    let end = if over {
        TaskState::Cancelled
    } else {
        TaskState::Done
    };
    moved(db, row.seq, row.number, TaskState::Leased, end)?;
    if over {
        return Ok(());
    }
    let job = record(db, row.seq)?;
    if job.done == job.tasks {
        return close(db, row.seq, JobState::Done, None, now);
    }
    // All but those that wait are done.
    let sql = "SELECT number FROM tasks WHERE job = ?1 AND state = 'waiting'";
    let mut statement = db.prepare(sql).stored()?;
    let rows = statement.query_map([row.seq], |row| row.get(0)).stored()?;
    let waiting: Vec<u32> = rows.collect::<rusqlite::Result<_>>().stored()?;
    if job.done + waiting.len() as u32 == job.tasks {
        for number in waiting {
            moved(db, row.seq, number, TaskState::Waiting, TaskState::Queued)?;
        }
    }
    Ok(())
}

pub(super) fn fail(
    db: &Transaction<'_>,
    lease: &Lease,
    failure: &Failure,
    now: Millis,
    limits: &SqliteLimits,
) -> Result<TaskState, QueueError> {
    let row = held(db, lease)?;
    failed(db, &row, failure, now, limits)
}

pub(super) fn give_back(
    db: &Transaction<'_>,
    lease: &Lease,
    now: Millis,
) -> Result<(), QueueError> {
    let row = held(db, lease)?;
    if record(db, row.seq)?.state.is_over() {
        return moved(
            db,
            row.seq,
            row.number,
            TaskState::Leased,
            TaskState::Cancelled,
        );
    }
    db.execute(
        "UPDATE tasks SET not_before = ?3 WHERE job = ?1 AND number = ?2",
        params![row.seq, row.number, now],
    )
    .stored()?;
    moved(
        db,
        row.seq,
        row.number,
        TaskState::Leased,
        TaskState::Queued,
    )
}

/// Ends the leases that were not renewed in time; how many.
pub(super) fn end_late(
    db: &Transaction<'_>,
    now: Millis,
    limits: &SqliteLimits,
) -> Result<u64, QueueError> {
    let condition = "state = 'leased' AND lease_until < ?1";
    end_leases(db, condition, params![now], FELL_SILENT, now, limits)
}

/// Ends the leases of a worker; how many.
pub(super) fn reclaim(
    db: &Transaction<'_>,
    worker: &str,
    now: Millis,
    limits: &SqliteLimits,
) -> Result<u64, QueueError> {
    let condition = "state = 'leased' AND worker = ?1";
    end_leases(db, condition, params![worker], ENDED, now, limits)
}

fn end_leases(
    db: &Transaction<'_>,
    condition: &str,
    values: &[&dyn rusqlite::ToSql],
    reason: &str,
    now: Millis,
    limits: &SqliteLimits,
) -> Result<u64, QueueError> {
    let sql = format!("SELECT job, number, failures, losses FROM tasks WHERE {condition}");
    let mut statement = db.prepare(&sql).stored()?;
    let rows = statement.query_map(values, row_of).stored()?;
    let late: Vec<Row> = rows.collect::<rusqlite::Result<_>>().stored()?;
    let failure = Failure {
        kind: FailureKind::Passing,
        reason: reason.to_owned(),
    };
    for row in &late {
        failed(db, row, &failure, now, limits)?;
    }
    Ok(late.len() as u64)
}

/// A leased task has failed: it waits, or is a dead letter and its job has failed.
fn failed(
    db: &Transaction<'_>,
    row: &Row,
    failure: &Failure,
    now: Millis,
    limits: &SqliteLimits,
) -> Result<TaskState, QueueError> {
    let failures = row.failures.saturating_add(1);
    let losses = row.losses + u32::from(failure.kind == FailureKind::DeviceLost);
    let exponent = row.failures.min(20);
    let pause = limits.backoff.saturating_mul(1 << exponent);
    let pause = pause.min(limits.longest_backoff).as_millis() as u64;
    db.execute(
        "UPDATE tasks SET failures = ?3, losses = ?4, not_before = ?5, error = ?6
         WHERE job = ?1 AND number = ?2",
        params![
            row.seq,
            row.number,
            failures,
            losses,
            now.saturating_add(pause),
            failure.reason
        ],
    )
    .stored()?;
    let is_hopeless = failure.kind == FailureKind::ForGood
        || failures >= limits.failures
        || losses >= limits.losses;
    let end = if record(db, row.seq)?.state.is_over() {
        TaskState::Cancelled
    } else if is_hopeless {
        TaskState::Dead
    } else {
        TaskState::Queued
    };
    moved(db, row.seq, row.number, TaskState::Leased, end)?;
    if end == TaskState::Dead {
        let why = format!("task {}: {}", row.number, failure.reason);
        close(db, row.seq, JobState::Failed, Some(&why), now)?;
    }
    Ok(end)
}

pub(super) fn cancel(
    db: &Transaction<'_>,
    job: &JobId,
    now: Millis,
) -> Result<JobRecord, QueueError> {
    let seq = read::seq(db, job)?;
    if !record(db, seq)?.state.is_over() {
        close(db, seq, JobState::Cancelled, None, now)?;
    }
    record(db, seq)
}

/// The job is over: what nobody has of it is not begun any more.
fn close(
    db: &Transaction<'_>,
    seq: i64,
    state: JobState,
    error: Option<&str>,
    now: Millis,
) -> Result<(), QueueError> {
    db.execute(
        "UPDATE tasks SET state = 'cancelled' WHERE job = ?1 AND state IN ('queued', 'waiting')",
        [seq],
    )
    .stored()?;
    db.execute(
        "UPDATE jobs SET state = ?2, finished = ?3, error = ?4, queued = 0, revision = revision + 1
         WHERE seq = ?1",
        params![seq, state.name(), now, error],
    )
    .stored()?;
    Ok(())
}

/// Brings a task from one state to another, with its job's counters.
fn moved(
    db: &Transaction<'_>,
    seq: i64,
    number: u32,
    from: TaskState,
    to: TaskState,
) -> Result<(), QueueError> {
    db.execute(
        "UPDATE tasks SET state = ?3 WHERE job = ?1 AND number = ?2",
        params![seq, number, to.name()],
    )
    .stored()?;
    let change = |state: TaskState| i64::from(to == state) - i64::from(from == state);
    db.execute(
        "UPDATE jobs SET queued = queued + ?2, leased = leased + ?3, done = done + ?4,
            revision = revision + 1 WHERE seq = ?1",
        params![
            seq,
            change(TaskState::Queued),
            change(TaskState::Leased),
            change(TaskState::Done)
        ],
    )
    .stored()?;
    Ok(())
}

/// The task of a lease that holds.
fn held(db: &Transaction<'_>, lease: &Lease) -> Result<Row, QueueError> {
    let seq = read::seq(db, &lease.job)?;
    let sql = "SELECT job, number, failures, losses FROM tasks
        WHERE job = ?1 AND number = ?2 AND attempt = ?3 AND state = 'leased'";
    let found = db.query_row(sql, params![seq, lease.number, lease.attempt], row_of);
    let found = found.optional().stored()?;
    found.ok_or_else(|| QueueError::LeaseLost {
        job: lease.job.clone(),
        number: lease.number,
    })
}

fn row_of(row: &rusqlite::Row<'_>) -> rusqlite::Result<Row> {
    Ok(Row {
        seq: row.get(0)?,
        number: row.get(1)?,
        failures: row.get(2)?,
        losses: row.get(3)?,
    })
}

fn record(db: &Transaction<'_>, seq: i64) -> Result<JobRecord, QueueError> {
    let sql = format!("SELECT {JOB} FROM jobs WHERE seq = ?1");
    db.query_row(&sql, [seq], job_of).stored()
}
