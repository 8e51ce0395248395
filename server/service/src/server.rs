//! Binds, starts the threads, serves, and goes down in order.

use std::io::Write as _;
use std::net::SocketAddr;
use std::sync::Arc;

use axum::serve::ListenerExt as _;
use metrics_exporter_prometheus::PrometheusHandle;
use tokio::net::TcpListener;
use tokio_util::sync::CancellationToken;
use tokio_util::task::TaskTracker;
use tyndall_render::check_supported;
use tyndall_stream::protocol::Adapter;

use crate::backend::{Backend, OpenBackend, Wgpu};
use crate::encoder_pool::EncoderPool;
use crate::guides::Guides;
use crate::options::{ServeError, ServeOptions, ServiceLimits};
use crate::render_thread::{self, Readiness};
use crate::routes;
use crate::scenes::Scenes;
use crate::sessions::Sessions;
use crate::telemetry;

/// What handlers share.
#[derive(Debug)]
pub(crate) struct App {
    pub(crate) adapter: Adapter,
    pub(crate) allowed_origins: Vec<String>,
    pub(crate) guides: Guides,
    pub(crate) limits: ServiceLimits,
    pub(crate) metrics: PrometheusHandle,
    pub(crate) readiness: Arc<Readiness>,
    pub(crate) scenes: Scenes,
    pub(crate) sessions: Arc<Sessions>,
    pub(crate) shutdown: CancellationToken,
    pub(crate) sockets: TaskTracker,
    pub(crate) token: Option<String>,
}

/// Serves until `shutdown` is cancelled, or the process is told to end by SIGTERM or Ctrl-C.
///
/// # Errors
/// When the options are unfit, the address or the device cannot be had, or the render thread
/// ended by itself.
pub async fn serve(options: ServeOptions, shutdown: CancellationToken) -> Result<(), ServeError> {
    let device = options.device.clone();
    let open: OpenBackend<Wgpu> = Box::new(move || Wgpu::open(&device));
    serve_on(options, open, shutdown).await
}

/// [`serve`] with any renderer.
///
/// # Errors
/// As [`serve`].
pub async fn serve_on<B: Backend + 'static>(
    options: ServeOptions,
    open: OpenBackend<B>,
    shutdown: CancellationToken,
) -> Result<(), ServeError> {
    options.check()?;
    check_supported(&options.scene.scene)?;
    let bind = options.bind;
    let refused = |source| ServeError::Bind { bind, source };
    let listener = TcpListener::bind(bind).await.map_err(refused)?;
    let address = listener.local_addr().map_err(refused)?;
    let metrics = telemetry::install()?;

    // The caller's token may end the service; the service must not end the caller's.
    let shutdown = shutdown.child_token();
    let limits = options.limits;
    let sessions = Arc::new(Sessions::new(limits.max_sessions, limits.resume_for));
    let readiness = Arc::new(Readiness::new());
    let encoders = EncoderPool::start(limits.encoder_threads)?;
    let (render_thread, adapter) = render_thread::start(
        open,
        Arc::clone(&sessions),
        encoders,
        Arc::clone(&readiness),
        shutdown.clone(),
        limits.frame_budget,
    )
    .await?;
    tracing::info!(adapter = adapter.name, driver = adapter.driver, kind = ?adapter.kind, "rendering");
    let app = Arc::new(App {
        adapter,
        allowed_origins: options.allowed_origins,
        guides: Guides::new(),
        limits,
        metrics,
        readiness,
        scenes: Scenes::new(options.scene),
        sessions,
        shutdown: shutdown.clone(),
        sockets: TaskTracker::new(),
        token: options.token,
    });
    announce(address, options.port_file.as_deref())?;
    let background = TaskTracker::new();
    background.spawn(end_on_signal(shutdown.clone()));
    background.spawn(upkeep(app.metrics.clone(), shutdown.clone()));
    background.spawn({
        let (sessions, shutdown) = (Arc::clone(&app.sessions), shutdown.clone());
        async move { sessions.forget_dropped(shutdown).await }
    });
    let served = listen(listener, Arc::clone(&app)).await;
    shutdown.cancel();
    drain(&app, &background).await;
    join(render_thread, &app).await?;
    served
}

/// Accepts connections until shutdown, then lets running requests finish for a while.
async fn listen(listener: TcpListener, app: Arc<App>) -> Result<(), ServeError> {
    let listener = listener.tap_io(|stream| {
        // Frames and acknowledgements must not wait for each other.
        if let Err(error) = stream.set_nodelay(true) {
            tracing::debug!(%error, "TCP_NODELAY was refused");
        }
    });
    let (shutdown, drain_within) = (app.shutdown.clone(), app.limits.drain_within);
    let router = routes::router(app);
    let serving = axum::serve(listener, router)
        .with_graceful_shutdown(shutdown.clone().cancelled_owned())
        .into_future();
    let overdue = async {
        shutdown.cancelled().await;
        tokio::time::sleep(drain_within).await;
    };
    tokio::select! {
        served = serving => Ok(served?),
        () = overdue => {
            tracing::warn!("some requests did not end in time");
            Ok(())
        }
    }
}

/// Waits for sockets, which close by themselves, and background tasks.
async fn drain(app: &App, background: &TaskTracker) {
    app.sockets.close();
    background.close();
    let drained = async {
        app.sockets.wait().await;
        background.wait().await;
    };
    if tokio::time::timeout(app.limits.drain_within, drained)
        .await
        .is_err()
    {
        tracing::warn!("some connections did not close in time");
    }
}

/// Ends the render thread, and with it the encoders.
async fn join(thread: std::thread::JoinHandle<()>, app: &App) -> Result<(), ServeError> {
    app.sessions.bell.ring();
    let fault = |reason: &str| ServeError::Thread {
        name: "render",
        reason: reason.to_owned(),
    };
    let joined = tokio::task::spawn_blocking(move || thread.join());
    match tokio::time::timeout(app.limits.drain_within, joined).await {
        Ok(Ok(Ok(()))) => Ok(()),
        Ok(_panicked) => Err(fault("panicked")),
        Err(_elapsed) => Err(fault("did not end in time")),
    }
}

/// Says where the page is: in the log, on standard output, and in the port file.
fn announce(address: SocketAddr, port_file: Option<&std::path::Path>) -> Result<(), ServeError> {
    tracing::info!(%address, "listening");
    // A closed standard output is no reason not to serve.
    if let Err(error) = writeln!(std::io::stdout(), "tyndall: http://{address}/") {
        tracing::debug!(%error, "standard output is closed");
    }
    let Some(path) = port_file else {
        return Ok(());
    };
    // Renamed into place, so that a waiting script never reads half a line.
    let written = path.with_extension("part");
    std::fs::write(&written, format!("{address}\n"))
        .and_then(|()| std::fs::rename(&written, path))
        .map_err(|source| ServeError::PortFile {
            path: path.to_owned(),
            source,
        })
}

/// Folds histogram samples into their buckets; they would pile up between scrapes.
async fn upkeep(metrics: PrometheusHandle, shutdown: CancellationToken) {
    let mut tick = tokio::time::interval(telemetry::UPKEEP_EVERY);
    loop {
        tokio::select! {
            _ = tick.tick() => metrics.run_upkeep(),
            () = shutdown.cancelled() => return,
        }
    }
}

/// Cancels on SIGTERM or Ctrl-C.
async fn end_on_signal(shutdown: CancellationToken) {
    #[cfg(unix)]
    let terminated = async {
        use tokio::signal::unix::{SignalKind, signal};
        match signal(SignalKind::terminate()) {
            Ok(mut signal) => {
                signal.recv().await;
            }
            Err(error) => {
                tracing::warn!(%error, "SIGTERM cannot be handled");
                std::future::pending::<()>().await;
            }
        }
    };
    #[cfg(not(unix))]
    let terminated = std::future::pending::<()>();
    tokio::select! {
        () = terminated => tracing::info!("SIGTERM: going down"),
        interrupted = tokio::signal::ctrl_c() => match interrupted {
            Ok(()) => tracing::info!("Ctrl-C: going down"),
            Err(error) => {
                tracing::warn!(%error, "Ctrl-C cannot be handled");
                shutdown.cancelled().await;
            }
        },
        () = shutdown.cancelled() => {}
    }
    shutdown.cancel();
}
