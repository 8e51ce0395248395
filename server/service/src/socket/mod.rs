//! `/v1/stream`: one conversation a WebSocket.
//!
//! A task a connection, in which reading and writing go on side by side, so that a large frame on
//! a slow link never delays the camera.

mod hello;
mod read;
mod steering;
mod waiting;
mod write;

use std::sync::Arc;
use std::time::Duration;

use axum::extract::State;
use axum::extract::ws::rejection::WebSocketUpgradeRejection;
use axum::extract::ws::{CloseFrame, Message, WebSocket, WebSocketUpgrade};
use axum::response::{IntoResponse, Response};
use futures_util::stream::{SplitSink, SplitStream};
use futures_util::{SinkExt as _, StreamExt as _};
use tokio_tungstenite::tungstenite::Error as WebSocketError;
use tokio_tungstenite::tungstenite::error::ProtocolError;
use tyndall_stream::protocol::{ErrorCode, ErrorMessage, ServerMessage};

use crate::problem::Problem;
use crate::server::App;
use crate::session::Session;
use crate::telemetry;

type Sink = SplitSink<WebSocket, Message>;
type Stream = SplitStream<WebSocket>;

/// How long a closing handshake may take.
const CLOSE_WITHIN: Duration = Duration::from_secs(2);

/// Why a conversation ends: code and reason of the close frame (RFC 6455 §7.4).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Farewell {
    code: u16,
    reason: &'static str,
}

impl Farewell {
    const CLIENT_LEFT: Self = Self {
        code: 1000,
        reason: "",
    };
    const GOING_DOWN: Self = Self {
        code: 1001,
        reason: "server is going down",
    };
    const PROTOCOL: Self = Self {
        code: 1002,
        reason: "protocol version",
    };
    const NOT_TEXT: Self = Self {
        code: 1003,
        reason: "only text messages are read",
    };
    const HELLO: Self = Self {
        code: 1008,
        reason: "hello expected",
    };
    const CODEC: Self = Self {
        code: 1008,
        reason: "no common codec",
    };
    const MALFORMED: Self = Self {
        code: 1008,
        reason: "too many malformed messages",
    };
    const UNREAD: Self = Self {
        code: 1008,
        reason: "too many unread messages",
    };
    const ABORTED: Self = Self {
        code: 1006,
        reason: "the connection was aborted",
    };
    const TOO_LONG: Self = Self {
        code: 1009,
        reason: "message is too long or broken",
    };
    const FULL: Self = Self {
        code: 1013,
        reason: "every session is taken",
    };
    const TAKEN_OVER: Self = Self {
        code: 4001,
        reason: "another connection took over",
    };
    const SILENT: Self = Self {
        code: 4002,
        reason: "connection is silent",
    };
}

/// Checks the request and turns it into a WebSocket.
pub(crate) async fn upgrade(
    State(app): State<Arc<App>>,
    upgrade: Result<WebSocketUpgrade, WebSocketUpgradeRejection>,
) -> Response {
    match check(&app, upgrade) {
        Ok(upgrade) => {
            let limits = app.limits;
            // Room for the largest frame, uncompressed, twice.
            let largest = usize::try_from(limits.max_pixels * 8).unwrap_or(usize::MAX);
            let write_buffer = 128 << 10;
            upgrade
                .max_message_size(limits.max_message_bytes)
                .max_frame_size(limits.max_message_bytes)
                .write_buffer_size(write_buffer)
                .max_write_buffer_size(largest.max(2 * write_buffer))
                .on_upgrade(|socket| {
                    let sockets = app.sockets.clone();
                    sockets.track_future(converse(app, socket))
                })
        }
        Err(problem) => problem.into_response(),
    }
}

fn check(
    app: &App,
    upgrade: Result<WebSocketUpgrade, WebSocketUpgradeRejection>,
) -> Result<WebSocketUpgrade, Problem> {
    let upgrade = upgrade.map_err(|rejection| {
        Problem::new(
            ErrorCode::Malformed,
            format!("this is a WebSocket: {rejection}"),
        )
    })?;
    if app.shutdown.is_cancelled() {
        return Err(Problem::new(
            ErrorCode::NotReady,
            "the server is going down",
        ));
    }
    // Sockets that have not said hello are no sessions yet. There is room for them beside all sessions, since
    // only the hello says who resumes a session of his own.
    if app.sockets.len() >= 3 * app.limits.max_sessions {
        return Err(Problem::new(
            ErrorCode::TooManySessions,
            "too many connections",
        ));
    }
    Ok(upgrade)
}

/// A session in the hands of a connection; given back however the conversation ends.
struct Connection {
    app: Arc<App>,
    session: Arc<Session>,
    number: u64,
}

impl Drop for Connection {
    fn drop(&mut self) {
        self.app.sessions.disconnect(&self.session, self.number);
    }
}

async fn converse(app: Arc<App>, socket: WebSocket) {
    let (mut sink, mut stream) = socket.split();
    let farewell = match hello::receive(&app, &mut stream).await {
        Ok(connection) => {
            let session = connection.session.id;
            tracing::info!(session, "connected");
            let farewell = talk(&connection, &mut sink, &mut stream).await;
            // What explains the end goes out before it.
            let flushed = write::messages_only(&connection.session, connection.number, &mut sink);
            if tokio::time::timeout(CLOSE_WITHIN, flushed).await.is_err() {
                tracing::debug!(session, "the last messages did not leave in time");
            }
            let Farewell { code, reason } = farewell;
            tracing::info!(session, code, reason, "disconnected");
            farewell
        }
        Err(hello::Refused { farewell, error }) => {
            let Farewell { code, reason } = farewell;
            tracing::info!(code, reason, "refused");
            if let Some(error) = error {
                let message = ServerMessage::Error(error);
                let sent = send(&mut sink, &message);
                if tokio::time::timeout(CLOSE_WITHIN, sent).await.is_err() {
                    tracing::debug!("the refusal did not leave in time");
                }
            }
            farewell
        }
    };
    let left = farewell == Farewell::CLIENT_LEFT;
    telemetry::socket_closed(if left {
        "the client left"
    } else {
        farewell.reason
    });
    if farewell != Farewell::ABORTED {
        close(sink, stream, farewell).await;
    }
}

/// What it tells that nothing can be sent: the client said goodbye before, or its connection broke.
fn unsent(error: axum::Error) -> Farewell {
    match error.into_inner().downcast_ref::<WebSocketError>() {
        Some(
            WebSocketError::ConnectionClosed
            | WebSocketError::AlreadyClosed
            | WebSocketError::Protocol(ProtocolError::SendAfterClosing),
        ) => Farewell::CLIENT_LEFT,
        _ => Farewell::ABORTED,
    }
}

/// What a connection that broke tells: a message that is no message, or that nobody is there any more.
fn broken(error: axum::Error) -> Farewell {
    match error.into_inner().downcast_ref::<WebSocketError>() {
        Some(WebSocketError::Protocol(ProtocolError::ResetWithoutClosingHandshake)) => {
            Farewell::ABORTED
        }
        Some(
            WebSocketError::Capacity(_) | WebSocketError::Utf8(_) | WebSocketError::Protocol(_),
        ) => Farewell::TOO_LONG,
        _ => Farewell::ABORTED,
    }
}

/// Reads and writes until one side has enough.
async fn talk(connection: &Connection, sink: &mut Sink, stream: &mut Stream) -> Farewell {
    let Connection {
        app,
        session,
        number,
    } = connection;
    tokio::select! {
        farewell = read::run(app, session, stream) => farewell,
        farewell = write::run(app, session, *number, sink) => farewell,
        () = session.taken_from(*number) => Farewell::TAKEN_OVER,
        () = app.shutdown.cancelled() => Farewell::GOING_DOWN,
    }
}

/// Sends a message as JSON.
async fn send(sink: &mut Sink, message: &ServerMessage) -> Result<(), axum::Error> {
    let text = serde_json::to_string(message).map_err(axum::Error::new)?;
    sink.send(Message::Text(text.into())).await
}

/// Says goodbye and waits a moment for the answer, so that the reason arrives.
async fn close(mut sink: Sink, mut stream: Stream, farewell: Farewell) {
    let Farewell { code, reason } = farewell;
    let handshake = async {
        let frame = CloseFrame {
            code,
            reason: reason.into(),
        };
        if sink.send(Message::Close(Some(frame))).await.is_ok() {
            while let Some(Ok(_)) = stream.next().await {}
        }
    };
    if tokio::time::timeout(CLOSE_WITHIN, handshake).await.is_err() {
        tracing::debug!("the client did not answer the close");
    }
}

/// An error message about no particular path.
fn error(code: ErrorCode, message: impl Into<String>, input: Option<u64>) -> ErrorMessage {
    ErrorMessage {
        code,
        path: None,
        message: message.into(),
        input,
    }
}
