//! Stills of jobs, made in slices between the frames of sessions.
//!
//! One slice of one still is on the device at a time. While sessions have frames there, each of their frames
//! lets one slice follow, so a frame waits for one slice at most. Between stills the device is shared by
//! weight: the one whose time, divided by its weight, is shortest is next.

use std::sync::Arc;
use std::time::{Duration, Instant};

use tyndall_render::RenderError;
use tyndall_still::Step;

use super::refusal::{Loss, is_loss};
use super::round::RenderThread;
use crate::backend::{Backend, StillInMaking as _};
use crate::stills::{Desk, Shown, StillFailure, StillOrder, StillReply};
use crate::telemetry;

/// Most stills in the making: each has its own memory on the device.
pub(crate) const MOST_STILLS: usize = 2;
/// Part of a moving picture's frame budget that a slice takes while somebody watches.
const SLICES_A_FRAME: u32 = 6;

/// A still in the making.
struct Place<S> {
    order: StillOrder,
    still: S,
    /// When the slice that is on the device was submitted.
    submitted: Option<Instant>,
    /// Device time so far, divided by the weight. Unit: s.
    spent: f64,
    finished: bool,
    preparing: bool,
}

/// The stills of the render thread.
pub(super) struct Stills<S> {
    desk: Arc<Desk>,
    places: Vec<Place<S>>,
    /// Whether a frame of a session came back since the last slice was submitted.
    is_due: bool,
    /// The place that the renderer is asked for right now.
    working_on: Option<usize>,
}

impl<S: crate::backend::StillInMaking> Stills<S> {
    pub(super) fn new(desk: Arc<Desk>) -> Self {
        Self {
            desk,
            places: Vec::new(),
            is_due: true,
            working_on: None,
        }
    }

    /// Whether there are any.
    pub(super) fn are_there(&self) -> bool {
        !self.places.is_empty()
    }

    /// Whether a slice is on the device.
    pub(super) fn is_on_device(&self) -> bool {
        self.places.iter().any(|place| place.still.is_on_device())
    }

    /// A frame of a session came back: one slice may follow.
    pub(super) fn follow(&mut self) {
        self.is_due = true;
    }

    /// The device is gone, and all stills with it. What was on the device, or was asked for, may be why.
    pub(super) fn lost(&mut self, error: &RenderError) {
        let working_on = self.working_on.take();
        for (index, place) in self.places.drain(..).enumerate() {
            let may_be_why = working_on == Some(index) || place.submitted.is_some();
            let failure = if may_be_why {
                StillFailure::DeviceLost(error.to_string())
            } else {
                StillFailure::Interrupted
            };
            answer(place.order, Err(failure));
        }
    }

    /// Gives all of them up: the thread ends.
    pub(super) fn clear(&mut self) {
        self.desk.close();
        for place in self.places.drain(..) {
            answer(place.order, Err(StillFailure::Interrupted));
        }
    }

    /// Takes orders as long as there are places.
    fn seat(&mut self, new: impl Fn(&StillOrder) -> S) {
        while self.places.len() < MOST_STILLS
            && let Some(order) = self.desk.take()
        {
            // As if it had had its share so far.
            let spent = self.places.iter().map(|place| place.spent);
            let spent = spent.fold(None, |least: Option<f64>, one| {
                Some(least.map_or(one, |least| least.min(one)))
            });
            self.places.push(Place {
                still: new(&order),
                order,
                submitted: None,
                spent: spent.unwrap_or(0.0),
                finished: false,
                preparing: false,
            });
        }
    }

    /// The place whose turn it is.
    fn next(&self) -> Option<usize> {
        let places = self.places.iter().enumerate();
        let waiting = places.filter(|(_, place)| !place.finished);
        let next = waiting.min_by(|(_, a), (_, b)| {
            // What is being prepared is only asked about: it must not hold up the others.
            let key = |place: &Place<S>| (place.preparing, place.spent);
            let ((a_preparing, a_spent), (b_preparing, b_spent)) = (key(a), key(b));
            a_preparing
                .cmp(&b_preparing)
                .then(a_spent.total_cmp(&b_spent))
        });
        next.map(|(index, _)| index)
    }
}

impl<S: crate::backend::StillInMaking> Place<S> {
    /// Notes what a slice that has ended took, and tells how far the still is.
    fn note(&mut self) {
        if let Some(submitted) = self.submitted
            && !self.still.is_on_device()
        {
            self.spent += submitted.elapsed().as_secs_f64() / self.order.weight.max(1e-3);
            self.submitted = None;
        }
        self.order.watch.set_progress(self.still.progress());
        if let Some(frame) = self.still.shown()
            && self.order.watch.take_shown_wanted()
        {
            self.order.watch.show(Shown {
                width: frame.width,
                height: frame.height,
                rgba: frame.rgba.clone(),
            });
        }
    }

    fn is_stopped(&self) -> bool {
        self.order.watch.is_stopped() || self.order.reply.is_closed()
    }
}

impl<B: Backend> RenderThread<B> {
    /// Does what is next for the stills; whether anything was submitted or finished.
    pub(super) fn work_on_stills(&mut self) -> Result<bool, Loss> {
        let Some(backend) = &self.backend else {
            return Ok(false);
        };
        self.stills
            .seat(|order| backend.new_still(Arc::clone(&order.scene)));
        let mut any = false;
        for index in (0..self.stills.places.len()).rev() {
            any |= self.look_at(index)?;
        }
        let trying = self.seats.iter().any(|seat| seat.suspect.is_some());
        let turn = self.stills.is_due || !self.is_busy();
        if trying || !turn || self.stills.is_on_device() {
            return Ok(any);
        }
        let Some(index) = self.stills.next() else {
            return Ok(any);
        };
        Ok(self.step(index)? || any)
    }

    /// Looks what has become of a still's slice; ends the still where it is finished or stopped.
    fn look_at(&mut self, index: usize) -> Result<bool, Loss> {
        let place = &self.stills.places[index];
        if place.still.is_on_device() {
            self.step(index)?;
        }
        let Some(place) = self.stills.places.get_mut(index) else {
            return Ok(true);
        };
        place.note();
        if place.still.is_on_device() || !(place.finished || place.is_stopped()) {
            return Ok(false);
        }
        let place = self.stills.places.remove(index);
        let Some(backend) = &mut self.backend else {
            return Ok(true);
        };
        let adapter = backend.adapter();
        match backend.finish_still(place.still) {
            Ok(still) => answer(place.order, Ok(StillReply { still, adapter })),
            Err(error) => {
                let lost = is_loss(&error);
                answer(place.order, Err(failure(&error)));
                if lost {
                    return Err(Loss::of_nobody(error));
                }
            }
        }
        Ok(true)
    }

    /// One step of a still; whether something was submitted.
    fn step(&mut self, index: usize) -> Result<bool, Loss> {
        let budget = self.slice_budget();
        let (Some(backend), Some(place)) = (&mut self.backend, self.stills.places.get_mut(index))
        else {
            return Ok(false);
        };
        self.stills.working_on = Some(index);
        let stepped = backend.step_still(&mut place.still, budget);
        match stepped {
            Ok(step) => {
                self.stills.working_on = None;
                place.preparing = step == Step::Preparing;
                place.finished |= step == Step::Finished;
                if step == Step::Submitted {
                    place.submitted = Some(Instant::now());
                    self.stills.is_due = false;
                }
                Ok(step == Step::Submitted || step == Step::Finished)
            }
            Err(error) if is_loss(&error) => Err(Loss::of_nobody(error)),
            Err(error) => {
                self.stills.working_on = None;
                telemetry::render_error();
                let place = self.stills.places.remove(index);
                answer(place.order, Err(failure(&error)));
                Ok(true)
            }
        }
    }

    /// Time of a slice: short while somebody watches.
    fn slice_budget(&self) -> Option<Duration> {
        let watched = self.seats.iter().any(|seat| seat.session.wish().watched);
        watched.then(|| self.moving_budget() / SLICES_A_FRAME)
    }

    /// Blocks until the slice that is on the device has ended; whether there was one.
    pub(super) fn wait_for_slice(&mut self) -> Result<bool, RenderError> {
        let mut places = self.stills.places.iter();
        let on_device = places.find(|place| place.still.is_on_device());
        match (&mut self.backend, on_device) {
            (Some(backend), Some(place)) => backend.wait_for_still(&place.still).map(|()| true),
            _ => Ok(false),
        }
    }
}

fn failure(error: &RenderError) -> StillFailure {
    let words = error.to_string();
    match error {
        RenderError::Memory { .. } | RenderError::FailedFrame(_) => StillFailure::Passing(words),
        _ if is_loss(error) => StillFailure::DeviceLost(words),
        _ => StillFailure::Refused(words),
    }
}

/// Tells whoever ordered it; that may have gone.
fn answer(order: StillOrder, reply: Result<StillReply, StillFailure>) {
    drop(order.reply.send(reply));
}
