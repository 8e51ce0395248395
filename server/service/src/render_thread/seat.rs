//! A session's place at the device: its picture, its frame on the device, and what is known of its wish.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::time::Instant;

use tyndall_scene::ChangeSet;

use super::effort::Effort;
use super::fit::Fit;
use crate::bell::lock;
use crate::panics::words;
use crate::session::{Session, Wish};

/// A session's picture on the device.
pub(super) struct Picture<V> {
    pub(super) view: V,
    /// What it shows.
    pub(super) shown: Wish,
    /// Its size, smaller than at rest while it moves. Unit: pixel.
    pub(super) size: (u32, u32),
    /// Its size at rest, smaller than the wish's where memory is short. Unit: pixel.
    pub(super) full: (u32, u32),
}

/// A frame on the device.
pub(super) struct Flight {
    pub(super) frame_id: u32,
    /// What the frame shows.
    pub(super) wish: Wish,
    pub(super) began: Instant,
    /// Whether the picture was moving: its frame is short and is not dropped for a newer one.
    pub(super) moving: bool,
}

/// A session's place at the device.
pub(super) struct Seat<V> {
    pub(super) session: Arc<Session>,
    pub(super) picture: Option<Picture<V>>,
    pub(super) flight: Option<Flight>,
    /// Number of a frame that the renderer is being asked to start.
    pub(super) starting: Option<u32>,
    /// Input and epoch of the newest frame that was begun.
    pub(super) answered: Option<(u64, u32)>,
    /// The wish that the device was last asked to show.
    pub(super) asked: Option<Wish>,
    /// A wish that the renderer refused; not tried again until it changes.
    pub(super) refused: Option<Wish>,
    /// Whether what the wish needs was still being prepared when it was asked for last.
    pub(super) preparing: bool,
    /// The smaller size that the picture got, and the wish it belongs to.
    pub(super) fit: Option<Fit>,
    /// What a frame may cost while the picture moves.
    pub(super) effort: Effort,
    /// Whether no other session has a seat.
    pub(super) is_alone: bool,
    /// A wish whose frame was one of several on a lost device: its next frame has the device alone.
    pub(super) suspect: Option<Wish>,
    /// A wish that was suspect and whose frame came back when it had the device alone.
    pub(super) tried: Option<Wish>,
    /// A wish whose last frames could not be read, and how many in a row.
    pub(super) unread: Option<(Wish, u32)>,
}

impl<V> Seat<V> {
    pub(super) fn new(session: Arc<Session>, effort: Effort) -> Self {
        Self {
            session,
            picture: None,
            flight: None,
            starting: None,
            answered: None,
            asked: None,
            refused: None,
            preparing: false,
            fit: None,
            effort,
            is_alone: false,
            suspect: None,
            tried: None,
            unread: None,
        }
    }

    /// Forgets everything on the device.
    pub(super) fn clear(&mut self) {
        let picture = self.picture.take();
        // After a panic of the renderer nothing is sure about what it left behind.
        if let Err(panic) = catch_unwind(AssertUnwindSafe(|| drop(picture))) {
            tracing::error!(
                words = words(panic.as_ref()),
                "giving up a picture panicked"
            );
        }
        self.preparing = false;
        let flight = self.flight.take().map(|flight| flight.frame_id);
        for frame_id in flight.into_iter().chain(self.starting.take()) {
            lock(&self.session.pacing).discard(frame_id);
        }
    }

    /// Forgets what was found out about wishes that are no longer this session's.
    pub(super) fn forget_other_wishes(&mut self, wish: &Wish) {
        let is_other = |known: &Wish| !same_wish(known, wish);
        if self.suspect.as_ref().is_some_and(is_other) {
            self.suspect = None;
        }
        if self.tried.as_ref().is_some_and(is_other) {
            self.tried = None;
        }
        if self
            .unread
            .as_ref()
            .is_some_and(|(known, _)| is_other(known))
        {
            self.unread = None;
        }
    }

    /// Whether this wish was refused.
    pub(super) fn refuses(&self, wish: &Wish) -> bool {
        let refused = self.refused.as_ref();
        refused.is_some_and(|refused| same_picture(refused, wish))
    }

    /// The size that the wish gets at rest. Unit: pixel.
    pub(super) fn full_size(&self, wish: &Wish) -> (u32, u32) {
        let fit = self.fit.as_ref().filter(|fit| fit.serves(wish));
        fit.map_or((wish.width, wish.height), |fit| fit.size)
    }

    /// The size that the wish gets at present. Unit: pixel.
    pub(super) fn size_for(&self, wish: &Wish) -> (u32, u32) {
        self.effort.size(self.full_size(wish))
    }

    /// Whether the picture shows another state of the scene than the wish's, or is of another full size.
    pub(super) fn shows_another(&self, wish: &Wish) -> bool {
        let picture = self.picture.as_ref();
        picture.is_none_or(|picture| !same_picture(&picture.shown, wish))
    }

    /// Whether the wish's picture has nothing of the samples that are there.
    pub(super) fn starts_anew(&self, wish: &Wish) -> bool {
        self.picture.as_ref().is_none_or(|Picture { shown, .. }| {
            (shown.width, shown.height) != (wish.width, wish.height)
                || (!Arc::ptr_eq(&shown.scene, &wish.scene)
                    && ChangeSet::between(&shown.scene, &wish.scene).restarts())
        })
    }

    /// Whether the picture is not the wish's.
    pub(super) fn has_changed(&self, wish: &Wish) -> bool {
        self.picture.as_ref().is_none_or(|picture| {
            !same_picture(&picture.shown, wish) || picture.size != self.size_for(wish)
        })
    }

    /// Whether the client takes another frame.
    pub(super) fn may_begin(&self, now: Instant) -> bool {
        lock(&self.session.pacing).is_open(now)
    }

    /// Sends the last picture again when it is finished and answers a newer input or connection too:
    /// an input that changed nothing still gets its answer, a resumed page its picture.
    pub(super) fn answer_again(&mut self, wish: &Wish, now: Instant) {
        let mut pacing = lock(&self.session.pacing);
        // While frames are on their way an encoder may hold a newer picture than the last one.
        if self.answered == Some((wish.input, wish.epoch)) || pacing.in_flight() > 0 {
            return;
        }
        let Some(last) = self.session.outbox.last_frame() else {
            return;
        };
        let Some(frame_id) = pacing.begin(now) else {
            return;
        };
        match last.renumbered(frame_id, wish.epoch, wish.input) {
            Some(frame) => {
                self.answered = Some((wish.input, wish.epoch));
                // Nothing was on its way, so nothing waits to be replaced.
                drop(self.session.outbox.set_frame(frame));
            }
            None => pacing.discard(frame_id),
        }
    }
}

/// Whether two wishes need the same picture.
pub(super) fn same_picture(a: &Wish, b: &Wish) -> bool {
    Arc::ptr_eq(&a.scene, &b.scene) && (a.width, a.height) == (b.width, b.height)
}

/// Whether the client wants the same: of a scene that plays, every frame is another picture of one wish.
pub(super) fn same_wish(a: &Wish, b: &Wish) -> bool {
    let client = |wish: &Wish| (wish.epoch, wish.input, wish.width, wish.height);
    same_picture(a, b) || (a.playing && b.playing && client(a) == client(b))
}
