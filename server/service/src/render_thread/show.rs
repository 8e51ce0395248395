//! Brings a session's picture to its wish: prepared first, and smaller where memory is short.

use std::sync::Arc;
use std::time::Duration;

use tyndall_render::{Prepared, RenderError};
use tyndall_scene::Scene;
use tyndall_stream::protocol::{Notice, ServerMessage};

use super::fit::{Fit, MOST_REDUCTIONS, smaller};
use super::seat::{Picture, Seat};
use crate::backend::Backend;
use crate::session::Wish;

/// Time of traced samples in a frame of a picture at rest; the device may allow less.
const LONG_TRACING: Duration = Duration::from_secs(1);

/// Makes the seat's view show the wish; as long as something is being prepared for it, nothing changes.
pub(super) fn show<B: Backend>(
    backend: &mut B,
    seat: &mut Seat<B::View>,
    wish: &Wish,
) -> Result<Prepared, RenderError> {
    let before = seat.picture.as_ref().map(|picture| picture.full);
    let mut reductions = 0;
    loop {
        let size = seat.size_for(wish);
        let (needed, allowed) = match bring(backend, seat, wish, size) {
            Ok(Prepared::Ready) => break,
            Ok(Prepared::Pending) => {
                seat.preparing = true;
                return Ok(Prepared::Pending);
            }
            Err(RenderError::Memory { needed, allowed }) => (needed, allowed),
            Err(other) => return Err(other),
        };
        let next = smaller(size, needed, allowed).filter(|_| reductions < MOST_REDUCTIONS);
        let Some(next) = next else {
            return Err(RenderError::Memory { needed, allowed });
        };
        reductions += 1;
        seat.fit = Some(Fit::new(wish, next));
    }
    seat.preparing = false;
    seat.refused = None;
    let full = seat.full_size(wish);
    if let Some(picture) = &mut seat.picture {
        picture.full = full;
        // A picture at rest that nobody waits beside is traced longer at once.
        let at_rest = seat.is_alone.then_some(LONG_TRACING);
        let tracing = seat.effort.tracing(full).or(at_rest);
        backend.trace_within(&mut picture.view, tracing);
    }
    if full != (wish.width, wish.height) && before != Some(full) {
        tell_smaller(seat, wish, full);
    }
    Ok(Prepared::Ready)
}

/// Makes the seat's view show the wish in a size. Unit: pixel.
fn bring<B: Backend>(
    backend: &mut B,
    seat: &mut Seat<B::View>,
    wish: &Wish,
    size: (u32, u32),
) -> Result<Prepared, RenderError> {
    let (width, height) = size;
    if let Some(picture) = &mut seat.picture
        && Arc::ptr_eq(&picture.shown.scene, &wish.scene)
        && picture.size == size
    {
        picture.shown = wish.clone();
        return Ok(Prepared::Ready);
    }
    if backend.prepare(&wish.scene, width, height)? == Prepared::Pending {
        return Ok(Prepared::Pending);
    }
    let picture = if let Some(picture) = &mut seat.picture {
        if picture.size != size {
            backend.resize_view(&mut picture.view, width, height)?;
            picture.size = size;
        }
        if !Arc::ptr_eq(&picture.shown.scene, &wish.scene) {
            backend.update_view(&mut picture.view, Arc::clone(&wish.scene))?;
        }
        picture.shown = wish.clone();
        picture
    } else {
        let view = backend.create_view(Arc::clone(&wish.scene), width, height)?;
        seat.picture.insert(Picture {
            view,
            shown: wish.clone(),
            size,
            full: size,
        })
    };
    seat.session.outbox.set_plan(backend.plan(&picture.view));
    Ok(Prepared::Ready)
}

/// While a wish is being prepared, shows what is there from where the wish's camera is. `None` if that
/// is nothing, or another scene than the one the client has opened.
pub(super) fn show_meanwhile<B: Backend>(
    backend: &mut B,
    seat: &mut Seat<B::View>,
    wish: &Wish,
) -> Result<Option<Wish>, RenderError> {
    let same_scene = |picture: &&mut Picture<B::View>| picture.shown.epoch == wish.epoch;
    let Some(picture) = seat.picture.as_mut().filter(same_scene) else {
        return Ok(None);
    };
    if picture.shown.scene.camera != wish.scene.camera {
        let scene = Arc::new(Scene {
            camera: wish.scene.camera,
            ..Scene::clone(&picture.shown.scene)
        });
        let steered = Wish {
            scene: Arc::clone(&scene),
            ..picture.shown.clone()
        };
        seat.asked = Some(steered.clone());
        backend.update_view(&mut picture.view, scene)?;
        picture.shown = steered;
    }
    seat.asked = Some(picture.shown.clone());
    Ok(Some(picture.shown.clone()))
}

/// Tells the session that its picture has fewer pixels than it asked for.
fn tell_smaller<V>(seat: &Seat<V>, wish: &Wish, (width, height): (u32, u32)) {
    tracing::warn!(
        session = seat.session.id,
        width,
        height,
        "a picture is smaller than its wish"
    );
    let message = format!(
        "device memory is short: the picture has {width}×{height} pixels instead of {}×{}",
        wish.width, wish.height
    );
    seat.session
        .outbox
        .push(ServerMessage::Notice(Notice { message }));
}
