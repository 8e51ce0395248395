//! The first message: opens a session or goes on with one.

use std::sync::Arc;
use std::time::Instant;

use axum::extract::ws::Message;
use futures_util::StreamExt as _;
use tyndall_scene::presets;
use tyndall_stream::pacing::Accepts;
use tyndall_stream::protocol::{
    ClientMessage, ErrorCode, ErrorMessage, Hello, PROTOCOL_VERSION, Preset, ServerMessage,
    StreamLimits, Welcome,
};

use super::{Connection, Farewell, Stream, error};
use crate::options::ServiceLimits;
use crate::server::App;
use crate::telemetry;

/// Why there is no session.
pub(super) struct Refused {
    pub(super) farewell: Farewell,
    pub(super) error: Option<ErrorMessage>,
}

impl Refused {
    fn new(farewell: Farewell, code: ErrorCode, message: impl Into<String>) -> Self {
        Self {
            farewell,
            error: Some(error(code, message, None)),
        }
    }
}

/// Waits for the hello and queues the answers to it.
pub(super) async fn receive(app: &Arc<App>, stream: &mut Stream) -> Result<Connection, Refused> {
    let within = app.limits.hello_within;
    let first = tokio::select! {
        first = tokio::time::timeout(within, first_message(stream)) => first,
        () = app.shutdown.cancelled() => {
            return Err(Refused { farewell: Farewell::GOING_DOWN, error: None });
        }
    };
    let text = match first {
        Ok(Some(Ok(Message::Text(text)))) => text,
        Ok(Some(Ok(Message::Binary(_)))) => {
            let message = "the first message must be a hello as JSON text";
            return Err(Refused::new(
                Farewell::NOT_TEXT,
                ErrorCode::Malformed,
                message,
            ));
        }
        Ok(Some(Err(_broken))) => {
            return Err(Refused {
                farewell: Farewell::TOO_LONG,
                error: None,
            });
        }
        Ok(_closed) => {
            return Err(Refused {
                farewell: Farewell::CLIENT_LEFT,
                error: None,
            });
        }
        Err(_elapsed) => {
            let message = format!("no hello came within {} s", within.as_secs_f32());
            return Err(Refused::new(
                Farewell::HELLO,
                ErrorCode::HelloExpected,
                message,
            ));
        }
    };
    let hello = parse(&text)?;
    let accepts = Accepts::from_list(&hello.codecs()).ok_or_else(|| {
        let message = "accept must name jpeg or png";
        Refused::new(Farewell::CODEC, ErrorCode::NoCommonCodec, message)
    })?;
    open(app, &hello, accepts)
}

/// The first message that is no ping.
async fn first_message(stream: &mut Stream) -> Option<Result<Message, axum::Error>> {
    loop {
        match stream.next().await? {
            Ok(Message::Ping(_) | Message::Pong(_)) => {}
            other => return Some(other),
        }
    }
}

fn parse(text: &str) -> Result<Hello, Refused> {
    let message = ClientMessage::from_json(text).map_err(|refused| {
        telemetry::malformed_message();
        Refused {
            farewell: Farewell::HELLO,
            error: Some(ErrorMessage {
                path: refused.path().map(str::to_owned),
                ..error(ErrorCode::Malformed, refused.to_string(), None)
            }),
        }
    })?;
    let ClientMessage::Hello(hello) = message else {
        let message = "the first message must be a hello";
        return Err(Refused::new(
            Farewell::HELLO,
            ErrorCode::HelloExpected,
            message,
        ));
    };
    if hello.protocol != PROTOCOL_VERSION {
        let message = format!(
            "this server speaks protocol {PROTOCOL_VERSION}, the client {}; reload the page",
            hello.protocol
        );
        return Err(Refused::new(
            Farewell::PROTOCOL,
            ErrorCode::ProtocolVersion,
            message,
        ));
    }
    Ok(hello)
}

fn open(app: &Arc<App>, hello: &Hello, accepts: Accepts) -> Result<Connection, Refused> {
    let old = hello
        .resume
        .as_deref()
        .and_then(|token| app.sessions.resume(token, accepts));
    let resumed = old.is_some();
    let (session, number) = if let Some(old) = old {
        old
    } else {
        let created = app.sessions.create(&app.scenes.first, accepts);
        let session = created.map_err(|full| {
            Refused::new(Farewell::FULL, ErrorCode::TooManySessions, full.to_string())
        })?;
        let number = session.connection();
        (session, number)
    };
    // From here on the session is given back if anything goes wrong.
    let connection = Connection {
        app: Arc::clone(app),
        session,
        number,
    };
    let session = &connection.session;
    session.outbox.push(ServerMessage::Welcome(Welcome {
        protocol: PROTOCOL_VERSION,
        version: env!("CARGO_PKG_VERSION").to_owned(),
        session: session.token.clone(),
        resumed,
        adapter: app.adapter.clone(),
        presets: presets::names().iter().map(preset).collect(),
        limits: limits(&app.limits),
    }));
    session
        .outbox
        .push(ServerMessage::Scene(Box::new(session.scene_message())));
    match check_size(&app.limits, hello.width, hello.height) {
        Ok(()) => {
            let input = session.wish().input;
            session.resize(input, hello.width, hello.height, Instant::now());
        }
        // The session keeps its size: a page that is not laid out yet corrects itself.
        Err(message) => {
            let refused = error(ErrorCode::InvalidSize, message, None);
            session.outbox.push(ServerMessage::Error(refused));
        }
    }
    app.sessions.bell.ring();
    Ok(connection)
}

/// Why a size is refused, in words. Unit: pixel.
pub(super) fn check_size(limits: &ServiceLimits, width: u32, height: u32) -> Result<(), String> {
    let ServiceLimits {
        max_pixels,
        max_side,
        ..
    } = *limits;
    let sides = 1..=max_side;
    let pixels = u64::from(width) * u64::from(height);
    if sides.contains(&width) && sides.contains(&height) && pixels <= max_pixels {
        return Ok(());
    }
    Err(format!(
        "found {width}x{height} pixels, allowed are 1 to {max_side} a side and {max_pixels} in all"
    ))
}

fn preset(info: &presets::PresetInfo) -> Preset {
    Preset {
        name: info.name.to_owned(),
        title: info.title.to_owned(),
        summary: info.summary.to_owned(),
    }
}

fn limits(limits: &ServiceLimits) -> StreamLimits {
    StreamLimits {
        max_pixels: limits.max_pixels,
        max_side: limits.max_side,
        max_message_bytes: limits.max_message_bytes as u64,
        resume_seconds: limits.resume_for.as_secs(),
    }
}
