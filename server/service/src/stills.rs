//! The desk between those who want stills and the render thread, which makes them in slices.
//!
//! Nothing waits here for long: a still is ordered only when a worker has a place for it, so there are never
//! more orders than workers.

use std::collections::VecDeque;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};

use tokio::sync::{Notify, oneshot};
use tyndall_scene::Scene;
use tyndall_still::Progress;
use tyndall_stream::protocol::Adapter;

use crate::bell::lock;
use crate::sessions::Sessions;

/// A still that somebody wants.
pub(crate) struct StillOrder {
    pub(crate) scene: Arc<Scene>,
    /// Share of the device beside other stills.
    pub(crate) weight: f64,
    pub(crate) watch: Arc<StillWatch>,
    pub(crate) reply: oneshot::Sender<Result<StillReply, StillFailure>>,
}

/// A still that was made.
#[derive(Debug)]
pub(crate) struct StillReply {
    /// `None` where it was stopped before anything was begun.
    pub(crate) still: Option<tyndall_render::Still>,
    pub(crate) adapter: Adapter,
}

/// Why a still was not made.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub(crate) enum StillFailure {
    /// The scene cannot be rendered.
    #[error("{0}")]
    Refused(String),
    /// Another attempt may succeed.
    #[error("{0}")]
    Passing(String),
    /// Its work was on the device when that was lost.
    #[error("{0}")]
    DeviceLost(String),
    /// The device went away without its fault.
    #[error("the render thread gave it up")]
    Interrupted,
}

/// What the render thread and those who wait know of a still in the making.
#[derive(Debug, Default)]
pub(crate) struct StillWatch {
    stop: AtomicBool,
    progress: Mutex<Progress>,
    shown_wanted: AtomicBool,
    shown: Mutex<Option<Shown>>,
    showed: Notify,
}

/// The displayed picture of a still in the making.
#[derive(Debug, Clone)]
pub(crate) struct Shown {
    /// Unit: pixel.
    pub(crate) width: u32,
    /// Unit: pixel.
    pub(crate) height: u32,
    pub(crate) rgba: Vec<u8>,
}

impl StillWatch {
    /// Asks for an end: the still is read as it is.
    pub(crate) fn stop(&self) {
        self.stop.store(true, Ordering::Release);
    }

    pub(crate) fn is_stopped(&self) -> bool {
        self.stop.load(Ordering::Acquire)
    }

    /// How far it is.
    pub(crate) fn progress(&self) -> Progress {
        *lock(&self.progress)
    }

    pub(crate) fn set_progress(&self, progress: Progress) {
        *lock(&self.progress) = progress;
    }

    /// The picture at present; waits for the next frame. Whoever asks sets a time limit.
    pub(crate) async fn shown(&self) -> Shown {
        loop {
            let showed = self.showed.notified();
            self.shown_wanted.store(true, Ordering::Release);
            showed.await;
            if let Some(shown) = lock(&self.shown).clone() {
                return shown;
            }
        }
    }

    /// Whether somebody waits for a picture; asked again it says no.
    pub(crate) fn take_shown_wanted(&self) -> bool {
        self.shown_wanted.swap(false, Ordering::AcqRel)
    }

    pub(crate) fn show(&self, shown: Shown) {
        *lock(&self.shown) = Some(shown);
        self.showed.notify_waiters();
    }
}

/// Where orders lie until the render thread takes them.
pub(crate) struct Desk {
    /// `None` once nobody takes them any more.
    orders: Mutex<Option<VecDeque<StillOrder>>>,
    sessions: Arc<Sessions>,
}

impl std::fmt::Debug for Desk {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let waiting = lock(&self.orders).as_ref().map(VecDeque::len);
        f.debug_struct("Desk")
            .field("waiting", &waiting)
            .finish_non_exhaustive()
    }
}

impl Desk {
    pub(crate) fn new(sessions: Arc<Sessions>) -> Self {
        Self {
            orders: Mutex::new(Some(VecDeque::new())),
            sessions,
        }
    }

    /// Orders a still; what becomes of it is told by the receiver, which ends without a word where the
    /// render thread does.
    pub(crate) fn order(
        &self,
        scene: Arc<Scene>,
        weight: f64,
        watch: Arc<StillWatch>,
    ) -> oneshot::Receiver<Result<StillReply, StillFailure>> {
        let (reply, receiver) = oneshot::channel();
        if let Some(orders) = lock(&self.orders).as_mut() {
            orders.push_back(StillOrder {
                scene,
                weight,
                watch,
                reply,
            });
        }
        self.wake();
        receiver
    }

    /// Lets the render thread look at once, after a stop too.
    pub(crate) fn wake(&self) {
        self.sessions.bell.ring();
    }

    /// The order that has waited longest.
    pub(crate) fn take(&self) -> Option<StillOrder> {
        lock(&self.orders).as_mut()?.pop_front()
    }

    /// The render thread ends: what lies here, and what is still ordered, is never made.
    pub(crate) fn close(&self) {
        *lock(&self.orders) = None;
    }
}
