//! The first message: opens a session or goes on with one.

use std::sync::Arc;
use std::time::Instant;

use axum::extract::ws::Message;
use futures_util::StreamExt as _;
use tyndall_scene::presets;
use tyndall_stream::pacing::Accepts;
use tyndall_stream::protocol::{
    ClientMessage, ErrorCode, ErrorMessage, Hello, Notice, PROTOCOL_VERSION, Preset, SceneMessage,
    ServerMessage, StreamLimits, Welcome,
};

use super::{Connection, Farewell, Stream, broken, error};
use crate::options::ServiceLimits;
use crate::server::App;
use crate::session::Session;
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
        Ok(Some(Err(error))) => {
            return Err(Refused {
                farewell: broken(error),
                error: None,
            });
        }
        Ok(None) => {
            return Err(Refused {
                farewell: Farewell::ABORTED,
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
    open(app, &hello, accepts).await
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

async fn open(app: &Arc<App>, hello: &Hello, accepts: Accepts) -> Result<Connection, Refused> {
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
    // Before anything waits, so that no frame is begun in another size.
    let input = session.input();
    let told = resize(&app.limits, session, input, hello.width, hello.height);
    session.outbox.push(ServerMessage::Welcome(Welcome {
        protocol: PROTOCOL_VERSION,
        version: env!("CARGO_PKG_VERSION").to_owned(),
        session: session.token.clone(),
        resumed,
        adapter: app.adapter.clone(),
        presets: presets::names().iter().map(preset).collect(),
        limits: limits(&app.limits),
    }));
    if let Some(scene) = scene_message(session).await {
        session.outbox.push(ServerMessage::Scene(Box::new(scene)));
    }
    if let Some(told) = told {
        session.outbox.push(told);
    }
    app.sessions.bell.ring();
    Ok(connection)
}

/// Gives a session's picture a size. One above the limits becomes the largest one of its shape within them,
/// and one without pixels is refused: the session keeps its size, as a page that is not laid out yet corrects
/// itself. What the client is told of it. Unit: pixel.
pub(super) fn resize(
    limits: &ServiceLimits,
    session: &Session,
    input: u64,
    width: u32,
    height: u32,
) -> Option<ServerMessage> {
    let ServiceLimits {
        max_pixels,
        max_side,
        ..
    } = *limits;
    let allowed = format!("allowed are 1 to {max_side} a side and {max_pixels} in all");
    if width == 0 || height == 0 {
        let message = format!("found {width}x{height} pixels, {allowed}");
        let refused = error(ErrorCode::InvalidSize, message, Some(input));
        return Some(ServerMessage::Error(refused));
    }
    let (fitting_width, fitting_height) = fitting(limits, width, height);
    session.resize(input, fitting_width, fitting_height, Instant::now());
    ((fitting_width, fitting_height) != (width, height)).then(|| {
        let message = format!(
            "the picture has {fitting_width}×{fitting_height} pixels instead of {width}×{height}: {allowed}"
        );
        ServerMessage::Notice(Notice { message })
    })
}

/// The largest size of this shape within the limits; no side is 0. Unit: pixel.
fn fitting(limits: &ServiceLimits, width: u32, height: u32) -> (u32, u32) {
    let (w, h) = (f64::from(width), f64::from(height));
    let by_side = f64::from(limits.max_side) / w.max(h);
    let by_pixels = (limits.max_pixels as f64 / (w * h)).sqrt();
    let factor = by_side.min(by_pixels);
    if factor >= 1.0 {
        return (width, height);
    }
    let most = limits.max_side.max(1);
    let side = |side: f64| ((side * factor) as u32).clamp(1, most);
    // A side of a fraction of a pixel became one: the other one is all there may be.
    let all = u32::try_from(limits.max_pixels.max(1)).unwrap_or(u32::MAX);
    (side(w).min(all), side(h).min(all))
}

/// The message that describes a session's scene, put together on a blocking thread; `None` if that broke.
pub(super) async fn scene_message(session: &Arc<Session>) -> Option<SceneMessage> {
    let owned = Arc::clone(session);
    let message = tokio::task::spawn_blocking(move || owned.scene_message()).await;
    if let Err(broken) = &message {
        tracing::error!(session = session.id, %broken, "a scene could not be described");
    }
    message.ok()
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_size_above_the_limits_becomes_the_largest_of_its_shape() {
        let limits = ServiceLimits {
            max_pixels: 3840 * 2160,
            max_side: 8192,
            ..ServiceLimits::default()
        };
        assert_eq!(fitting(&limits, 1280, 720), (1280, 720));
        assert_eq!(fitting(&limits, 3840, 2160), (3840, 2160));
        assert_eq!(fitting(&limits, 7680, 4320), (3840, 2160));
        assert_eq!(fitting(&limits, 16_384, 100), (8192, 50));
        assert_eq!(fitting(&limits, u32::MAX, 1), (8192, 1));
        for (width, height) in [(u32::MAX, u32::MAX), (1, u32::MAX), (9000, 8000)] {
            let (w, h) = fitting(&limits, width, height);
            assert!(w >= 1 && h >= 1 && w <= 8192 && h <= 8192, "{w}×{h}");
            assert!(u64::from(w) * u64::from(h) <= limits.max_pixels, "{w}×{h}");
        }
    }
}
