//! The loop of the render thread: who gets the next frame, what has come back, when to sleep.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::time::{Duration, Instant};

use tokio_util::sync::CancellationToken;
use tyndall_render::{Prepared, RenderError, RenderOutcome};

use super::effort::Effort;
use super::readiness::Readiness;
use super::refusal::{Loss, is_loss, refuse, unread};
use super::seat::{Flight, Seat};
use super::show::{show, show_meanwhile};
use super::stills::Stills;
use crate::backend::{Backend, OpenBackend};
use crate::bell::lock;
use crate::encoder_pool::{EncoderPool, Job};
use crate::sessions::Sessions;
use crate::telemetry;

/// Rest between looks at what is still being worked on.
const POLL_EVERY: Duration = Duration::from_millis(1);

/// What a frame of a moving picture takes.
const GPU_BUDGET: Duration = Duration::from_millis(33);
const SOFTWARE_BUDGET: Duration = Duration::from_millis(100);
/// What the dispatches of a frame take by themselves. Unit: s.
const GPU_FRAME: f64 = 5e-4;
const SOFTWARE_FRAME: f64 = 0.02;
/// What a pixel may take before any was measured. Unit: s.
const GPU_PIXEL: f64 = 5e-9;
const SOFTWARE_PIXEL: f64 = 1.5e-6;

/// Everything the thread owns.
pub(super) struct RenderThread<B: Backend> {
    /// `None` while no device is open.
    pub(super) backend: Option<B>,
    pub(super) open: OpenBackend<B>,
    pub(super) sessions: Arc<Sessions>,
    pub(super) encoders: EncoderPool,
    pub(super) readiness: Arc<Readiness>,
    pub(super) shutdown: CancellationToken,
    pub(super) seats: Vec<Seat<B::View>>,
    /// Pictures of jobs.
    pub(super) stills: Stills<B::Still>,
    /// Who is asked first, so that everyone is once.
    pub(super) turn: usize,
    pub(super) software: bool,
    /// What a frame of a moving picture may take; by the kind of device without one.
    pub(super) frame_budget: Option<Duration>,
    pub(super) device_errors: u32,
    /// The session whose picture the renderer is asked for right now.
    pub(super) working_for: Option<u64>,
}

impl<B: Backend> RenderThread<B> {
    pub(super) fn run(mut self) {
        while !self.shutdown.is_cancelled() {
            // What a panic leaves behind is not used again: another device is opened, every picture begun
            // anew.
            let loss = match catch_unwind(AssertUnwindSafe(|| self.round())) {
                Ok(Ok(())) => continue,
                Ok(Err(loss)) => loss,
                Err(panic) => self.panicked(panic.as_ref()),
            };
            self.recover(&loss);
        }
        self.stills.clear();
        for seat in &mut self.seats {
            seat.clear();
        }
    }

    /// One pass over all sessions; sleeps when there is nothing to do.
    fn round(&mut self) -> Result<(), Loss> {
        self.seat_sessions();
        let submitted = self.begin_frames()?;
        self.turn = self.turn.wrapping_add(1) % self.seats.len().max(1);
        let worked = self.work_on_stills()?;
        if !self.is_busy() && !self.stills.are_there() {
            self.rest();
            return Ok(());
        }
        let Some(backend) = &mut self.backend else {
            let error = RenderError::DeviceLost("no device is open".to_owned());
            return Err(Loss::of_nobody(error));
        };
        let looked_after = backend.poll();
        self.note(looked_after)?;
        self.go_on()?;
        if !self.collect() && !submitted && !worked {
            // Frames are on the device: block for the oldest, or rest if that returned nothing.
            let waited = self.wait_for_oldest();
            self.note(waited)?;
            let sliced = !self.is_busy() && self.wait_for_slice().map_err(Loss::of_nobody)?;
            if !self.collect() && !sliced {
                self.sessions.bell.wait(Some(Instant::now() + POLL_EVERY));
            }
        }
        Ok(())
    }

    /// Gives new sessions a seat and frees those of sessions that are gone.
    fn seat_sessions(&mut self) {
        let list = self.sessions.list();
        let before = self.seats.len();
        self.seats
            .retain(|seat| list.iter().any(|session| session.id == seat.session.id));
        if self.seats.len() < before {
            // There is memory again: pictures may grow.
            for seat in &mut self.seats {
                seat.fit = None;
            }
        }
        for session in list {
            if !self.seats.iter().any(|seat| seat.session.id == session.id) {
                let effort = self.effort();
                self.seats.push(Seat::new(session, effort));
            }
        }
        let is_alone = self.seats.len() == 1;
        for seat in &mut self.seats {
            let wish = seat.session.wish();
            seat.forget_other_wishes(&wish);
            seat.is_alone = is_alone;
        }
    }

    /// What a picture may cost of which nothing is known yet.
    fn effort(&self) -> Effort {
        let (fixed, per_pixel) = if self.software {
            (SOFTWARE_FRAME, SOFTWARE_PIXEL)
        } else {
            (GPU_FRAME, GPU_PIXEL)
        };
        Effort::new(self.moving_budget(), fixed, per_pixel)
    }

    /// What a frame of a moving picture may take.
    pub(super) fn moving_budget(&self) -> Duration {
        let usual = if self.software {
            SOFTWARE_BUDGET
        } else {
            GPU_BUDGET
        };
        self.frame_budget.unwrap_or(usual)
    }

    /// Whether frames of sessions are on the device.
    pub(super) fn is_busy(&self) -> bool {
        self.seats.iter().any(|seat| seat.flight.is_some())
    }

    /// Starts one frame for each session that needs one; whether there was any.
    fn begin_frames(&mut self) -> Result<bool, Loss> {
        let suspect = self.next_suspect(Instant::now());
        let is_alone = |seat: &Seat<B::View>| seat.suspect.is_some() && seat.flight.is_some();
        let shared = self.is_busy() || self.stills.is_on_device();
        if shared && (suspect.is_some() || self.seats.iter().any(is_alone)) {
            return Ok(false);
        }
        if let Some(index) = suspect
            && self.begin_frame(index)?
        {
            return Ok(true);
        }
        let mut any = false;
        for offset in 0..self.seats.len() {
            let index = (self.turn + offset) % self.seats.len();
            if self.seats[index].suspect.is_none() {
                any |= self.begin_frame(index)?;
            }
        }
        Ok(any)
    }

    /// [`Self::look`], after which a session whose picture cannot be made knows it.
    fn begin_frame(&mut self, index: usize) -> Result<bool, Loss> {
        self.working_for = self.seats.get(index).map(|seat| seat.session.id);
        let looked = self.look(index);
        self.working_for = None;
        let error = match looked {
            Ok(submitted) => return Ok(submitted),
            Err(error) => error,
        };
        let seat = &mut self.seats[index];
        if is_loss(&error) {
            let caller = Some(seat.session.id);
            return Err(Loss { error, caller });
        }
        if let Some(wish) = seat.asked.take() {
            refuse(seat, wish, error.to_string());
        }
        Ok(false)
    }

    /// Brings one session's picture up to date and starts a frame if it needs one; whether it did.
    fn look(&mut self, index: usize) -> Result<bool, RenderError> {
        let (Some(seat), Some(backend)) = (self.seats.get_mut(index), &mut self.backend) else {
            return Ok(false);
        };
        let now = Instant::now();
        let wish = seat.session.wish();
        // A long frame of a picture at rest makes room for a picture that starts anew; what only shows it
        // in another way waits, as dropped samples would count twice.
        if seat.flight.as_ref().is_some_and(|flight| !flight.moving)
            && seat.starts_anew(&wish)
            && let Some(picture) = &mut seat.picture
            && backend.abandon(&mut picture.view)
            && let Some(flight) = seat.flight.take()
        {
            lock(&seat.session.pacing).discard(flight.frame_id);
        }
        // One frame on the device at a time: a second one would show an older camera.
        if !wish.watched || seat.refuses(&wish) || seat.flight.is_some() {
            return Ok(false);
        }
        seat.effort.climb(now);
        if is_finished(backend, seat) && !seat.has_changed(&wish) && !wish.playing {
            seat.answer_again(&wish, now);
            return Ok(false);
        }
        if !seat.may_begin(now) {
            return Ok(false);
        }
        // More samples of what the client has not even fetched would replace it and be work for
        // nothing; a newer input is worth it.
        let current = seat.answered == Some((wish.input, wish.epoch));
        if current && seat.session.outbox.holds_frame() {
            return Ok(false);
        }
        // Time stands still while its picture is being prepared or tried alone.
        let stands = seat.preparing || seat.suspect.is_some();
        let wish = if wish.playing && !stands {
            seat.session.advance(now)
        } else {
            wish
        };
        seat.asked = Some(wish.clone());
        if seat.shows_another(&wish) {
            seat.effort.change(now);
        }
        let wish = match show(backend, seat, &wish)? {
            Prepared::Ready => wish,
            Prepared::Pending => {
                let Some(shown) = show_meanwhile(backend, seat, &wish)? else {
                    return Ok(false);
                };
                if is_finished(backend, seat) || seat.session.outbox.holds_frame() {
                    return Ok(false);
                }
                shown
            }
        };
        let Some(picture) = &mut seat.picture else {
            return Ok(false);
        };
        let Some(frame_id) = lock(&seat.session.pacing).begin(now) else {
            return Ok(false);
        };
        seat.starting = Some(frame_id);
        let outcome = backend.render(&mut picture.view, u64::from(frame_id));
        seat.starting = None;
        if !matches!(outcome, Ok(RenderOutcome::Submitted)) {
            lock(&seat.session.pacing).discard(frame_id);
        }
        match outcome? {
            RenderOutcome::Submitted => {
                seat.answered = Some((wish.input, wish.epoch));
                seat.flight = Some(Flight {
                    frame_id,
                    wish,
                    began: now,
                    moving: seat.effort.is_moving(),
                });
                Ok(true)
            }
            RenderOutcome::Converged => {
                seat.answer_again(&wish, now);
                Ok(false)
            }
            RenderOutcome::Busy => Ok(false),
        }
    }

    /// Submits the next parts of frames that are submitted in parts.
    fn go_on(&mut self) -> Result<(), Loss> {
        let Some(backend) = &mut self.backend else {
            return Ok(());
        };
        for seat in &mut self.seats {
            if seat.flight.is_some()
                && let Some(picture) = &mut seat.picture
                && let Err(error) = backend.go_on(&mut picture.view)
            {
                let caller = Some(seat.session.id);
                return Err(Loss { error, caller });
            }
        }
        Ok(())
    }

    /// Blocks until the frame that was begun first is finished, and no longer.
    fn wait_for_oldest(&mut self) -> Result<(), RenderError> {
        let flights = self.seats.iter().filter_map(|seat| {
            let (flight, picture) = (seat.flight.as_ref()?, seat.picture.as_ref()?);
            Some((flight.began, &picture.view))
        });
        let oldest = flights.min_by_key(|(began, _)| *began);
        match (&mut self.backend, oldest) {
            (Some(backend), Some((_, view))) => backend.wait_for(view),
            _ => Ok(()),
        }
    }

    /// Hands finished frames to the encoders; whether any frame has come back.
    fn collect(&mut self) -> bool {
        let Some(backend) = &mut self.backend else {
            return false;
        };
        let mut any = false;
        for seat in &mut self.seats {
            let mut take = |seat: &mut Seat<B::View>| {
                let picture = seat.picture.as_mut()?;
                backend.take_finished(&mut picture.view)
            };
            while let Some(taken) = take(seat) {
                any = true;
                let mut frame = match taken {
                    Ok(frame) => frame,
                    Err(failed) => {
                        unread(seat, &failed);
                        continue;
                    }
                };
                telemetry::frame_rendered(&frame);
                self.stills.follow();
                let ours = |flight: &mut Flight| u64::from(flight.frame_id) == frame.tag;
                let Some(flight) = seat.flight.take_if(ours) else {
                    continue;
                };
                seat.unread = None;
                let full = seat.full_size(&flight.wish);
                seat.effort.measured(&frame, full);
                // A picture is finished in its full size.
                frame.converged &= (frame.width, frame.height) == full;
                seat.tried = seat.suspect.take().or(seat.tried.take());
                self.encoders.submit(Job {
                    session: Arc::clone(&seat.session),
                    frame,
                    frame_id: flight.frame_id,
                    wish: flight.wish,
                    software: self.software,
                });
            }
        }
        any
    }

    /// Whether the session's picture is not what it should be yet.
    pub(super) fn wants_frame(&self, seat: &Seat<B::View>) -> bool {
        let wish = seat.session.wish();
        let finished = self
            .backend
            .as_ref()
            .is_some_and(|backend| is_finished(backend, seat));
        wish.watched
            && !seat.refuses(&wish)
            && (seat.has_changed(&wish) || !finished || wish.playing)
    }

    /// Sleeps until something changes, a client that stopped acknowledging is due, or it is time to
    /// ask again for what is being prepared.
    fn rest(&self) {
        let soon = Instant::now() + POLL_EVERY;
        let due = self.seats.iter().filter(|seat| self.wants_frame(seat));
        let deadline = due.filter_map(|seat| {
            let preparing = seat.preparing.then_some(soon);
            preparing.or_else(|| lock(&seat.session.pacing).next_deadline())
        });
        let climbing = self.seats.iter().filter_map(|seat| {
            let wish = seat.session.wish();
            let reduced = seat.effort.is_reduced(seat.full_size(&wish));
            let watched = wish.watched && !seat.refuses(&wish) && seat.suspect.is_none();
            seat.effort.climbs_at().filter(|_| reduced && watched)
        });
        self.sessions.bell.wait(deadline.chain(climbing).min());
    }
}

/// Whether rendering more of the seat's picture would change nothing.
fn is_finished<B: Backend>(backend: &B, seat: &Seat<B::View>) -> bool {
    let picture = seat.picture.as_ref();
    picture.is_some_and(|picture| backend.is_converged(&picture.view))
}
