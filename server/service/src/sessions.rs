//! All sessions: a bounded number connected, dropped ones kept for a while.

use std::collections::HashMap;
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use tokio::sync::Notify;
use tokio_util::sync::CancellationToken;
use tyndall_scene::Loaded;
use tyndall_stream::pacing::Accepts;

use crate::bell::{Bell, lock};
use crate::session::Session;
use crate::telemetry;

/// Every connected session is taken.
#[derive(Debug, thiserror::Error)]
#[error("all {limit} sessions are taken")]
pub(crate) struct TooManySessions {
    pub(crate) limit: usize,
}

/// The sessions of this process.
#[derive(Debug)]
pub(crate) struct Sessions {
    by_token: Mutex<HashMap<String, Arc<Session>>>,
    next_id: std::sync::atomic::AtomicU64,
    limit: usize,
    resume_for: Duration,
    dropped: Notify,
    /// Wakes the render thread when some session may want something else.
    pub(crate) bell: Bell,
}

impl Sessions {
    pub(crate) fn new(limit: usize, resume_for: Duration) -> Self {
        Self {
            by_token: Mutex::default(),
            next_id: std::sync::atomic::AtomicU64::new(1),
            limit,
            resume_for,
            dropped: Notify::new(),
            bell: Bell::default(),
        }
    }

    /// Opens a session; the one that was dropped longest ago makes room if needed.
    pub(crate) fn create(
        &self,
        scene: &Loaded,
        accepts: Accepts,
    ) -> Result<Arc<Session>, TooManySessions> {
        let too_many = TooManySessions { limit: self.limit };
        let id = self
            .next_id
            .fetch_add(1, std::sync::atomic::Ordering::Relaxed);
        let Some(token) = random_token() else {
            tracing::error!("the system gives no random numbers; the session is refused");
            return Err(too_many);
        };
        let mut sessions = lock(&self.by_token);
        if sessions.len() >= self.limit {
            let waiting = sessions
                .values()
                .filter_map(|s| Some((s.dropped()?, s.token.clone())));
            let (_, oldest) = waiting.min().ok_or(too_many)?;
            sessions.remove(&oldest);
        }
        let session = Arc::new(Session::new(id, token.clone(), scene, accepts));
        sessions.insert(token, Arc::clone(&session));
        telemetry::sessions(sessions.len());
        Ok(session)
    }

    /// Finds a session to go on with; one that is still connected is taken over.
    pub(crate) fn resume(&self, token: &str, accepts: Accepts) -> Option<(Arc<Session>, u64)> {
        let sessions = lock(&self.by_token);
        let session = Arc::clone(sessions.get(token)?);
        let connection = session.connect(accepts);
        Some((session, connection))
    }

    /// A connection has ended: its session waits to be resumed.
    pub(crate) fn disconnect(&self, session: &Session, connection: u64) {
        if session.disconnect(connection, Instant::now()) {
            self.dropped.notify_one();
            self.bell.ring();
        }
    }

    /// All sessions, in the order they were opened.
    pub(crate) fn list(&self) -> Vec<Arc<Session>> {
        let mut list: Vec<_> = lock(&self.by_token).values().cloned().collect();
        list.sort_unstable_by_key(|session| session.id);
        list
    }

    /// Forgets sessions that nobody resumed in time; sleeps while there are none.
    pub(crate) async fn forget_dropped(&self, shutdown: CancellationToken) {
        loop {
            let next = lock(&self.by_token)
                .values()
                .filter_map(|session| session.dropped())
                .min()
                .map(|dropped| tokio::time::Instant::from_std(dropped + self.resume_for));
            let wait = async {
                match next {
                    Some(next) => tokio::time::sleep_until(next).await,
                    None => std::future::pending().await,
                }
            };
            tokio::select! {
                () = wait => self.forget_expired(Instant::now()),
                () = self.dropped.notified() => {}
                () = shutdown.cancelled() => return,
            }
        }
    }

    fn forget_expired(&self, now: Instant) {
        let mut sessions = lock(&self.by_token);
        sessions.retain(|_, session| {
            session
                .dropped()
                .is_none_or(|at| now.saturating_duration_since(at) < self.resume_for)
        });
        telemetry::sessions(sessions.len());
        drop(sessions);
        // The render thread frees their pictures.
        self.bell.ring();
    }
}

/// 128 random bits in hexadecimal: a name that cannot be guessed.
fn random_token() -> Option<String> {
    use std::fmt::Write as _;
    let mut bytes = [0_u8; 16];
    getrandom::fill(&mut bytes).ok()?;
    let mut token = String::with_capacity(32);
    for byte in bytes {
        write!(token, "{byte:02x}").ok()?;
    }
    Some(token)
}
