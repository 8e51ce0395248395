//! The one thread that owns the device.
//!
//! It compares what each session wants with what it last rendered and starts one frame a session
//! in turn, so that no session starves another. A session with two frames on their way, a hidden
//! page and a converged picture get nothing. With nothing to do it sleeps on a bell and uses no
//! CPU.
//!
//! - `round`: the loop;
//! - `seat`: a session's place at the device;
//! - `show`: brings a picture to a wish, prepared first, with `fit` smaller where memory is short;
//! - `stills`: pictures of jobs, in slices between those of sessions;
//! - `effort`: how many pixels a moving picture gets;
//! - `refusal`: pictures that cannot be made, and frames that cannot be read;
//! - `recovery`: a lost device or a renderer that panicked, who may have lost it, and another one;
//! - `readiness`: what the routes ask.

mod effort;
mod fit;
mod readiness;
mod recovery;
mod refusal;
mod round;
mod seat;
mod show;
mod stills;

use std::sync::Arc;
use std::thread::JoinHandle;
use std::time::Duration;

use tokio_util::sync::CancellationToken;
use tyndall_scene::Scene;
use tyndall_stream::protocol::{Adapter, AdapterKind};

use self::round::RenderThread;
use self::stills::Stills;
use crate::backend::{Backend, OpenBackend};
use crate::encoder_pool::EncoderPool;
use crate::options::ServeError;
use crate::sessions::Sessions;
use crate::stills::Desk;

pub(crate) use self::readiness::{Place, Readiness};
pub(crate) use self::stills::MOST_STILLS;

/// Starts the thread and waits until its device is open. `first` is the scene that pages open first.
pub(crate) async fn start<B: Backend + 'static>(
    mut open: OpenBackend<B>,
    (sessions, desk): (Arc<Sessions>, Arc<Desk>),
    encoders: EncoderPool,
    readiness: Arc<Readiness>,
    shutdown: CancellationToken,
    frame_budget: Option<Duration>,
    first: Arc<Scene>,
) -> Result<(JoinHandle<()>, Adapter), ServeError> {
    let fault = |reason: String| ServeError::Thread {
        name: "render",
        reason,
    };
    let (tell, told) = tokio::sync::oneshot::channel();
    let thread = std::thread::Builder::new()
        .name("render".to_owned())
        .spawn(move || {
            // Whatever ends this thread ends the service: without it there is nothing to serve.
            let _ends_service = shutdown.clone().drop_guard();
            let mut backend = match open() {
                Ok(backend) => backend,
                Err(error) => {
                    // The starter only goes away together with the process.
                    drop(tell.send(Err(error)));
                    return;
                }
            };
            let adapter = backend.adapter();
            readiness.opened(backend.plan_limits());
            let software = adapter.kind == AdapterKind::Software;
            if tell.send(Ok(adapter)).is_ok() {
                if let Err(error) = backend.warm_up(&first) {
                    tracing::warn!(%error, "no frame of the first scene could be rendered");
                }
                RenderThread {
                    backend: Some(backend),
                    open,
                    sessions,
                    encoders,
                    readiness: Arc::clone(&readiness),
                    shutdown,
                    seats: Vec::new(),
                    stills: Stills::new(desk),
                    turn: 0,
                    software,
                    frame_budget,
                    device_errors: 0,
                    working_for: None,
                }
                .run();
            }
            readiness.set(false);
        })
        .map_err(|error| fault(error.to_string()))?;
    match told.await {
        Ok(opened) => Ok((thread, opened?)),
        Err(_closed) => Err(fault("ended while opening the device".to_owned())),
    }
}
