//! Compresses frames on a few threads of its own: never on the render thread, which has the next
//! frame to start, nor on the async threads, which have sockets to serve.
//!
//! At most one frame a session waits; a newer one replaces it. At most one frame a session is
//! being compressed, so frames of a session leave in order.

use std::collections::{HashSet, VecDeque};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Arc, Condvar, Mutex, PoisonError};
use std::thread::JoinHandle;
use std::time::Instant;

use tyndall_render::FinishedFrame;
use tyndall_stream::encode::{EncodeError, Encoder, Picture};
use tyndall_stream::header::{FrameHeader, HEADER_BYTES, HeaderError};
use tyndall_stream::protocol::{ErrorCode, ErrorMessage, PassTime, ServerMessage, Stats};

use crate::bell::lock;
use crate::options::ServeError;
use crate::outbox::EncodedFrame;
use crate::panics::words;
use crate::render_thread::{Place, Readiness};
use crate::session::{Session, Wish};
use crate::telemetry;

/// A finished frame of a session.
pub(crate) struct Job {
    pub(crate) session: Arc<Session>,
    pub(crate) frame: FinishedFrame,
    pub(crate) frame_id: u32,
    /// What the frame shows.
    pub(crate) wish: Wish,
    /// Whether a software adapter rendered it.
    pub(crate) software: bool,
}

#[derive(Default)]
struct Queue {
    jobs: VecDeque<Job>,
    busy: HashSet<u64>,
    closed: bool,
}

#[derive(Default)]
struct Shared {
    queue: Mutex<Queue>,
    changed: Condvar,
}

/// The threads and their queue.
pub(crate) struct EncoderPool {
    shared: Arc<Shared>,
    threads: Vec<JoinHandle<()>>,
}

impl EncoderPool {
    /// Starts `threads` threads, at least one.
    pub(crate) fn start(threads: usize, readiness: &Arc<Readiness>) -> Result<Self, ServeError> {
        let shared = Arc::new(Shared::default());
        let fault = |reason: String| ServeError::Thread {
            name: "encoder",
            reason,
        };
        let threads = (0..threads.max(1))
            .map(|_| {
                let mut encoder = Encoder::new().map_err(|error| fault(error.to_string()))?;
                let (shared, readiness) = (Arc::clone(&shared), Arc::clone(readiness));
                std::thread::Builder::new()
                    .name("encoder".to_owned())
                    .spawn(move || work(&shared, &readiness, |job| encode(&mut encoder, job)))
                    .map_err(|error| fault(error.to_string()))
            })
            .collect::<Result<_, _>>()?;
        Ok(Self { shared, threads })
    }

    /// Hands a frame over; one of the same session that still waits is dropped for it.
    pub(crate) fn submit(&self, job: Job) {
        let mut queue = lock(&self.shared.queue);
        let waiting = queue
            .jobs
            .iter_mut()
            .find(|waiting| waiting.session.id == job.session.id);
        if let Some(waiting) = waiting {
            let dropped = std::mem::replace(waiting, job);
            drop(queue);
            give_up(&dropped.session, dropped.frame_id);
        } else {
            queue.jobs.push_back(job);
            drop(queue);
        }
        self.shared.changed.notify_one();
    }
}

impl Drop for EncoderPool {
    fn drop(&mut self) {
        lock(&self.shared.queue).closed = true;
        self.shared.changed.notify_all();
        for thread in self.threads.drain(..) {
            if thread.join().is_err() {
                tracing::error!("an encoder thread panicked");
            }
        }
    }
}

/// Frees the frame's place in the window.
fn give_up(session: &Session, frame_id: u32) {
    lock(&session.pacing).discard(frame_id);
    telemetry::frame_dropped();
}

/// Compresses frames until the pool closes; one that cannot be compressed is given up, whatever happens.
fn work(
    shared: &Shared,
    readiness: &Readiness,
    mut encode: impl FnMut(Job) -> Result<EncodedFrame, FrameError>,
) {
    while let Some(job) = next(shared) {
        let session = Arc::clone(&job.session);
        let frame_id = job.frame_id;
        // An encoder has no state that outlives a frame, so it goes on after a panic.
        let encoded = catch_unwind(AssertUnwindSafe(|| encode(job))).unwrap_or_else(|panic| {
            readiness.panicked(Place::Encoder);
            Err(FrameError::Panic(words(panic.as_ref())))
        });
        match encoded {
            Ok(frame) => {
                if let Some(unsent) = session.outbox.set_frame(frame) {
                    give_up(&session, unsent.header.frame_id);
                }
            }
            Err(error) => {
                tracing::error!(session = session.id, %error, "a frame could not be encoded");
                give_up(&session, frame_id);
                let message = error.to_string();
                let code = ErrorCode::Internal;
                session.outbox.push(ServerMessage::Error(ErrorMessage {
                    code,
                    path: None,
                    message,
                    input: None,
                }));
            }
        }
        lock(&shared.queue).busy.remove(&session.id);
        // A frame of this session may have waited for it.
        shared.changed.notify_one();
    }
}

/// Waits for a job of a session that no other thread works for; `None` when the pool closes.
fn next(shared: &Shared) -> Option<Job> {
    let mut queue = lock(&shared.queue);
    loop {
        if queue.closed {
            return None;
        }
        let free = queue
            .jobs
            .iter()
            .position(|job| !queue.busy.contains(&job.session.id));
        if let Some(job) = free.and_then(|position| queue.jobs.remove(position)) {
            queue.busy.insert(job.session.id);
            return Some(job);
        }
        queue = shared
            .changed
            .wait(queue)
            .unwrap_or_else(PoisonError::into_inner);
    }
}

#[derive(Debug, thiserror::Error)]
enum FrameError {
    #[error(transparent)]
    Encode(#[from] EncodeError),
    #[error(transparent)]
    Header(#[from] HeaderError),
    #[error("the encoder panicked: {0}")]
    Panic(String),
}

fn encode(encoder: &mut Encoder, job: Job) -> Result<EncodedFrame, FrameError> {
    let Job {
        session,
        frame,
        frame_id,
        wish,
        software,
    } = job;
    let start = Instant::now();
    let (choice, round_trip) = {
        let pacing = lock(&session.pacing);
        let tier = pacing.tier(frame.converged, start);
        (pacing.choose(tier, wish.accepts), pacing.round_trip())
    };
    let mut message = vec![0; HEADER_BYTES];
    let picture = Picture {
        width: frame.width,
        height: frame.height,
        rgba: &frame.rgba,
    };
    encoder.encode(picture, choice, &mut message)?;
    let time = start.elapsed();
    telemetry::frame_encoded(time);
    let payload_length = u32::try_from(message.len() - HEADER_BYTES).unwrap_or(u32::MAX);
    let header = FrameHeader {
        codec: choice.codec(),
        converged: frame.converged,
        software,
        session_epoch: wish.epoch,
        frame_id,
        applied_input: wish.input,
        samples: frame.samples,
        width: frame.width,
        height: frame.height,
        estimated_error: frame.stats.estimated_error.filter(|e| e.is_finite()),
        render_micros: frame.render_micros,
        encode_micros: u32::try_from(time.as_micros()).unwrap_or(u32::MAX),
        payload_length,
    };
    message[..HEADER_BYTES].copy_from_slice(&header.encode()?);
    let stats = Stats {
        frame: frame_id,
        samples: frame.samples,
        converged: frame.converged,
        mean_transmittance: frame.stats.mean_transmittance,
        mean_luminance: frame.stats.mean_luminance,
        non_finite: frame.stats.non_finite,
        negative: frame.stats.negative,
        clamped: frame.stats.clamped,
        pass_times: frame
            .pass_times
            .iter()
            .map(|pass| PassTime {
                name: pass.name.to_string(),
                micros: pass.micros,
            })
            .collect(),
        render_micros: frame.render_micros,
        encode_micros: header.encode_micros,
        bytes: message.len() as u64,
        technique: tyndall_render::chosen(wish.scene.render.technique)
            .name()
            .to_owned(),
        time_seconds: wish
            .scene
            .duration_seconds()
            .map(|_| wish.scene.time_seconds),
        round_trip_micros: round_trip.map(|time| time.as_micros() as u64),
    };
    Ok(EncodedFrame {
        header,
        message: message.into(),
        stats,
    })
}

#[cfg(test)]
mod tests {
    use tyndall_render::FrameStats;
    use tyndall_scene::{build, presets};
    use tyndall_stream::pacing::Accepts;

    use super::*;
    use crate::outbox::Outgoing;

    /// A session with one frame on its way.
    fn job() -> Job {
        let description = presets::description("cornell_fog").expect("a preset");
        let loaded = build(description, None).expect("the preset is valid");
        let accepts = Accepts {
            jpeg: true,
            png: true,
        };
        let session = Arc::new(Session::new(1, String::new(), &loaded, accepts));
        let frame_id = lock(&session.pacing).begin(Instant::now());
        let frame = FinishedFrame {
            tag: 0,
            width: 8,
            height: 8,
            rgba: vec![7; 256],
            samples: 1,
            converged: false,
            epoch: 0,
            stats: FrameStats::default(),
            pass_times: Vec::new(),
            render_micros: 1,
            units: 0,
            shadow_layers: 0,
        };
        let wish = session.wish();
        Job {
            session,
            frame,
            frame_id: frame_id.expect("the window is open"),
            wish,
            software: true,
        }
    }

    #[test]
    fn a_panic_costs_its_frame_and_the_thread_goes_on() {
        let (shared, readiness) = (Shared::default(), Readiness::default());
        let (bad, good) = (job(), job());
        let sessions = [Arc::clone(&bad.session), Arc::clone(&good.session)];
        lock(&shared.queue).jobs.extend([bad, good]);
        let mut encoder = Encoder::new().expect("an encoder");
        let mut seen = 0;
        work(&shared, &readiness, |job| {
            seen += 1;
            lock(&shared.queue).closed = seen == 2;
            assert!(seen == 2, "the test wants a panic");
            encode(&mut encoder, job)
        });
        assert_eq!(readiness.panics(), (0, 1));
        let Some(Outgoing::Message(ServerMessage::Error(error))) = sessions[0].outbox.take(1)
        else {
            panic!("the session is not told");
        };
        assert_eq!(
            error.message,
            "the encoder panicked: the test wants a panic"
        );
        assert_eq!(lock(&sessions[0].pacing).in_flight(), 0);
        assert!(sessions[1].outbox.holds_frame());
    }
}
