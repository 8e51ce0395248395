//! The one thread that owns the device.
//!
//! It compares what each session wants with what it last rendered and starts one frame a session
//! in turn, so that no session starves another. A session with two frames on their way, a hidden
//! page and a converged picture get nothing. With nothing to do it sleeps on a bell and uses no
//! CPU. When the device is lost it opens another one and makes every picture anew.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use tokio_util::sync::CancellationToken;
use tyndall_render::{RenderError, RenderOutcome};
use tyndall_stream::protocol::{Adapter, AdapterKind, ErrorCode, ErrorMessage, ServerMessage};

use crate::backend::{Backend, OpenBackend};
use crate::bell::lock;
use crate::encoder_pool::{EncoderPool, Job};
use crate::options::ServeError;
use crate::session::{Session, Wish};
use crate::sessions::Sessions;
use crate::telemetry;

/// Rest between looks at a device that is still working.
const POLL_EVERY: Duration = Duration::from_millis(1);
/// Pauses before the attempts to open another device; the last one repeats.
const RETRY_AFTER_MILLIS: [u64; 5] = [100, 500, 1000, 3000, 10_000];
/// Errors of the device in a row, outside any session's frame, that count as a loss.
const MAX_DEVICE_ERRORS: u32 = 10;

/// What the threads share with the routes.
#[derive(Debug)]
pub(crate) struct Readiness {
    ready: AtomicBool,
}

impl Readiness {
    pub(crate) fn new() -> Self {
        Self {
            ready: AtomicBool::new(false),
        }
    }

    pub(crate) fn get(&self) -> bool {
        self.ready.load(Ordering::Acquire)
    }

    fn set(&self, ready: bool) {
        self.ready.store(ready, Ordering::Release);
        telemetry::ready(ready);
    }
}

/// Starts the thread and waits until its device is open.
pub(crate) async fn start<B: Backend + 'static>(
    mut open: OpenBackend<B>,
    sessions: Arc<Sessions>,
    encoders: EncoderPool,
    readiness: Arc<Readiness>,
    shutdown: CancellationToken,
) -> Result<(JoinHandle<()>, Adapter), ServeError> {
    let fault = |reason: String| ServeError::Thread {
        name: "render",
        reason,
    };
    let (tell, told) = tokio::sync::oneshot::channel();
    let thread = std::thread::Builder::new()
        .name("render".to_owned())
        .spawn(move || {
            // Whatever ends this thread ends the service: without it there is nothing to serve.
            let _ends_service = shutdown.clone().drop_guard();
            let backend = match open() {
                Ok(backend) => backend,
                Err(error) => {
                    // The starter only goes away together with the process.
                    drop(tell.send(Err(error)));
                    return;
                }
            };
            let adapter = backend.adapter();
            readiness.set(true);
            let software = adapter.kind == AdapterKind::Software;
            if tell.send(Ok(adapter)).is_ok() {
                let seats = Vec::new();
                let device_errors = 0;
                RenderThread {
                    backend: Some(backend),
                    open,
                    sessions,
                    encoders,
                    readiness: Arc::clone(&readiness),
                    shutdown,
                    seats,
                    turn: 0,
                    software,
                    device_errors,
                }
                .run();
            }
            readiness.set(false);
        })
        .map_err(|error| fault(error.to_string()))?;
    match told.await {
        Ok(opened) => Ok((thread, opened?)),
        Err(_closed) => Err(fault("ended while opening the device".to_owned())),
    }
}

/// A session's place at the device.
struct Seat<V> {
    session: Arc<Session>,
    view: Option<V>,
    /// What the view shows.
    shown: Option<Wish>,
    /// The frame on the device.
    rendering: Option<(u32, Wish)>,
    /// Input and epoch of the newest frame that was begun.
    answered: Option<(u64, u32)>,
    /// A wish that the renderer refused; not tried again until it changes.
    refused: Option<Wish>,
}

impl<V> Seat<V> {
    fn new(session: Arc<Session>) -> Self {
        Self {
            session,
            view: None,
            shown: None,
            rendering: None,
            answered: None,
            refused: None,
        }
    }

    /// Forgets everything on the device.
    fn clear(&mut self) {
        self.view = None;
        self.shown = None;
        if let Some((frame_id, _)) = self.rendering.take() {
            lock(&self.session.pacing).discard(frame_id);
        }
    }
}

/// Whether two wishes need the same picture.
fn same_picture(a: &Wish, b: &Wish) -> bool {
    Arc::ptr_eq(&a.scene, &b.scene) && (a.width, a.height) == (b.width, b.height)
}

struct RenderThread<B: Backend> {
    backend: Option<B>,
    open: OpenBackend<B>,
    sessions: Arc<Sessions>,
    encoders: EncoderPool,
    readiness: Arc<Readiness>,
    shutdown: CancellationToken,
    seats: Vec<Seat<B::View>>,
    /// Who is asked first, so that everyone is once.
    turn: usize,
    software: bool,
    device_errors: u32,
}

/// What a look at a session led to.
enum Looked {
    Submitted,
    Nothing,
}

impl<B: Backend> RenderThread<B> {
    fn run(mut self) {
        while !self.shutdown.is_cancelled() {
            if let Err(error) = self.round() {
                self.recover(&error);
            }
        }
        for seat in &mut self.seats {
            seat.clear();
        }
    }

    /// One pass over all sessions; sleeps when there is nothing to do.
    fn round(&mut self) -> Result<(), RenderError> {
        self.seat_sessions();
        let mut submitted = false;
        for offset in 0..self.seats.len() {
            let index = (self.turn + offset) % self.seats.len();
            match self.look(index) {
                Ok(Looked::Submitted) => submitted = true,
                Ok(Looked::Nothing) => {}
                Err(error) => self.refuse(index, error)?,
            }
        }
        self.turn = self.turn.wrapping_add(1) % self.seats.len().max(1);
        let rendering = self.seats.iter().any(|seat| seat.rendering.is_some());
        if !rendering {
            self.rest();
            return Ok(());
        }
        let Some(backend) = &mut self.backend else {
            return Err(RenderError::DeviceLost("no device is open".to_owned()));
        };
        let looked_after = backend.poll();
        self.note(looked_after)?;
        if !self.collect() && !submitted {
            // Frames are on the device: block for the oldest, or rest if that returned nothing.
            let waited = self.backend.as_mut().map_or(Ok(()), Backend::wait);
            self.note(waited)?;
            if !self.collect() {
                self.sessions.bell.wait(Some(Instant::now() + POLL_EVERY));
            }
        }
        Ok(())
    }

    /// Gives new sessions a seat and frees those of sessions that are gone.
    fn seat_sessions(&mut self) {
        let list = self.sessions.list();
        self.seats
            .retain(|seat| list.iter().any(|session| session.id == seat.session.id));
        for session in list {
            if !self.seats.iter().any(|seat| seat.session.id == session.id) {
                self.seats.push(Seat::new(session));
            }
        }
    }

    /// Brings one session's picture up to date and starts a frame if it needs one.
    fn look(&mut self, index: usize) -> Result<Looked, RenderError> {
        let (Some(seat), Some(backend)) = (self.seats.get_mut(index), &mut self.backend) else {
            return Ok(Looked::Nothing);
        };
        let now = Instant::now();
        let wish = seat.session.wish();
        let refused = seat
            .refused
            .as_ref()
            .is_some_and(|refused| same_picture(refused, &wish));
        // One frame on the device at a time: a second one would show an older camera.
        if !wish.watched || refused || seat.rendering.is_some() {
            return Ok(Looked::Nothing);
        }
        let changed = seat
            .shown
            .as_ref()
            .is_none_or(|shown| !same_picture(shown, &wish));
        let finished = seat
            .view
            .as_ref()
            .is_some_and(|view| backend.is_converged(view));
        if finished && !changed && !wish.playing {
            answer_again(seat, &wish, now);
            return Ok(Looked::Nothing);
        }
        if !lock(&seat.session.pacing).is_open(now) {
            return Ok(Looked::Nothing);
        }
        // More samples of what the client has not even fetched would replace it and be work for
        // nothing; a newer input is worth it.
        let current = seat.answered == Some((wish.input, wish.epoch));
        if current && seat.session.outbox.holds_frame() {
            return Ok(Looked::Nothing);
        }
        let wish = if wish.playing {
            seat.session.advance(now)
        } else {
            wish
        };
        update(backend, seat, &wish)?;
        let Some(view) = &mut seat.view else {
            return Ok(Looked::Nothing);
        };
        let Some(frame_id) = lock(&seat.session.pacing).begin(now) else {
            return Ok(Looked::Nothing);
        };
        match backend.render(view, u64::from(frame_id)) {
            Ok(RenderOutcome::Submitted) => {
                seat.answered = Some((wish.input, wish.epoch));
                seat.rendering = Some((frame_id, wish));
                Ok(Looked::Submitted)
            }
            Ok(RenderOutcome::Converged) => {
                lock(&seat.session.pacing).discard(frame_id);
                answer_again(seat, &wish, now);
                Ok(Looked::Nothing)
            }
            Ok(RenderOutcome::Busy) => {
                lock(&seat.session.pacing).discard(frame_id);
                Ok(Looked::Nothing)
            }
            Err(error) => {
                lock(&seat.session.pacing).discard(frame_id);
                Err(error)
            }
        }
    }

    /// Hands finished frames to the encoders; whether there was any.
    fn collect(&mut self) -> bool {
        let Some(backend) = &mut self.backend else {
            return false;
        };
        let mut any = false;
        for seat in &mut self.seats {
            let Some(view) = &mut seat.view else { continue };
            while let Some(frame) = backend.take_finished(view) {
                any = true;
                telemetry::frame_rendered(&frame);
                let ours = |(frame_id, _): &mut (u32, Wish)| u64::from(*frame_id) == frame.tag;
                let Some((frame_id, wish)) = seat.rendering.take_if(ours) else {
                    continue;
                };
                self.encoders.submit(Job {
                    session: Arc::clone(&seat.session),
                    frame,
                    frame_id,
                    wish,
                    software: self.software,
                });
            }
        }
        any
    }

    /// Sleeps until something changes, or a client that stopped acknowledging is due.
    fn rest(&self) {
        let wants = |seat: &&Seat<B::View>| {
            let wish = seat.session.wish();
            let changed = seat
                .shown
                .as_ref()
                .is_none_or(|shown| !same_picture(shown, &wish));
            let refused = seat
                .refused
                .as_ref()
                .is_some_and(|r| same_picture(r, &wish));
            let finished = match (&self.backend, &seat.view) {
                (Some(backend), Some(view)) => backend.is_converged(view),
                _ => false,
            };
            wish.watched && !refused && (changed || !finished || wish.playing)
        };
        let due = self.seats.iter().filter(wants);
        let deadline = due
            .filter_map(|seat| lock(&seat.session.pacing).next_deadline())
            .min();
        self.sessions.bell.wait(deadline);
    }

    /// Tells the session that its picture cannot be rendered; passes a lost device on.
    fn refuse(&mut self, index: usize, error: RenderError) -> Result<(), RenderError> {
        if is_loss(&error) {
            return Err(error);
        }
        let Some(seat) = self.seats.get_mut(index) else {
            return Ok(());
        };
        telemetry::render_error();
        tracing::error!(session = seat.session.id, %error, "a picture was refused");
        let wish = seat.session.wish();
        let input = Some(wish.input);
        seat.clear();
        seat.refused = Some(wish);
        tell(&seat.session, error.to_string(), input);
        Ok(())
    }

    /// Counts errors that belong to no session; too many in a row count as a loss.
    fn note(&mut self, result: Result<(), RenderError>) -> Result<(), RenderError> {
        match result {
            Ok(()) => self.device_errors = 0,
            Err(error) if is_loss(&error) || self.device_errors >= MAX_DEVICE_ERRORS => {
                return Err(error);
            }
            Err(error) => {
                self.device_errors += 1;
                telemetry::render_error();
                tracing::error!(%error, "the device reported an error");
            }
        }
        Ok(())
    }

    /// Opens another device after the old one was lost; returns when one works or on shutdown.
    fn recover(&mut self, error: &RenderError) {
        self.readiness.set(false);
        telemetry::device_lost();
        tracing::error!(%error, "the device is lost, opening another");
        for seat in &mut self.seats {
            seat.clear();
            seat.refused = None;
            tell(&seat.session, error.to_string(), None);
        }
        self.backend = None;
        self.device_errors = 0;
        for attempt in 0.. {
            let last = RETRY_AFTER_MILLIS.len() - 1;
            let pause = Duration::from_millis(RETRY_AFTER_MILLIS[last.min(attempt)]);
            let until = Instant::now() + pause;
            while Instant::now() < until {
                self.sessions.bell.wait(Some(until));
                if self.shutdown.is_cancelled() {
                    return;
                }
            }
            match (self.open)() {
                Ok(backend) => {
                    let adapter = backend.adapter();
                    tracing::info!(adapter = adapter.name, "another device is open");
                    self.software = adapter.kind == AdapterKind::Software;
                    self.backend = Some(backend);
                    self.readiness.set(true);
                    return;
                }
                Err(error) => tracing::error!(%error, attempt, "no device could be opened"),
            }
        }
    }
}

/// Sends the last picture again when it is finished and answers a newer input or connection too:
/// an input that changed nothing still gets its answer, a resumed page its picture.
fn answer_again<V>(seat: &mut Seat<V>, wish: &Wish, now: Instant) {
    let mut pacing = lock(&seat.session.pacing);
    // While frames are on their way an encoder may hold a newer picture than the last one.
    if seat.answered == Some((wish.input, wish.epoch)) || pacing.in_flight() > 0 {
        return;
    }
    let Some(last) = seat.session.outbox.last_frame() else {
        return;
    };
    let Some(frame_id) = pacing.begin(now) else {
        return;
    };
    match last.renumbered(frame_id, wish.epoch, wish.input) {
        Some(frame) => {
            seat.answered = Some((wish.input, wish.epoch));
            // Nothing was on its way, so nothing waits to be replaced.
            drop(seat.session.outbox.set_frame(frame));
        }
        None => pacing.discard(frame_id),
    }
}

/// Makes the seat's view show the wish.
fn update<B: Backend>(
    backend: &mut B,
    seat: &mut Seat<B::View>,
    wish: &Wish,
) -> Result<(), RenderError> {
    let view = if let (Some(view), Some(shown)) = (&mut seat.view, &seat.shown) {
        if (shown.width, shown.height) != (wish.width, wish.height) {
            backend.resize_view(view, wish.width, wish.height)?;
        }
        if !Arc::ptr_eq(&shown.scene, &wish.scene) {
            backend.update_view(view, Arc::clone(&wish.scene))?;
        }
        view
    } else {
        let view = backend.create_view(Arc::clone(&wish.scene), wish.width, wish.height)?;
        seat.view.insert(view)
    };
    seat.session.outbox.set_plan(backend.plan(view));
    seat.shown = Some(wish.clone());
    seat.refused = None;
    Ok(())
}

/// Whether only another device helps.
fn is_loss(error: &RenderError) -> bool {
    matches!(
        error,
        RenderError::DeviceLost(_) | RenderError::Timeout { .. }
    )
}

fn tell(session: &Session, message: String, input: Option<u64>) {
    let code = ErrorCode::RenderFailed;
    session.outbox.push(ServerMessage::Error(ErrorMessage {
        code,
        path: None,
        message,
        input,
    }));
}
