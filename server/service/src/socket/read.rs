//! What the client says after its hello.

use std::sync::Arc;
use std::time::{Duration, Instant};

use axum::extract::ws::{Message, Utf8Bytes};
use futures_util::StreamExt as _;
use tokio::task::{JoinHandle, spawn_blocking};
use tyndall_scene::{Loaded, SceneError};
use tyndall_stream::pacing::Acknowledged;
use tyndall_stream::protocol::{
    CameraUpdate, ClientMessage, EditRequest, ErrorCode, ErrorMessage, OpenPreset, Resize,
    ServerMessage,
};

use super::steering::Steering;
use super::waiting::{Waiting, WaitingEdit};
use super::{Farewell, Stream, broken, error, hello};
use crate::bell::lock;
use crate::scenes::BuildError;
use crate::server::App;
use crate::session::{Refusal, Session};
use crate::telemetry;

/// Malformed messages in a row that a client may send.
const MAX_MALFORMED: u32 = 16;
/// Probes a client may leave unanswered.
const MAX_SILENT_PROBES: u32 = 3;
/// Longest message that is parsed where it arrives: a fraction of a millisecond. Unit: byte.
const SHORT: usize = 4096;
/// Longest rest after an edit.
const LONGEST_REST: Duration = Duration::from_secs(5);

/// A preset that is being built for this session.
struct Opening {
    input: u64,
    build: JoinHandle<Result<Arc<Loaded>, BuildError>>,
}

struct Reader<'a> {
    app: &'a Arc<App>,
    session: &'a Arc<Session>,
    malformed: u32,
    opening: Option<Opening>,
    /// The newest request that came while another preset was being built.
    next: Option<OpenPreset>,
    steering: Steering,
    /// Before which no further edit is made: edits get a share of the session's time.
    edit_from: Instant,
    /// What came since, and is done then.
    waiting: Waiting,
}

/// Reads until the client leaves or goes too far.
pub(super) async fn run(app: &Arc<App>, session: &Arc<Session>, stream: &mut Stream) -> Farewell {
    let mut reader = Reader {
        app,
        session,
        malformed: 0,
        opening: None,
        next: None,
        steering: Steering::new(app, session),
        edit_from: Instant::now(),
        waiting: Waiting::default(),
    };
    let silence = app.limits.ping_every * MAX_SILENT_PROBES;
    loop {
        let outcome = tokio::select! {
            received = tokio::time::timeout(silence, stream.next()) => match received {
                Ok(received) => reader.receive(received).await,
                Err(_elapsed) => Err(Farewell::SILENT),
            },
            built = built(&mut reader.opening) => reader.opened(built).await,
            navigation = reader.steering.known() => {
                reader.push(ServerMessage::Navigation(navigation))
            }
            () = tokio::time::sleep_until(reader.edit_from.into()), if reader.waiting.has_edit() => {
                reader.make_waiting().await
            }
        };
        if let Err(farewell) = outcome {
            // What the client said before it left counts; nobody is left to be told.
            reader.make_waiting().await.ok();
            return farewell;
        }
    }
}

/// The preset under construction, once it is built; never without one.
async fn built(opening: &mut Option<Opening>) -> (u64, Result<Arc<Loaded>, BuildError>) {
    let Some(Opening { input, build }) = opening else {
        return std::future::pending().await;
    };
    let built = build.await.unwrap_or(Err(BuildError::BrokenOff));
    let input = *input;
    *opening = None;
    (input, built)
}

impl Reader<'_> {
    async fn receive(
        &mut self,
        received: Option<Result<Message, axum::Error>>,
    ) -> Result<(), Farewell> {
        match received {
            Some(Ok(Message::Text(text))) if text.len() <= SHORT => {
                let parsed = ClientMessage::from_json(&text);
                self.parsed(parsed, Instant::now()).await
            }
            Some(Ok(Message::Text(text))) => self.long(text).await,
            Some(Ok(Message::Binary(_))) => {
                let message = "binary messages are not read; send JSON text";
                self.malformed(error(ErrorCode::Malformed, message, None))
            }
            // The library answers pings itself.
            Some(Ok(Message::Ping(_) | Message::Pong(_))) => Ok(()),
            Some(Ok(Message::Close(_))) => Err(Farewell::CLIENT_LEFT),
            None => Err(Farewell::ABORTED),
            Some(Err(error)) => {
                tracing::debug!(session = self.session.id, %error, "the connection broke");
                Err(broken(error))
            }
        }
    }

    /// Takes a long message: it is parsed, and what it asks for is done, on a blocking thread, and only one
    /// at a time on this server.
    async fn long(&mut self, text: Utf8Bytes) -> Result<(), Farewell> {
        tokio::time::sleep_until(self.edit_from.into()).await;
        let app = Arc::clone(self.app);
        let Ok(_permit) = app.editing.acquire().await else {
            return Err(Farewell::GOING_DOWN);
        };
        let start = Instant::now();
        let parsed = spawn_blocking(move || ClientMessage::from_json(&text)).await;
        let Ok(parsed) = parsed else {
            return self.refuse(error(ErrorCode::Internal, "the message broke off", None));
        };
        let outcome = self.parsed(parsed, start).await;
        self.rest_after(start);
        outcome
    }

    async fn parsed(
        &mut self,
        parsed: Result<ClientMessage, SceneError>,
        now: Instant,
    ) -> Result<(), Farewell> {
        match parsed {
            Ok(message) => {
                self.malformed = 0;
                self.handle(message, now).await
            }
            Err(refused) => self.malformed(ErrorMessage {
                path: refused.path().map(str::to_owned),
                ..error(ErrorCode::Malformed, refused.to_string(), None)
            }),
        }
    }

    /// Lets the next edit wait as long as the share of the session asks after work that began at `start`.
    fn rest_after(&mut self, start: Instant) {
        let share = self.app.limits.edit_percent.clamp(1, 100);
        let rest = start.elapsed() * (100 - share) / share;
        self.edit_from = Instant::now() + rest.min(LONGEST_REST);
    }

    async fn handle(&mut self, message: ClientMessage, now: Instant) -> Result<(), Farewell> {
        let session = self.session;
        match message {
            ClientMessage::Hello(_) => {
                return self.refuse(error(ErrorCode::Malformed, "hello was said before", None));
            }
            ClientMessage::Camera(update) if self.waiting.has_edit() => {
                self.waiting.keep_camera(&update);
            }
            ClientMessage::Camera(update) => self.steer(&update, now)?,
            ClientMessage::Edit(request) => {
                self.edit(request, now).await?;
            }
            ClientMessage::OpenPreset(request) => {
                // What waits is answered first.
                self.make_waiting().await?;
                self.open(request);
            }
            ClientMessage::Resize(resize) => {
                self.make_waiting().await?;
                let Resize {
                    input,
                    width,
                    height,
                } = resize;
                let told = hello::resize(&self.app.limits, session, input, width, height);
                if let Some(told) = told {
                    self.push(told)?;
                }
            }
            ClientMessage::Ack(ack) => {
                let outcome = lock(&session.pacing).acknowledge(ack.frame, now);
                if let Acknowledged::RoundTrip(time) = outcome {
                    telemetry::round_trip(time);
                }
            }
            ClientMessage::Visible(visible) => session.set_visible(visible.visible),
            ClientMessage::Pick(pick) => {
                let picked = self.steering.pick(pick).await;
                return self.push(ServerMessage::Picked(picked));
            }
            ClientMessage::ExplainDarkness(question) => {
                return match self.steering.darkness(question).await {
                    Some(answer) => self.push(ServerMessage::Darkness(answer)),
                    None => Ok(()),
                };
            }
        }
        self.app.sessions.bell.ring();
        Ok(())
    }

    /// Moves the eye, as far as surfaces let it.
    fn steer(&mut self, update: &CameraUpdate, now: Instant) -> Result<(), Farewell> {
        let stopped = self.steering.stopped(update);
        let camera = stopped.map_or(update.camera, |stopped| stopped.camera);
        let outcome = self.session.set_camera(update.input, camera, now);
        self.answer(outcome, update.input)?;
        if let Some(stopped) = stopped {
            self.session.outbox.set_camera(stopped);
        }
        Ok(())
    }

    /// Changes the open scene, at once or when the share of edits allows the next one.
    async fn edit(&mut self, request: EditRequest, now: Instant) -> Result<(), Farewell> {
        if !self.waiting.takes(&request.edit) {
            self.make_waiting().await?;
        }
        self.waiting.keep_edit(request, now);
        if Instant::now() >= self.edit_from {
            self.make_waiting().await?;
        }
        Ok(())
    }

    /// Makes the edit that waits, once its time has come, and then moves the camera that waits behind it.
    async fn make_waiting(&mut self) -> Result<(), Farewell> {
        let (edit, camera) = self.waiting.take();
        if let Some(edit) = edit {
            self.make(edit).await?;
        }
        if let Some(update) = camera {
            self.steer(&update, Instant::now())?;
        }
        self.app.sessions.bell.ring();
        Ok(())
    }

    /// Changes the open scene on a blocking thread; what the client says next waits for it.
    async fn make(&mut self, waiting: WaitingEdit) -> Result<(), Farewell> {
        let WaitingEdit {
            request: EditRequest { input, edit },
            first_input,
            came,
        } = waiting;
        let session = Arc::clone(self.session);
        tokio::time::sleep_until(self.edit_from.into()).await;
        let start = Instant::now();
        let edited = spawn_blocking(move || session.edit(input, &edit, came)).await;
        self.rest_after(start);
        match edited {
            Ok(outcome) => self.answer(outcome, first_input),
            Err(broken) => {
                tracing::error!(session = self.session.id, %broken, "an edit broke off");
                let message = "the edit broke off";
                self.refuse(error(ErrorCode::Internal, message, Some(first_input)))
            }
        }
    }

    /// Starts building a preset; while one is being built only the newest request is kept.
    fn open(&mut self, request: OpenPreset) {
        if self.opening.is_some() {
            self.next = Some(request);
            return;
        }
        let OpenPreset { input, name } = request;
        let app = Arc::clone(self.app);
        let build = tokio::spawn(async move { app.scenes.preset(&name).await });
        self.opening = Some(Opening { input, build });
    }

    /// Shows a preset that has been built.
    async fn opened(
        &mut self,
        (input, built): (u64, Result<Arc<Loaded>, BuildError>),
    ) -> Result<(), Farewell> {
        if let Some(next) = self.next.take() {
            self.open(next);
            return Ok(());
        }
        match built {
            Ok(loaded) => match self.session.open(input, &loaded, Instant::now()) {
                Ok(()) => {
                    self.steering.scene_opened();
                    let scene = hello::scene_message(self.session).await;
                    self.app.sessions.bell.ring();
                    match scene {
                        Some(scene) => self.push(ServerMessage::Scene(Box::new(scene))),
                        None => Ok(()),
                    }
                }
                Err(refusal) => self.answer(Err(refusal), input),
            },
            Err(failed) => {
                let code = match &failed {
                    BuildError::NoSuchPreset { .. } => ErrorCode::NotFound,
                    BuildError::Scene(_) => ErrorCode::InvalidScene,
                    BuildError::NotRenderedYet(_) => ErrorCode::NotRenderedYet,
                    BuildError::TookTooLong { .. } => ErrorCode::TookTooLong,
                    BuildError::BrokenOff => ErrorCode::Internal,
                };
                self.refuse(error(code, failed.to_string(), Some(input)))
            }
        }
    }

    fn answer(&self, outcome: Result<(), Refusal>, input: u64) -> Result<(), Farewell> {
        match outcome {
            Ok(()) => Ok(()),
            Err(refusal) => self.refuse(refusal.message(Some(input))),
        }
    }

    fn malformed(&mut self, message: ErrorMessage) -> Result<(), Farewell> {
        telemetry::malformed_message();
        self.malformed += 1;
        self.refuse(message)?;
        if self.malformed < MAX_MALFORMED {
            Ok(())
        } else {
            Err(Farewell::MALFORMED)
        }
    }

    fn refuse(&self, message: ErrorMessage) -> Result<(), Farewell> {
        self.push(ServerMessage::Error(message))
    }

    fn push(&self, message: ServerMessage) -> Result<(), Farewell> {
        if self.session.outbox.push(message) {
            Ok(())
        } else {
            Err(Farewell::UNREAD)
        }
    }
}
