//! Accepts connections: a bounded number of them, none of which may keep the server waiting.
//!
//! A connection has a time for the head of each request, and another one for every pause in which its
//! client takes nothing of an answer. Where as many are open as there may be, a newcomer gets the place of
//! the one that has said nothing for longest, so that half a request holds up nobody.

use std::collections::VecDeque;
use std::convert::Infallible;
use std::net::SocketAddr;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::time::Duration;

use axum::Router;
use axum::extract::Request;
use axum::response::Response;
use hyper::body::Incoming;
use hyper::server::conn::http1;
use hyper::service::service_fn;
use hyper_util::rt::{TokioIo, TokioTimer};
use tokio::io::AsyncWriteExt as _;
use tokio::net::{TcpListener, TcpStream};
use tokio_io_timeout::TimeoutStream;
use tokio_util::sync::CancellationToken;
use tokio_util::task::TaskTracker;
use tower_service::Service as _;

use crate::bell::lock;
use crate::telemetry;

/// Rest after the system gave no connection, for want of file descriptors for example.
const AFTER_FAULT: Duration = Duration::from_millis(100);
/// How long saying that there is no room may take.
const NO_ROOM_WITHIN: Duration = Duration::from_millis(200);

/// Where a request comes from, as an extension of it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Peer(pub(crate) SocketAddr);

/// Bounds of connections.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ConnectionLimits {
    /// Open at once, WebSockets aside.
    pub(crate) most: usize,
    /// Time for the head of a request.
    pub(crate) header_within: Duration,
    /// Longest pause in which a client takes nothing of an answer.
    pub(crate) send_within: Duration,
}

/// An open connection.
#[derive(Debug)]
struct Open {
    /// Whether it waits for the head of a request.
    silent: AtomicBool,
    /// Ends it.
    end: CancellationToken,
}

/// The open connections, the oldest first.
#[derive(Debug, Clone, Default)]
struct Register(Arc<Mutex<VecDeque<Arc<Open>>>>);

impl Register {
    /// A place for another connection, if need be that of the oldest silent one.
    fn admit(&self, most: usize) -> Option<Arc<Open>> {
        let mut open = lock(&self.0);
        if open.len() >= most {
            let silent = |one: &Arc<Open>| one.silent.load(Ordering::Relaxed);
            let evicted = open.iter().position(silent)?;
            if let Some(evicted) = open.remove(evicted) {
                evicted.end.cancel();
                telemetry::connection_refused("evicted");
            }
        }
        let new = Arc::new(Open {
            silent: AtomicBool::new(true),
            end: CancellationToken::new(),
        });
        open.push_back(Arc::clone(&new));
        telemetry::connections(open.len());
        Some(new)
    }

    fn remove(&self, gone: &Arc<Open>) {
        let mut open = lock(&self.0);
        open.retain(|one| !Arc::ptr_eq(one, gone));
        telemetry::connections(open.len());
    }
}

/// Accepts connections until shutdown; those that are open then finish their request in `tracker`.
pub(crate) async fn serve(
    listener: TcpListener,
    router: Router,
    limits: ConnectionLimits,
    tracker: TaskTracker,
    shutdown: CancellationToken,
) {
    let register = Register::default();
    loop {
        let accepted = tokio::select! {
            accepted = listener.accept() => accepted,
            () = shutdown.cancelled() => return,
        };
        let (stream, peer) = match accepted {
            Ok(accepted) => accepted,
            Err(error) => {
                tracing::warn!(%error, "the system gave no connection");
                tokio::time::sleep(AFTER_FAULT).await;
                continue;
            }
        };
        let Some(open) = register.admit(limits.most) else {
            telemetry::connection_refused("full");
            tracker.spawn(no_room(stream));
            continue;
        };
        let (register, router) = (register.clone(), router.clone());
        let shutdown = shutdown.clone();
        tracker.spawn(async move {
            // Frames and acknowledgements must not wait for each other.
            if let Err(error) = stream.set_nodelay(true) {
                tracing::debug!(%error, "TCP_NODELAY was refused");
            }
            converse(stream, peer, router, limits, &open, &shutdown).await;
            register.remove(&open);
        });
    }
}

/// Answers the requests of one connection.
async fn converse(
    stream: TcpStream,
    peer: SocketAddr,
    router: Router,
    limits: ConnectionLimits,
    open: &Arc<Open>,
    shutdown: &CancellationToken,
) {
    let mut stream = TimeoutStream::new(stream);
    stream.set_write_timeout(Some(limits.send_within));
    let answer = |mut request: Request<Incoming>| {
        open.silent.store(false, Ordering::Relaxed);
        request.extensions_mut().insert(Peer(peer));
        let (mut router, open) = (router.clone(), Arc::clone(open));
        async move {
            let answered: Result<Response, Infallible> = router.call(request).await;
            open.silent.store(true, Ordering::Relaxed);
            answered
        }
    };
    let connection = http1::Builder::new()
        .timer(TokioTimer::new())
        .header_read_timeout(limits.header_within)
        .serve_connection(TokioIo::new(Box::pin(stream)), service_fn(answer))
        .with_upgrades();
    let mut connection = std::pin::pin!(connection);
    let ended = tokio::select! {
        ended = connection.as_mut() => ended,
        () = open.end.cancelled() => return,
        () = shutdown.cancelled() => {
            connection.as_mut().graceful_shutdown();
            connection.await
        }
    };
    if let Err(error) = ended {
        tracing::debug!(%error, "a connection broke");
    }
}

/// Says that there is no room, to whom it still reaches.
async fn no_room(mut stream: TcpStream) {
    let text = b"HTTP/1.1 503 Service Unavailable\r\nretry-after: 5\r\ncontent-length: 0\r\nconnection: close\r\n\r\n";
    let said = async {
        stream.write_all(text).await?;
        stream.shutdown().await
    };
    if !matches!(tokio::time::timeout(NO_ROOM_WITHIN, said).await, Ok(Ok(()))) {
        tracing::debug!("a client without room left first");
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_newcomer_gets_the_place_of_the_oldest_silent_connection_and_of_no_other() {
        let register = Register::default();
        let all: Vec<_> = (0..3).map(|_| register.admit(3).unwrap()).collect();
        all[0].silent.store(false, Ordering::Relaxed);
        let new = register.admit(3).unwrap();
        let ended: Vec<bool> = all.iter().map(|open| open.end.is_cancelled()).collect();
        assert_eq!(ended, [false, true, false]);
        for open in [&all[2], &new] {
            open.silent.store(false, Ordering::Relaxed);
        }
        assert!(
            register.admit(3).is_none(),
            "all of them are being answered"
        );
        register.remove(&all[0]);
        assert!(register.admit(3).is_some());
    }
}
