//! What a session is told when its picture cannot be made, and when it is not tried again.

use tyndall_render::{FailedFrame, RenderError};
use tyndall_stream::protocol::{ErrorCode, ErrorMessage, ServerMessage};

use super::seat::{Seat, same_wish};
use crate::session::{Session, Wish};
use crate::telemetry;

/// Frames of one wish in a row that cannot be read before the wish is refused.
const MOST_UNREAD: u32 = 3;

/// Errors of the device.
#[derive(Debug)]
pub(super) struct Loss {
    pub(super) error: RenderError,
    /// The session whose call ended in the error; `None` where the error belongs to no call of a session.
    pub(super) caller: Option<u64>,
}

impl Loss {
    /// An error that belongs to no session's call.
    pub(super) fn of_nobody(error: RenderError) -> Self {
        Self {
            error,
            caller: None,
        }
    }
}

/// Whether only another device helps.
pub(super) fn is_loss(error: &RenderError) -> bool {
    matches!(
        error,
        RenderError::DeviceLost(_) | RenderError::Timeout { .. }
    )
}

/// Does not try the wish again until it changes, and says why.
pub(super) fn refuse<V>(seat: &mut Seat<V>, wish: Wish, why: String) {
    telemetry::render_error();
    tracing::error!(session = seat.session.id, why, "a picture was refused");
    let input = Some(wish.input);
    seat.clear();
    seat.fit = None;
    seat.suspect = None;
    seat.refused = Some(wish);
    tell(&seat.session, why, input);
}

/// Gives up a frame that could not be read. Its view no longer knows what it shows, so the next frame
/// begins another one; a wish that fails again and again is refused.
pub(super) fn unread<V>(seat: &mut Seat<V>, failed: &FailedFrame) {
    let Some(flight) = seat.flight.as_ref() else {
        return;
    };
    let wish = flight.wish.clone();
    let before = match &seat.unread {
        Some((known, count)) if same_wish(known, &wish) => *count,
        _ => 0,
    };
    let count = before + 1;
    if count >= MOST_UNREAD {
        seat.unread = None;
        let why = format!("{failed}; {count} in a row: not tried again until something changes");
        refuse(seat, wish, why);
        return;
    }
    telemetry::render_error();
    tracing::warn!(session = seat.session.id, %failed, "a frame is made again");
    seat.clear();
    seat.unread = Some((wish, count));
    let message = format!("{failed}; it is made again");
    tell(&seat.session, message, None);
}

/// Tells the session what broke; with an input number, that this input is not shown.
pub(super) fn tell(session: &Session, message: String, input: Option<u64>) {
    let code = ErrorCode::RenderFailed;
    session.outbox.push(ServerMessage::Error(ErrorMessage {
        code,
        path: None,
        message,
        input,
    }));
}
