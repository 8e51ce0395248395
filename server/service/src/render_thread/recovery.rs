//! A lost device: which pictures may have lost it, and another device.
//!
//! A wish that lost the device is not tried again as it stands. Where frames of several sessions were
//! on the device, each of them is suspect: its next frame has the new device alone, and if that is
//! lost, too, the wish is refused. A wish that was alone once and is suspect again is refused.

use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::{Duration, Instant};

use tyndall_render::RenderError;
use tyndall_stream::protocol::AdapterKind;

use super::readiness::Place;
use super::refusal::{Loss, is_loss, refuse, tell};
use super::round::RenderThread;
use super::seat::{Seat, same_wish};
use crate::backend::Backend;
use crate::options::ServeError;
use crate::panics::words;
use crate::session::Wish;
use crate::telemetry;

/// Pauses before the attempts to open another device; the last one repeats.
const RETRY_AFTER_MILLIS: [u64; 5] = [100, 500, 1000, 3000, 10_000];
/// Errors of the device in a row, outside any session's frame, that count as a loss.
const MAX_DEVICE_ERRORS: u32 = 10;

impl<B: Backend> RenderThread<B> {
    /// Counts errors that belong to no session; too many in a row count as a loss.
    pub(super) fn note(&mut self, result: Result<(), RenderError>) -> Result<(), Loss> {
        match result {
            Ok(()) => self.device_errors = 0,
            Err(error) if is_loss(&error) || self.device_errors >= MAX_DEVICE_ERRORS => {
                return Err(Loss::of_nobody(error));
            }
            Err(error) => {
                self.device_errors += 1;
                telemetry::render_error();
                tracing::error!(%error, "the device reported an error");
            }
        }
        Ok(())
    }

    /// A panic of the renderer as the loss of its device, by the session that it worked for.
    pub(super) fn panicked(&mut self, panic: &(dyn Any + Send)) -> Loss {
        let words = words(panic);
        self.readiness.panicked(Place::Renderer);
        tracing::error!(session = self.working_for, words, "the renderer panicked");
        Loss {
            error: RenderError::DeviceLost(format!("the renderer panicked: {words}")),
            caller: self.working_for.take(),
        }
    }

    /// Opens another device after the old one was lost; returns when one works or on shutdown.
    pub(super) fn recover(&mut self, loss: &Loss) {
        self.readiness.set(false);
        telemetry::device_lost();
        tracing::error!(error = %loss.error, "the device is lost, opening another");
        let beside = self.stills.is_on_device();
        blame(&mut self.seats, loss, beside);
        self.stills.lost(&loss.error);
        let lost = self.backend.take();
        if let Err(panic) = catch_unwind(AssertUnwindSafe(|| drop(lost))) {
            tracing::error!(words = words(panic.as_ref()), "closing the device panicked");
        }
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
            let opened = catch_unwind(AssertUnwindSafe(|| (self.open)()));
            let opened = opened.unwrap_or_else(|panic| {
                Err(ServeError::Thread {
                    name: "render",
                    reason: words(panic.as_ref()),
                })
            });
            match opened {
                Ok(backend) => {
                    let adapter = backend.adapter();
                    tracing::info!(adapter = adapter.name, "another device is open");
                    self.software = adapter.kind == AdapterKind::Software;
                    self.readiness.opened(backend.plan_limits());
                    self.backend = Some(backend);
                    return;
                }
                Err(error) => tracing::error!(%error, attempt, "no device could be opened"),
            }
        }
    }

    /// A session whose next frame must have the device alone and that wants one now.
    pub(super) fn next_suspect(&self, now: Instant) -> Option<usize> {
        let count = self.seats.len();
        (0..count)
            .map(|offset| (self.turn + offset) % count)
            .find(|index| {
                let seat = &self.seats[*index];
                seat.suspect.is_some() && self.wants_frame(seat) && seat.may_begin(now)
            })
    }
}

/// Empties all seats; refuses the wish that lost the device, or makes suspect those that may have. `beside`
/// says whether a still was on the device as well.
fn blame<V>(seats: &mut [Seat<V>], loss: &Loss, beside: bool) {
    let error = &loss.error;
    let suspects: Vec<Option<Wish>> = seats.iter().map(|seat| suspect(seat, loss)).collect();
    let alone = suspects.iter().flatten().count() == 1 && !beside;
    for (seat, suspect) in seats.iter_mut().zip(suspects) {
        seat.clear();
        let Some(wish) = suspect else {
            tell(&seat.session, error.to_string(), None);
            continue;
        };
        let tried = seat.tried.as_ref();
        if alone || tried.is_some_and(|tried| same_wish(tried, &wish)) {
            let why = format!("{error}; this picture is not tried again until something changes");
            refuse(seat, wish, why);
        } else {
            let message = format!("{error}; this picture may be why and is tried once more, alone");
            tell(&seat.session, message, None);
            seat.suspect = Some(wish);
        }
    }
}

/// What this seat had on the device, or asked of it, when it was lost.
fn suspect<V>(seat: &Seat<V>, loss: &Loss) -> Option<Wish> {
    let asked = seat.asked.as_ref();
    let asked = asked.filter(|_| loss.caller == Some(seat.session.id));
    let flight = seat.flight.as_ref().map(|flight| &flight.wish);
    flight.or(asked).cloned()
}
