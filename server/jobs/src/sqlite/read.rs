//! What is told of jobs and tasks.

use rusqlite::types::Type;
use rusqlite::{OptionalExtension as _, Row, Transaction, params};

use super::Stored as _;
use crate::id::JobId;
use crate::queue::{Counts, Filter, Page, PageAsked, QueueError};
use crate::spec::TaskKind;
use crate::state::{JobRecord, JobState, StoredObject, TaskRecord, TaskState};

/// The columns that [`job_of`] reads.
pub(super) const JOB: &str =
    "id, state, request, priority, created, started, finished, revision, tasks, done, error";

/// A value that cannot have been written by this program.
fn unfit(column: usize, what: &str) -> rusqlite::Error {
    rusqlite::Error::FromSqlConversionFailure(column, Type::Text, what.to_owned().into())
}

/// A job of a row with the columns [`JOB`].
pub(super) fn job_of(row: &Row<'_>) -> rusqlite::Result<JobRecord> {
    let id: String = row.get(0)?;
    let state: String = row.get(1)?;
    let request: String = row.get(2)?;
    let known = JobState::ALL
        .into_iter()
        .find(|known| known.name() == state);
    Ok(JobRecord {
        id: id.parse().map_err(|_unfit| unfit(0, "no name of a job"))?,
        state: known.ok_or_else(|| unfit(1, "no state of a job"))?,
        request: serde_json::from_str(&request).map_err(|error| unfit(2, &error.to_string()))?,
        priority: row.get(3)?,
        created: row.get(4)?,
        started: row.get(5)?,
        finished: row.get(6)?,
        revision: row.get(7)?,
        tasks: row.get(8)?,
        done: row.get(9)?,
        error: row.get(10)?,
    })
}

/// A kind of task by its name.
pub(super) fn kind_of(column: usize, name: &str) -> rusqlite::Result<TaskKind> {
    let kinds = [TaskKind::Frame, TaskKind::Video];
    let known = kinds.into_iter().find(|kind| kind.name() == name);
    known.ok_or_else(|| unfit(column, "no kind of task"))
}

/// An object of three columns from `first` on, if there is one.
fn object_of(row: &Row<'_>, first: usize) -> rusqlite::Result<Option<StoredObject>> {
    let key: Option<String> = row.get(first)?;
    key.map(|key| {
        Ok(StoredObject {
            key,
            bytes: row.get(first + 1)?,
            sha256: row.get(first + 2)?,
        })
    })
    .transpose()
}

pub(super) fn job(db: &Transaction<'_>, job: &JobId) -> Result<JobRecord, QueueError> {
    let sql = format!("SELECT {JOB} FROM jobs WHERE id = ?1");
    let found = db
        .query_row(&sql, [job.as_str()], job_of)
        .optional()
        .stored()?;
    found.ok_or_else(|| QueueError::NoSuchJob(job.clone()))
}

/// The number of a job in the tables.
pub(super) fn seq(db: &Transaction<'_>, job: &JobId) -> Result<i64, QueueError> {
    let sql = "SELECT seq FROM jobs WHERE id = ?1";
    let found = db.query_row(sql, [job.as_str()], |row| row.get(0));
    let found = found.optional().stored()?;
    found.ok_or_else(|| QueueError::NoSuchJob(job.clone()))
}

pub(super) fn tasks(db: &Transaction<'_>, job: &JobId) -> Result<Vec<TaskRecord>, QueueError> {
    let seq = seq(db, job)?;
    let sql = "SELECT number, kind, spec_hash, state, attempt, object_key, object_bytes,
        object_sha256, error FROM tasks WHERE job = ?1 ORDER BY number";
    let mut statement = db.prepare(sql).stored()?;
    let rows = statement.query_map([seq], |row| {
        let (kind, state): (String, String) = (row.get(1)?, row.get(3)?);
        let known = TaskState::ALL
            .into_iter()
            .find(|known| known.name() == state);
        Ok(TaskRecord {
            number: row.get(0)?,
            kind: kind_of(1, &kind)?,
            spec_hash: row.get(2)?,
            state: known.ok_or_else(|| unfit(3, "no state of a task"))?,
            attempts: row.get(4)?,
            object: object_of(row, 5)?,
            error: row.get(8)?,
        })
    });
    rows.stored()?.collect::<rusqlite::Result<_>>().stored()
}

pub(super) fn list(
    db: &Transaction<'_>,
    filter: Filter,
    page: &PageAsked,
) -> Result<Page, QueueError> {
    let before = match &page.after {
        Some(job) => seq(db, job)?,
        None => i64::MAX,
    };
    let state = filter.state.map(JobState::name);
    let sql = format!(
        "SELECT {JOB} FROM jobs WHERE seq < ?1 AND (?2 IS NULL OR state = ?2)
         ORDER BY seq DESC LIMIT ?3"
    );
    let mut statement = db.prepare(&sql).stored()?;
    let limit = page.limit as usize;
    let rows = statement.query_map(params![before, state, i64::from(page.limit) + 1], job_of);
    let mut jobs: Vec<JobRecord> = rows.stored()?.collect::<rusqlite::Result<_>>().stored()?;
    let more = jobs.len() > limit;
    jobs.truncate(limit);
    Ok(Page { jobs, more })
}

pub(super) fn known_object(
    db: &Transaction<'_>,
    spec_hash: &str,
) -> Result<Option<StoredObject>, QueueError> {
    let sql = "SELECT object_key, object_bytes, object_sha256 FROM tasks
        WHERE spec_hash = ?1 AND state = 'done' LIMIT 1";
    let found = db.query_row(sql, [spec_hash], |row| object_of(row, 0));
    Ok(found.optional().stored()?.flatten())
}

pub(super) fn counts(db: &Transaction<'_>) -> Result<Counts, QueueError> {
    let jobs = "SELECT count(*), count(*) - count(finished), coalesce(sum(queued), 0),
        coalesce(sum(leased), 0) FROM jobs";
    let dead = "SELECT count(*) FROM tasks WHERE state = 'dead'";
    let dead_tasks = db.query_row(dead, [], |row| row.get(0)).stored()?;
    let counts = db.query_row(jobs, [], |row| {
        Ok(Counts {
            jobs: row.get(0)?,
            open_jobs: row.get(1)?,
            queued_tasks: row.get(2)?,
            leased_tasks: row.get(3)?,
            dead_tasks,
        })
    });
    counts.stored()
}
