//! What the server says: messages in order, then the newest frame with its statistics.

use std::time::Instant;

use axum::body::Bytes;
use axum::extract::ws::Message;
use futures_util::SinkExt as _;
use tyndall_stream::protocol::ServerMessage;

use super::{Farewell, Sink, send, unsent};
use crate::bell::lock;
use crate::outbox::{EncodedFrame, Outgoing};
use crate::server::App;
use crate::session::Session;
use crate::telemetry;

/// Writes until the client leaves or stops reading.
pub(super) async fn run(app: &App, session: &Session, number: u64, sink: &mut Sink) -> Farewell {
    loop {
        let Some(outgoing) = session.outbox.take(number) else {
            let filled = session.outbox.filled();
            if tokio::time::timeout(app.limits.ping_every, filled)
                .await
                .is_ok()
            {
                continue;
            }
            // The answer keeps the reader from taking the client for dead.
            match sink.send(Message::Ping(Bytes::new())).await {
                Ok(()) => continue,
                Err(gone) => return unsent(gone),
            }
        };
        let sent = async {
            match outgoing {
                Outgoing::Message(message) => send(sink, &message).await,
                Outgoing::Frame(frame) => {
                    // The render thread may begin another one.
                    app.sessions.bell.ring();
                    send_frame(session, sink, frame).await
                }
            }
        };
        match tokio::time::timeout(app.limits.send_within, sent).await {
            Ok(Ok(())) => {}
            Ok(Err(gone)) => return unsent(gone),
            Err(_elapsed) => return Farewell::SILENT,
        }
    }
}

/// Writes the messages that wait, and no frames.
pub(super) async fn messages_only(session: &Session, number: u64, sink: &mut Sink) {
    while let Some(Outgoing::Message(message)) = session.outbox.take(number) {
        if send(sink, &message).await.is_err() {
            return;
        }
    }
}

async fn send_frame(
    session: &Session,
    sink: &mut Sink,
    frame: EncodedFrame,
) -> Result<(), axum::Error> {
    let EncodedFrame {
        header,
        message,
        stats,
    } = frame;
    lock(&session.pacing).sent(header.frame_id, Instant::now());
    telemetry::frame_sent(message.len());
    sink.send(Message::Binary(message)).await?;
    send(sink, &ServerMessage::Stats(stats)).await
}
