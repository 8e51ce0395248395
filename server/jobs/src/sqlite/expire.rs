//! Forgetting jobs that are over, and the results that only they had.

use rusqlite::{Transaction, params};

use super::Stored as _;
use crate::id::JobId;
use crate::queue::{Millis, QueueError};
use crate::state::StoredObject;

pub(super) fn expire(
    db: &Transaction<'_>,
    before: Millis,
    most: u32,
) -> Result<(Vec<JobId>, Vec<StoredObject>), QueueError> {
    // A cancelled job's task may still be on a device.
    let sql =
        "SELECT seq, id FROM jobs WHERE finished < ?1 AND leased = 0 ORDER BY finished LIMIT ?2";
    let mut statement = db.prepare(sql).stored()?;
    let rows = statement.query_map(params![before, most], |row| {
        Ok((row.get::<_, i64>(0)?, row.get::<_, String>(1)?))
    });
    let over: Vec<(i64, String)> = rows.stored()?.collect::<rusqlite::Result<_>>().stored()?;
    let (mut jobs, mut objects) = (Vec::new(), Vec::new());
    for (seq, id) in over {
        let sql = "SELECT DISTINCT object_key, object_bytes, object_sha256 FROM tasks AS own
            WHERE job = ?1 AND object_key IS NOT NULL AND NOT EXISTS
                (SELECT 1 FROM tasks WHERE object_key = own.object_key AND job <> ?1)";
        let mut statement = db.prepare(sql).stored()?;
        let rows = statement.query_map([seq], |row| {
            Ok(StoredObject {
                key: row.get(0)?,
                bytes: row.get(1)?,
                sha256: row.get(2)?,
            })
        });
        objects.extend(
            rows.stored()?
                .collect::<rusqlite::Result<Vec<_>>>()
                .stored()?,
        );
        db.execute("DELETE FROM tasks WHERE job = ?1", [seq])
            .stored()?;
        db.execute("DELETE FROM jobs WHERE seq = ?1", [seq])
            .stored()?;
        jobs.extend(id.parse::<JobId>());
    }
    Ok((jobs, objects))
}
