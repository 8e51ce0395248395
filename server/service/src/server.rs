//! Binds, starts the threads, serves, and goes down in order.

use std::io::Write as _;
use std::net::{IpAddr, Ipv4Addr, Ipv6Addr, SocketAddr};
use std::sync::Arc;
use std::time::Instant;

use metrics_exporter_prometheus::PrometheusHandle;
use tokio::net::TcpListener;
use tokio::sync::Semaphore;
use tokio_util::sync::CancellationToken;
use tokio_util::task::TaskTracker;
use tyndall_render::check_supported;
use tyndall_stream::protocol::Adapter;

use crate::attempts::Attempts;
use crate::backend::{Backend, OpenBackend, Wgpu};
use crate::connections::{self, ConnectionLimits};
use crate::encoder_pool::EncoderPool;
use crate::guides::Guides;
use crate::jobs::{self, JobLimits, Jobs};
use crate::options::{ServeError, ServeOptions, ServiceLimits};
use crate::origin::Origin;
use crate::refusals::Refusals;
use crate::render_thread::{self, MOST_STILLS, Readiness};
use crate::routes;
use crate::scenes::Scenes;
use crate::sessions::Sessions;
use crate::stills::Desk;
use crate::telemetry;
use crate::watchdog::watch;

/// What handlers share.
#[derive(Debug)]
pub(crate) struct App {
    pub(crate) adapter: Adapter,
    pub(crate) guides: Guides,
    pub(crate) allowed_origins: Vec<Origin>,
    pub(crate) attempts: Attempts,
    /// Large edits are made one at a time.
    pub(crate) editing: Semaphore,
    pub(crate) job_limits: JobLimits,
    pub(crate) jobs: Arc<Jobs>,
    pub(crate) limits: ServiceLimits,
    pub(crate) metrics: PrometheusHandle,
    pub(crate) readiness: Arc<Readiness>,
    pub(crate) refusals: Refusals,
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
    let memory = options.memory;
    let open: OpenBackend<Wgpu> = Box::new(move || Wgpu::open(&device, memory));
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
    let allowed_origins = options.origins()?;
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
    let readiness = Arc::new(Readiness::default());
    let desk = Arc::new(Desk::new(Arc::clone(&sessions)));
    let opened = jobs::open(
        &options.data,
        options.jobs,
        options.ffmpeg,
        Arc::clone(&desk),
    );
    let jobs = Arc::new(opened.await?);
    let encoders = EncoderPool::start(limits.encoder_threads, &readiness)?;
    let (render_thread, adapter) = render_thread::start(
        open,
        (Arc::clone(&sessions), desk),
        encoders,
        Arc::clone(&readiness),
        shutdown.clone(),
        limits.frame_budget,
        Arc::new(options.scene.scene.clone()),
    )
    .await?;
    tracing::info!(adapter = adapter.name, driver = adapter.driver, kind = ?adapter.kind, "rendering");
    let app = Arc::new(App {
        adapter,
        guides: Guides::new(),
        allowed_origins,
        attempts: Attempts::new(),
        editing: Semaphore::new(1),
        job_limits: options.jobs,
        jobs: Arc::clone(&jobs),
        limits,
        metrics,
        readiness,
        refusals: Refusals::default(),
        scenes: Scenes::new(options.scene, limits.plan_within),
        sessions,
        shutdown: shutdown.clone(),
        sockets: TaskTracker::new(),
        token: options.token,
    });
    let background = TaskTracker::new();
    background.spawn(end_on_signal(shutdown.clone()));
    background.spawn(upkeep(app.metrics.clone(), shutdown.clone()));
    background.spawn({
        let (sessions, shutdown) = (Arc::clone(&app.sessions), shutdown.clone());
        async move { sessions.forget_dropped(shutdown).await }
    });
    for _ in 0..MOST_STILLS {
        background.spawn(jobs::work(Arc::clone(&jobs), shutdown.clone()));
    }
    background.spawn(jobs::upkeep(jobs, shutdown.clone()));
    if options.end_process {
        tokio::spawn(watch(shutdown.clone(), limits.drain_within));
    }
    let router = routes::router(Arc::clone(&app));
    // The last thing that is said before there are visitors.
    announce(address, app.token.is_some(), options.port_file.as_deref())?;
    let connections = TaskTracker::new();
    let bounds = ConnectionLimits {
        most: limits.max_connections,
        header_within: limits.header_within,
        send_within: limits.send_within,
    };
    let tracker = connections.clone();
    connections::serve(listener, router, bounds, tracker, shutdown.clone()).await;
    // What follows shares one time, the last tenth of which is the process's own.
    let until = Instant::now() + limits.drain_within * 9 / 10;
    drain([connections, app.sockets.clone(), background], until).await;
    join(render_thread, &app, until).await
}

/// Waits for requests, sockets, which close by themselves, and background tasks.
async fn drain(trackers: [TaskTracker; 3], until: Instant) {
    let drained = async {
        for tracker in trackers {
            tracker.close();
            tracker.wait().await;
        }
    };
    // Half of what is left, so that the render thread has time as well.
    let until = Instant::now() + until.saturating_duration_since(Instant::now()) / 2;
    if tokio::time::timeout_at(until.into(), drained)
        .await
        .is_err()
    {
        tracing::warn!("some connections did not close in time");
    }
}

/// Ends the render thread, and with it the encoders.
async fn join(
    thread: std::thread::JoinHandle<()>,
    app: &App,
    until: Instant,
) -> Result<(), ServeError> {
    app.sessions.bell.ring();
    let fault = |reason: &str| ServeError::Thread {
        name: "render",
        reason: reason.to_owned(),
    };
    let joined = tokio::task::spawn_blocking(move || thread.join());
    match tokio::time::timeout_at(until.into(), joined).await {
        Ok(Ok(Ok(()))) => Ok(()),
        Ok(_panicked) => Err(fault("panicked")),
        Err(_elapsed) => Err(fault("did not end in time")),
    }
}

/// Says where the page is: in the log and on standard output, after the port file is written.
fn announce(
    address: SocketAddr,
    guarded: bool,
    port_file: Option<&std::path::Path>,
) -> Result<(), ServeError> {
    if let Some(path) = port_file {
        write_port_file(address, path)?;
    }
    tracing::info!(%address, "listening");
    // An address that stands for all of this machine's is none to go to.
    let mut reachable = address;
    match address.ip() {
        IpAddr::V4(ip) if ip.is_unspecified() => reachable.set_ip(Ipv4Addr::LOCALHOST.into()),
        IpAddr::V6(ip) if ip.is_unspecified() => reachable.set_ip(Ipv6Addr::LOCALHOST.into()),
        _ => {}
    }
    let token = if guarded { "?token=YOUR_TOKEN" } else { "" };
    // A closed standard output is no reason not to serve.
    if let Err(error) = writeln!(std::io::stdout(), "tyndall: http://{reachable}/{token}") {
        tracing::debug!(%error, "standard output is closed");
    }
    Ok(())
}

fn write_port_file(address: SocketAddr, path: &std::path::Path) -> Result<(), ServeError> {
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
