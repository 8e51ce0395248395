//! `GET /v1/jobs/{id}/events`: how a job stands, as server-sent events.
//!
//! Each event is the whole status, so who missed some has missed nothing: the newest counts. An event after
//! a change of state has the revision as its id; with that as `Last-Event-ID` the stream goes on from there.
//! After the last event of a job that is over, the stream ends; asked again, the answer is 204.

use std::sync::Arc;
use std::time::Duration;

use axum::extract::{Path, State};
use axum::http::{HeaderMap, StatusCode};
use axum::response::sse::{Event, KeepAlive, Sse};
use axum::response::{IntoResponse as _, Response};
use futures_util::stream;
use tokio::sync::watch;
use tyndall_jobs::JobId;

use super::job_id;
use crate::jobs::JobStatus;
use crate::problem::Problem;
use crate::server::App;

/// How often progress is told.
const PROGRESS_EVERY: Duration = Duration::from_millis(250);
/// How often a silent stream shows that it lives.
const ALIVE_EVERY: Duration = Duration::from_secs(10);

/// A client that listens.
struct Listener {
    app: Arc<App>,
    id: JobId,
    changes: watch::Receiver<u64>,
    /// The status that was told last, or its revision.
    told: Option<JobStatus>,
    revision: u64,
    over: bool,
}

/// Tells how a job stands until it is over.
pub(super) async fn stream(
    State(app): State<Arc<App>>,
    Path(id): Path<String>,
    headers: HeaderMap,
) -> Result<Response, Problem> {
    let id = job_id(&id)?;
    let changes = app.jobs.queue.changes();
    let status = app.jobs.status(&id).await?;
    let last = headers.get("last-event-id");
    let last = last.and_then(|last| last.to_str().ok()?.parse::<u64>().ok());
    if status.state.is_over() && last == Some(status.revision) {
        return Ok(StatusCode::NO_CONTENT.into_response());
    }
    let listener = Listener {
        app,
        id,
        changes,
        told: None,
        revision: last.unwrap_or(0),
        over: false,
    };
    let events = stream::unfold(listener, |mut listener| async move {
        let event = listener.next().await?;
        Some((Ok::<_, std::convert::Infallible>(event), listener))
    });
    let alive = KeepAlive::new().interval(ALIVE_EVERY);
    Ok(Sse::new(events).keep_alive(alive).into_response())
}

impl Listener {
    /// The next event; `None` after the last one.
    async fn next(&mut self) -> Option<Event> {
        loop {
            if self.over || self.app.shutdown.is_cancelled() {
                return None;
            }
            self.changes.mark_unchanged();
            // A job that is forgotten, or a queue that fails: the client asks again and is told.
            let status = self.app.jobs.status(&self.id).await.ok()?;
            self.over = status.state.is_over();
            let changed = status.revision != self.revision;
            let moved = self.told.as_ref().is_none_or(|told| {
                told.fraction != status.fraction || told.samples != status.samples
            });
            if changed || moved {
                let mut event = Event::default().event("status").json_data(&status).ok()?;
                if changed {
                    event = event.id(status.revision.to_string());
                }
                self.revision = status.revision;
                self.told = Some(status);
                return Some(event);
            }
            if self.over {
                return None;
            }
            let shutdown = self.app.shutdown.clone();
            tokio::select! {
                _changed = self.changes.changed() => {}
                () = tokio::time::sleep(PROGRESS_EVERY) => {}
                () = shutdown.cancelled() => {}
            }
        }
    }
}
