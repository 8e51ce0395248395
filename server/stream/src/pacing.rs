//! When a client gets its next frame and how well that frame is compressed.
//!
//! A pure state machine: it reads no clock, every call says what time it is. Its rules:
//!
//! - At most [`PacingSettings::window`] frames are on their way: being rendered, being encoded,
//!   or sent and not acknowledged. A slow client thus gets fewer frames, never older ones.
//! - An acknowledgement covers its frame and all earlier ones, since a WebSocket keeps order and
//!   a page may skip to the newest. Stale or invented acknowledgements change nothing.
//! - Frames that were sent and not acknowledged for [`PacingSettings::unwedge_after`] are given
//!   up, so that a client which lost an acknowledgement goes on.
//! - In motion frames are small JPEGs, at rest sharp JPEGs, when converged lossless. If the
//!   acknowledged round trip grows above the shortest one seen, the queue between the two ends
//!   is filling, and quality falls until it drains.

use std::collections::VecDeque;
use std::time::{Duration, Instant};

use crate::encode::{Chroma, EncodeChoice};
use crate::header::Codec;

/// JPEG quality in motion on a fast link.
pub const MOVING_QUALITY: u8 = 75;
/// JPEG quality at rest on a fast link.
pub const SETTLING_QUALITY: u8 = 92;
/// JPEG quality of a final picture for clients that do not take PNG.
pub const FINAL_JPEG_QUALITY: u8 = 95;
/// Most that a slow link takes off the quality in motion.
pub const MAX_REDUCTION: u8 = 40;

/// Chroma is halved at rest, too, once the reduction is above this.
const FULL_CHROMA_REDUCTION: u8 = 16;
const REDUCTION_STEP_UP: u8 = 8;
const REDUCTION_STEP_DOWN: u8 = 2;
/// The shortest round trip may grow by 1/64 a frame, so that a changed route is learnt.
const BASELINE_DRIFT: f64 = 1.0 + 1.0 / 64.0;

/// The constants of pacing.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PacingSettings {
    /// Most frames on their way to one client. Range: at least 1.
    pub window: usize,
    /// Sent frames older than this count as lost.
    pub unwedge_after: Duration,
    /// A picture counts as moving until this long after the last input.
    pub settle_after: Duration,
    /// Queueing delay above which quality falls.
    pub slow_above: Duration,
    /// Queueing delay below which quality rises again.
    pub fast_below: Duration,
}

impl Default for PacingSettings {
    fn default() -> Self {
        Self {
            window: 2,
            unwedge_after: Duration::from_secs(2),
            settle_after: Duration::from_millis(250),
            slow_above: Duration::from_millis(80),
            fast_below: Duration::from_millis(30),
        }
    }
}

/// Which codecs a client takes, as its hello said.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Accepts {
    /// Takes JPEG.
    pub jpeg: bool,
    /// Takes PNG.
    pub png: bool,
}

impl Accepts {
    /// Reads the client's list; `None` when it names no codec at all.
    pub fn from_list(list: &[Codec]) -> Option<Self> {
        let accepts = Self {
            jpeg: list.contains(&Codec::Jpeg),
            png: list.contains(&Codec::Png),
        };
        (accepts.jpeg || accepts.png).then_some(accepts)
    }
}

/// What state a picture is in, and with it how well it is to be compressed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Tier {
    /// Something changed a moment ago.
    Moving,
    /// Nothing changes, samples accumulate.
    Settling,
    /// Final until something changes.
    Converged,
}

/// What an acknowledgement did.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Acknowledged {
    /// The frame was on its way; this long passed since it was sent.
    RoundTrip(Duration),
    /// The frame was never sent, was acknowledged before, or was given up: nothing changed.
    Stale,
}

#[derive(Debug, Clone, Copy)]
struct InFlight {
    frame_id: u32,
    sent: Option<Instant>,
}

/// Pacing of one client.
#[derive(Debug)]
pub struct Pacing {
    settings: PacingSettings,
    /// Oldest first; never longer than the window.
    in_flight: VecDeque<InFlight>,
    next_frame_id: u32,
    last_input: Option<Instant>,
    baseline: Option<Duration>,
    smoothed: Option<Duration>,
    reduction: u8,
}

impl Pacing {
    /// Starts with nothing on its way and full quality.
    pub fn new(settings: PacingSettings) -> Self {
        Self {
            settings,
            in_flight: VecDeque::with_capacity(settings.window),
            next_frame_id: 1,
            last_input: None,
            baseline: None,
            smoothed: None,
            reduction: 0,
        }
    }

    /// Forgets everything but the frame count: a new connection took the session over.
    pub fn reconnect(&mut self) {
        let next_frame_id = self.next_frame_id;
        *self = Self {
            next_frame_id,
            ..Self::new(self.settings)
        };
    }

    /// Notes that the user changed something.
    pub fn input(&mut self, now: Instant) {
        self.last_input = Some(now);
    }

    /// Whether a frame may be begun; gives up frames that were not acknowledged in time.
    pub fn is_open(&mut self, now: Instant) -> bool {
        self.unwedge(now);
        self.in_flight.len() < self.settings.window
    }

    /// Takes a place in the window and numbers the frame; `None` when the window is full.
    pub fn begin(&mut self, now: Instant) -> Option<u32> {
        if !self.is_open(now) {
            return None;
        }
        let frame_id = self.next_frame_id;
        self.next_frame_id = self.next_frame_id.wrapping_add(1).max(1);
        self.in_flight.push_back(InFlight {
            frame_id,
            sent: None,
        });
        Some(frame_id)
    }

    /// Frees the place of a frame that will not be sent.
    pub fn discard(&mut self, frame_id: u32) {
        self.in_flight.retain(|frame| frame.frame_id != frame_id);
    }

    /// Starts the clock of a frame that is handed to the socket.
    pub fn sent(&mut self, frame_id: u32, now: Instant) {
        if let Some(frame) = self.in_flight.iter_mut().find(|f| f.frame_id == frame_id) {
            frame.sent = Some(now);
        }
    }

    /// Takes a client's acknowledgement of a frame and of all sent before it.
    pub fn acknowledge(&mut self, frame_id: u32, now: Instant) -> Acknowledged {
        let known = self
            .in_flight
            .iter()
            .position(|frame| frame.frame_id == frame_id);
        let Some((position, sent)) = known.and_then(|i| Some((i, self.in_flight[i].sent?))) else {
            return Acknowledged::Stale;
        };
        self.in_flight.drain(..=position);
        let round_trip = now.saturating_duration_since(sent);
        self.adapt(round_trip);
        Acknowledged::RoundTrip(round_trip)
    }

    /// When [`Pacing::is_open`] can next change by itself; `None` while the window is open or
    /// no sent frame is waiting.
    pub fn next_deadline(&self) -> Option<Instant> {
        if self.in_flight.len() < self.settings.window {
            return None;
        }
        let oldest = self.in_flight.iter().filter_map(|frame| frame.sent).min()?;
        Some(oldest + self.settings.unwedge_after)
    }

    /// Frames on their way.
    pub fn in_flight(&self) -> usize {
        self.in_flight.len()
    }

    /// Smoothed round trip of the last frames.
    pub fn round_trip(&self) -> Option<Duration> {
        self.smoothed
    }

    /// The state of a picture finished at `now`.
    pub fn tier(&self, converged: bool, now: Instant) -> Tier {
        let settling = self
            .last_input
            .is_none_or(|input| now.saturating_duration_since(input) >= self.settings.settle_after);
        match (converged, settling) {
            (true, _) => Tier::Converged,
            (false, true) => Tier::Settling,
            (false, false) => Tier::Moving,
        }
    }

    /// How to compress a picture of this tier for a client with these codecs.
    pub fn choose(&self, tier: Tier, accepts: Accepts) -> EncodeChoice {
        if !accepts.jpeg {
            return EncodeChoice::Png;
        }
        match tier {
            Tier::Converged if accepts.png => EncodeChoice::Png,
            Tier::Converged => EncodeChoice::Jpeg {
                quality: FINAL_JPEG_QUALITY,
                chroma: Chroma::Full,
            },
            Tier::Settling => EncodeChoice::Jpeg {
                quality: SETTLING_QUALITY - self.reduction / 2,
                chroma: if self.reduction > FULL_CHROMA_REDUCTION {
                    Chroma::Quarter
                } else {
                    Chroma::Full
                },
            },
            Tier::Moving => EncodeChoice::Jpeg {
                quality: MOVING_QUALITY - self.reduction,
                chroma: Chroma::Quarter,
            },
        }
    }

    fn unwedge(&mut self, now: Instant) {
        let limit = self.settings.unwedge_after;
        let before = self.in_flight.len();
        self.in_flight.retain(|frame| {
            frame
                .sent
                .is_none_or(|sent| now.saturating_duration_since(sent) < limit)
        });
        if self.in_flight.len() < before {
            self.reduce();
        }
    }

    fn adapt(&mut self, round_trip: Duration) {
        let drifted = self
            .baseline
            .map_or(round_trip, |base| base.mul_f64(BASELINE_DRIFT));
        let baseline = drifted.min(round_trip);
        let smoothed = self
            .smoothed
            .map_or(round_trip, |old| (old * 3 + round_trip) / 4);
        self.baseline = Some(baseline);
        self.smoothed = Some(smoothed);
        let queueing = smoothed.saturating_sub(baseline);
        if queueing > self.settings.slow_above {
            self.reduce();
        } else if queueing < self.settings.fast_below {
            self.reduction = self.reduction.saturating_sub(REDUCTION_STEP_DOWN);
        }
    }

    fn reduce(&mut self) {
        self.reduction = (self.reduction + REDUCTION_STEP_UP).min(MAX_REDUCTION);
    }
}
