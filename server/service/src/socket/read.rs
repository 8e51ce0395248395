//! What the client says after its hello.

use std::sync::Arc;
use std::time::Instant;

use axum::extract::ws::Message;
use futures_util::StreamExt as _;
use tokio::task::{JoinHandle, spawn_blocking};
use tyndall_scene::Loaded;
use tyndall_stream::pacing::Acknowledged;
use tyndall_stream::protocol::{
    ClientMessage, EditRequest, ErrorCode, ErrorMessage, OpenPreset, ServerMessage,
};

use super::steering::Steering;
use super::{Farewell, Stream, error, hello};
use crate::bell::lock;
use crate::scenes::BuildError;
use crate::server::App;
use crate::session::{Refusal, Session};
use crate::telemetry;

/// Malformed messages in a row that a client may send.
const MAX_MALFORMED: u32 = 16;
/// Probes a client may leave unanswered.
const MAX_SILENT_PROBES: u32 = 3;

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
    };
    let silence = app.limits.ping_every * MAX_SILENT_PROBES;
    loop {
        let outcome = tokio::select! {
            received = tokio::time::timeout(silence, stream.next()) => match received {
                Ok(received) => reader.receive(received).await,
                Err(_elapsed) => Err(Farewell::SILENT),
            },
            built = built(&mut reader.opening) => reader.opened(built),
            navigation = reader.steering.known() => {
                reader.push(ServerMessage::Navigation(navigation))
            }
        };
        if let Err(farewell) = outcome {
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
            Some(Ok(Message::Text(text))) => match ClientMessage::from_json(&text) {
                Ok(message) => {
                    self.malformed = 0;
                    self.handle(message).await
                }
                Err(refused) => self.malformed(ErrorMessage {
                    path: refused.path().map(str::to_owned),
                    ..error(ErrorCode::Malformed, refused.to_string(), None)
                }),
            },
            Some(Ok(Message::Binary(_))) => {
                let message = "binary messages are not read; send JSON text";
                self.malformed(error(ErrorCode::Malformed, message, None))
            }
            // The library answers pings itself.
            Some(Ok(Message::Ping(_) | Message::Pong(_))) => Ok(()),
            Some(Ok(Message::Close(_))) | None => Err(Farewell::CLIENT_LEFT),
            Some(Err(broken)) => {
                tracing::debug!(session = self.session.id, %broken, "the connection broke");
                Err(Farewell::TOO_LONG)
            }
        }
    }

    async fn handle(&mut self, message: ClientMessage) -> Result<(), Farewell> {
        let now = Instant::now();
        let session = self.session;
        match message {
            ClientMessage::Hello(_) => {
                return self.refuse(error(ErrorCode::Malformed, "hello was said before", None));
            }
            ClientMessage::Camera(update) => {
                let stopped = self.steering.stopped(&update);
                let camera = stopped.map_or(update.camera, |stopped| stopped.camera);
                let outcome = session.set_camera(update.input, camera, now);
                self.answer(outcome, update.input)?;
                if let Some(stopped) = stopped {
                    session.outbox.set_camera(stopped);
                }
            }
            ClientMessage::Edit(request) => {
                self.edit(request, now).await?;
            }
            ClientMessage::OpenPreset(request) => self.open(request),
            ClientMessage::Resize(resize) => {
                match hello::check_size(&self.app.limits, resize.width, resize.height) {
                    Ok(()) => session.resize(resize.input, resize.width, resize.height, now),
                    Err(message) => {
                        let input = Some(resize.input);
                        self.refuse(error(ErrorCode::InvalidSize, message, input))?;
                    }
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

    /// Changes the open scene on a blocking thread; what the client says next waits for it.
    async fn edit(&self, request: EditRequest, now: Instant) -> Result<(), Farewell> {
        let EditRequest { input, edit } = request;
        let session = Arc::clone(self.session);
        match spawn_blocking(move || session.edit(input, &edit, now)).await {
            Ok(outcome) => self.answer(outcome, input),
            Err(broken) => {
                tracing::error!(session = self.session.id, %broken, "an edit broke off");
                let message = "the edit broke off";
                self.refuse(error(ErrorCode::Internal, message, Some(input)))
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
    fn opened(
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
                    let scene = Box::new(self.session.scene_message());
                    self.steering.scene_opened();
                    self.app.sessions.bell.ring();
                    self.push(ServerMessage::Scene(scene))
                }
                Err(refusal) => self.answer(Err(refusal), input),
            },
            Err(failed) => {
                let code = match &failed {
                    BuildError::NoSuchPreset { .. } => ErrorCode::NotFound,
                    BuildError::Scene(_) => ErrorCode::InvalidScene,
                    BuildError::NotRenderedYet(_) => ErrorCode::NotRenderedYet,
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
