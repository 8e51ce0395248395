//! Tables of the queue.

use rusqlite::Connection;

use super::Stored as _;
use crate::queue::QueueError;

/// Version of the tables, in the file's header.
const VERSION: i64 = 1;

/// `queued` and `leased` count a job's tasks in these states, so that the next task is found without
/// looking at all of them.
const TABLES: &str = "
    CREATE TABLE jobs (
        seq INTEGER PRIMARY KEY,
        id TEXT NOT NULL UNIQUE,
        state TEXT NOT NULL,
        request TEXT NOT NULL,
        request_hash TEXT NOT NULL,
        idempotency_key TEXT UNIQUE,
        priority INTEGER NOT NULL,
        created INTEGER NOT NULL,
        started INTEGER,
        finished INTEGER,
        revision INTEGER NOT NULL,
        tasks INTEGER NOT NULL,
        done INTEGER NOT NULL,
        queued INTEGER NOT NULL,
        leased INTEGER NOT NULL,
        error TEXT
    ) STRICT;
    CREATE INDEX jobs_open ON jobs (priority DESC, leased, seq) WHERE queued > 0;
    CREATE INDEX jobs_over ON jobs (finished) WHERE finished IS NOT NULL;
    CREATE TABLE tasks (
        job INTEGER NOT NULL REFERENCES jobs (seq),
        number INTEGER NOT NULL,
        kind TEXT NOT NULL,
        spec_hash TEXT NOT NULL,
        state TEXT NOT NULL,
        attempt INTEGER NOT NULL,
        failures INTEGER NOT NULL,
        losses INTEGER NOT NULL,
        not_before INTEGER NOT NULL,
        worker TEXT,
        lease_until INTEGER,
        object_key TEXT,
        object_bytes INTEGER,
        object_sha256 TEXT,
        error TEXT,
        PRIMARY KEY (job, number)
    ) STRICT, WITHOUT ROWID;
    CREATE INDEX tasks_by_state ON tasks (job, state, number);
    CREATE INDEX tasks_leased ON tasks (lease_until) WHERE state = 'leased';
    CREATE INDEX tasks_by_spec ON tasks (spec_hash) WHERE state = 'done';
    CREATE INDEX tasks_by_object ON tasks (object_key) WHERE object_key IS NOT NULL;
";

/// Makes the tables of a new file, and checks those of an old one.
pub(super) fn prepare(connection: &Connection) -> Result<(), QueueError> {
    connection
        .execute_batch(
            "PRAGMA journal_mode = WAL; PRAGMA synchronous = FULL; PRAGMA foreign_keys = ON;",
        )
        .stored()?;
    let version = || connection.query_row("PRAGMA user_version", [], |row| row.get::<_, i64>(0));
    match version().stored()? {
        VERSION => Ok(()),
        0 => connection
            .execute_batch(&format!(
                "BEGIN IMMEDIATE; {TABLES} PRAGMA user_version = {VERSION}; COMMIT;"
            ))
            .stored(),
        found => Err(QueueError::Storage(format!(
            "its tables have version {found}, this program knows {VERSION}"
        ))),
    }
}
