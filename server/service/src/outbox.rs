//! What waits for a session's socket: messages in order, and the newest stop, plan and frame.

use std::collections::VecDeque;
use std::sync::Mutex;

use axum::body::Bytes;
use tokio::sync::Notify;
use tyndall_stream::header::{FrameHeader, HEADER_BYTES};
use tyndall_stream::protocol::{CameraMessage, Plan, PlanMessage, ServerMessage, Stats};

use crate::bell::lock;

/// Messages that may wait; a client that causes more without reading them is cut off.
const MAX_WAITING: usize = 64;

/// A frame ready to be sent.
#[derive(Debug, Clone)]
pub(crate) struct EncodedFrame {
    pub(crate) header: FrameHeader,
    /// Header and payload.
    pub(crate) message: Bytes,
    pub(crate) stats: Stats,
}

impl EncodedFrame {
    /// The same picture under another number, as the answer to another input.
    pub(crate) fn renumbered(&self, frame_id: u32, epoch: u32, input: u64) -> Option<Self> {
        let header = FrameHeader {
            frame_id,
            session_epoch: epoch,
            applied_input: input,
            render_micros: 0,
            encode_micros: 0,
            ..self.header
        };
        let mut message = self.message.to_vec();
        message
            .get_mut(..HEADER_BYTES)?
            .copy_from_slice(&header.encode().ok()?);
        let stats = Stats {
            frame: frame_id,
            ..self.stats.clone()
        };
        Some(Self {
            header,
            message: message.into(),
            stats,
        })
    }
}

/// The next thing to send.
#[derive(Debug)]
pub(crate) enum Outgoing {
    Message(ServerMessage),
    Frame(EncodedFrame),
}

/// Slots between render, encoder and socket.
#[derive(Debug)]
pub(crate) struct Outbox {
    slots: Mutex<Slots>,
    filled: Notify,
}

#[derive(Debug, Default)]
struct Slots {
    /// Number of the connection that may take something.
    owner: u64,
    messages: VecDeque<ServerMessage>,
    camera: Option<CameraMessage>,
    plan: Option<Plan>,
    plan_is_new: bool,
    frame: Option<EncodedFrame>,
    last_frame: Option<EncodedFrame>,
}

impl Outbox {
    /// An empty outbox of a connection.
    pub(crate) fn new(owner: u64) -> Self {
        let slots = Slots {
            owner,
            ..Slots::default()
        };
        Self {
            slots: Mutex::new(slots),
            filled: Notify::new(),
        }
    }

    /// Queues a message; false when too many wait already, and then it is not queued.
    pub(crate) fn push(&self, message: ServerMessage) -> bool {
        let mut slots = lock(&self.slots);
        let room = slots.messages.len() < MAX_WAITING;
        if room {
            slots.messages.push_back(message);
        }
        drop(slots);
        self.tell();
        room
    }

    /// Replaces the camera at which a surface stopped the eye: only the newest stop matters.
    pub(crate) fn set_camera(&self, camera: CameraMessage) {
        lock(&self.slots).camera = Some(camera);
        self.filled.notify_one();
    }

    /// Replaces the plan; an equal one is not sent again.
    pub(crate) fn set_plan(&self, plan: Plan) {
        let mut slots = lock(&self.slots);
        if slots.plan.as_ref() == Some(&plan) {
            return;
        }
        slots.plan = Some(plan);
        slots.plan_is_new = true;
        drop(slots);
        self.tell();
    }

    /// Replaces the waiting frame and returns the one that was never sent.
    pub(crate) fn set_frame(&self, frame: EncodedFrame) -> Option<EncodedFrame> {
        let mut slots = lock(&self.slots);
        slots.last_frame = Some(frame.clone());
        let unsent = slots.frame.replace(frame);
        drop(slots);
        self.tell();
        unsent
    }

    /// Whether a frame waits to be sent.
    pub(crate) fn holds_frame(&self) -> bool {
        lock(&self.slots).frame.is_some()
    }

    /// The newest frame there was, sent or not.
    pub(crate) fn last_frame(&self) -> Option<EncodedFrame> {
        lock(&self.slots).last_frame.clone()
    }

    /// Belongs to another connection from now on: nothing of the old one waits, the plan is sent again, and
    /// what comes is not taken by the old one, which may not have noticed yet.
    pub(crate) fn reconnect(&self, owner: u64) {
        let mut slots = lock(&self.slots);
        slots.owner = owner;
        slots.messages.clear();
        slots.camera = None;
        slots.frame = None;
        slots.plan_is_new = slots.plan.is_some();
    }

    /// The next thing for a connection. Messages first, since they explain the frames behind them.
    pub(crate) fn take(&self, connection: u64) -> Option<Outgoing> {
        let mut slots = lock(&self.slots);
        if slots.owner != connection {
            return None;
        }
        if let Some(message) = slots.messages.pop_front() {
            return Some(Outgoing::Message(message));
        }
        if let Some(camera) = slots.camera.take() {
            return Some(Outgoing::Message(ServerMessage::Camera(camera)));
        }
        if std::mem::take(&mut slots.plan_is_new)
            && let Some(plan) = slots.plan.clone()
        {
            return Some(Outgoing::Message(ServerMessage::Plan(PlanMessage { plan })));
        }
        slots.frame.take().map(Outgoing::Frame)
    }

    /// Wakes whoever waits, two connections for a moment, or the next one to wait.
    fn tell(&self) {
        self.filled.notify_waiters();
        self.filled.notify_one();
    }

    /// Waits until something may be there.
    pub(crate) async fn filled(&self) {
        self.filled.notified().await;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_connection_that_owns_it_takes_something() {
        use tyndall_stream::protocol::Notice;
        let outbox = Outbox::new(1);
        let notice = || {
            let message = "new".to_owned();
            ServerMessage::Notice(Notice { message })
        };
        assert!(outbox.push(notice()));
        outbox.reconnect(2);
        assert!(
            outbox.take(2).is_none(),
            "what the old one was to get is gone"
        );
        assert!(outbox.push(notice()));
        assert!(outbox.take(1).is_none());
        assert!(outbox.take(2).is_some());
    }
}
