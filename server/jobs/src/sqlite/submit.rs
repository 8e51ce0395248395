//! Accepting a job: all of it or nothing, and once only under one key.

use rusqlite::{OptionalExtension as _, Transaction, params};

use super::read::{self, JOB, job_of};
use super::{SqliteLimits, Stored as _};
use crate::queue::{Millis, NewJob, QueueError, Submitted};
use crate::spec::TaskKind;
use crate::state::{JobState, TaskState};

pub(super) fn submit(
    db: &Transaction<'_>,
    job: &NewJob,
    now: Millis,
    limits: &SqliteLimits,
) -> Result<Submitted, QueueError> {
    if let Some(key) = &job.idempotency_key {
        let sql = format!("SELECT {JOB}, request_hash FROM jobs WHERE idempotency_key = ?1");
        let with_hash = |row: &rusqlite::Row<'_>| Ok((job_of(row)?, row.get::<_, String>(11)?));
        let known = db.query_row(&sql, [key], with_hash).optional().stored()?;
        if let Some((job_before, hash)) = known {
            if hash != job.request_hash {
                return Err(QueueError::KeyReused { job: job_before.id });
            }
            return Ok(Submitted {
                job: job_before,
                is_new: false,
            });
        }
    }
    check_room(db, job, limits)?;
    let request = serde_json::to_string(&job.request)
        .map_err(|error| QueueError::Storage(error.to_string()))?;
    let frames = job.tasks.iter().filter(|task| task.kind == TaskKind::Frame);
    let queued = frames.count() as u64;
    db.execute(
        "INSERT INTO jobs (id, state, request, request_hash, idempotency_key, priority, created,
            revision, tasks, done, queued, leased)
         VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, 1, ?8, 0, ?9, 0)",
        params![
            job.id.as_str(),
            JobState::Queued.name(),
            request,
            job.request_hash,
            job.idempotency_key,
            job.request.priority,
            now,
            job.tasks.len() as u64,
            queued,
        ],
    )
    .stored()?;
    let seq = db.last_insert_rowid();
    let mut insert = db
        .prepare(
            "INSERT INTO tasks (job, number, kind, spec_hash, state, attempt, failures, losses,
                not_before)
             VALUES (?1, ?2, ?3, ?4, ?5, 0, 0, 0, 0)",
        )
        .stored()?;
    for (number, task) in (0_u32..).zip(&job.tasks) {
        let state = match task.kind {
            TaskKind::Frame => TaskState::Queued,
            TaskKind::Video => TaskState::Waiting,
        };
        let values = params![seq, number, task.kind.name(), task.spec_hash, state.name()];
        insert.execute(values).stored()?;
    }
    drop(insert);
    Ok(Submitted {
        job: read::job(db, &job.id)?,
        is_new: true,
    })
}

fn check_room(db: &Transaction<'_>, job: &NewJob, limits: &SqliteLimits) -> Result<(), QueueError> {
    let sql = "SELECT count(*), coalesce(sum(tasks - done), 0) FROM jobs WHERE finished IS NULL";
    let open = db.query_row(sql, [], |row| {
        Ok((row.get::<_, u64>(0)?, row.get::<_, u64>(1)?))
    });
    let (jobs, tasks) = open.stored()?;
    let wanted = [
        ("jobs", jobs + 1, limits.open_jobs),
        ("tasks", tasks + job.tasks.len() as u64, limits.open_tasks),
    ];
    match wanted.into_iter().find(|(_, found, limit)| found > limit) {
        Some((what, found, limit)) => Err(QueueError::Full { what, found, limit }),
        None => Ok(()),
    }
}
