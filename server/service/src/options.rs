//! Where the service listens, who may ask, and how much of everything there may be.

use std::net::SocketAddr;
use std::path::PathBuf;
use std::time::Duration;

use tyndall_render::{DeviceError, DeviceOptions, MemoryBudget, RenderError};
use tyndall_scene::Loaded;

use crate::jobs::{DataError, DataFolder, JobLimits};
use crate::origin::Origin;

/// Shortest token accepted. Unit: character.
pub const MIN_TOKEN_LENGTH: usize = 8;

/// Everything `serve` needs.
#[derive(Debug, Clone)]
pub struct ServeOptions {
    /// Address to listen on; port 0 takes a free one. Anything but loopback needs `token`.
    pub bind: SocketAddr,
    /// The scene that new sessions see.
    pub scene: Loaded,
    /// Which adapter renders.
    pub device: DeviceOptions,
    /// Secret that clients have to show, as `Authorization: Bearer` or `?token=`.
    pub token: Option<String>,
    /// Gets the bound address in one line, for scripts that let the system choose a port.
    pub port_file: Option<PathBuf>,
    /// Origins besides the server's own whose pages may open the WebSocket, such as
    /// `https://tyndall.example.org` behind a gateway.
    pub allowed_origins: Vec<String>,
    /// Bounds.
    pub limits: ServiceLimits,
    /// Device memory that pictures may take.
    pub memory: MemoryBudget,
    /// Where jobs are kept.
    pub data: DataFolder,
    /// Bounds of jobs.
    pub jobs: JobLimits,
    /// The ffmpeg that makes videos; the one of the search path without.
    pub ffmpeg: Option<PathBuf>,
    /// The process ends `limits.drain_within` after it was told to, whatever still runs: for programs that
    /// do nothing else.
    pub end_process: bool,
}

impl ServeOptions {
    /// Serves `scene` at `bind` with defaults for everything else.
    pub fn new(bind: SocketAddr, scene: Loaded) -> Self {
        Self {
            bind,
            scene,
            device: DeviceOptions::default(),
            token: None,
            port_file: None,
            allowed_origins: Vec::new(),
            limits: ServiceLimits::default(),
            memory: MemoryBudget::default(),
            data: DataFolder::Temporary,
            jobs: JobLimits::default(),
            ffmpeg: None,
            end_process: false,
        }
    }

    /// Checks what can be checked before anything is opened.
    ///
    /// # Errors
    /// [`ServeError::TokenNeeded`], [`ServeError::TokenUnfit`] and [`ServeError::OriginUnfit`].
    pub fn check(&self) -> Result<(), ServeError> {
        self.origins()?;
        match &self.token {
            None if !self.bind.ip().is_loopback() => {
                Err(ServeError::TokenNeeded { bind: self.bind })
            }
            Some(token)
                if token.len() < MIN_TOKEN_LENGTH
                    || !token.bytes().all(|byte| byte.is_ascii_graphic()) =>
            {
                Err(ServeError::TokenUnfit)
            }
            _ => Ok(()),
        }
    }

    /// The allowed origins in one spelling.
    pub(crate) fn origins(&self) -> Result<Vec<Origin>, ServeError> {
        let parsed = self.allowed_origins.iter().map(|text| {
            Origin::parse(text).map_err(|why| ServeError::OriginUnfit {
                origin: text.clone(),
                why,
            })
        });
        parsed.collect()
    }
}

/// How much of everything there may be.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ServiceLimits {
    /// Connected sessions; the next client is refused, one that resumes its own is not.
    pub max_sessions: usize,
    /// HTTP connections open at once, besides WebSockets.
    pub max_connections: usize,
    /// Largest picture. Unit: pixel.
    pub max_pixels: u64,
    /// Longest side of a picture. Unit: pixel.
    pub max_side: u32,
    /// Longest WebSocket message of a client. Unit: byte.
    pub max_message_bytes: usize,
    /// Longest HTTP body. Unit: byte.
    pub max_body_bytes: usize,
    /// How long a dropped session can be resumed.
    pub resume_for: Duration,
    /// How long the head of a request may take to arrive, and a connection may rest between two.
    pub header_within: Duration,
    /// How long the body of a request may take to arrive.
    pub body_within: Duration,
    /// How long planning a posted scene may take.
    pub plan_within: Duration,
    /// How long a new socket may take to say hello.
    pub hello_within: Duration,
    /// How often a silent connection is probed.
    pub ping_every: Duration,
    /// How long one message may take to leave, and a client may take nothing of an answer.
    pub send_within: Duration,
    /// How long shutting down may take.
    pub drain_within: Duration,
    /// Share of its time that a session's edits may take of a processor core. Unit: percent.
    pub edit_percent: u32,
    /// Threads that compress frames.
    pub encoder_threads: usize,
    /// What a frame of a moving picture may take: its size follows. 33 ms on a GPU, 100 ms on a software
    /// driver without one.
    pub frame_budget: Option<Duration>,
}

impl Default for ServiceLimits {
    fn default() -> Self {
        let cores = std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
        Self {
            max_sessions: 16,
            max_connections: 256,
            max_pixels: 3840 * 2160,
            max_side: 8192,
            max_message_bytes: 1 << 20,
            max_body_bytes: 4 << 20,
            resume_for: Duration::from_mins(1),
            header_within: Duration::from_secs(10),
            body_within: Duration::from_secs(20),
            plan_within: Duration::from_secs(10),
            hello_within: Duration::from_secs(5),
            ping_every: Duration::from_secs(10),
            send_within: Duration::from_secs(20),
            drain_within: Duration::from_secs(10),
            edit_percent: 20,
            encoder_threads: (cores / 4).clamp(1, 4),
            frame_budget: None,
        }
    }
}

/// Why the service did not start, or ended.
#[derive(Debug, thiserror::Error)]
pub enum ServeError {
    /// A public address without a secret.
    #[error(
        "{bind} is not a loopback address: anyone who reaches it could use this machine's renderer; set a token (--token or TYNDALL_TOKEN), or bind 127.0.0.1"
    )]
    TokenNeeded {
        /// The address asked for.
        bind: SocketAddr,
    },
    /// A secret that is none.
    #[error(
        "the token must be at least {MIN_TOKEN_LENGTH} printable ASCII characters without spaces"
    )]
    TokenUnfit,
    /// An allowed origin that is none.
    #[error("the origin \"{origin}\" cannot be allowed: {why}")]
    OriginUnfit {
        /// As it was given.
        origin: String,
        /// What is wrong with it.
        why: &'static str,
    },
    /// The scene uses something that this version does not render.
    #[error(transparent)]
    NotRenderedYet(#[from] tyndall_render::NotRenderedYet),
    /// The address is taken or not ours.
    #[error("cannot listen on {bind}: {source}")]
    Bind {
        /// The address asked for.
        bind: SocketAddr,
        /// The system's reason.
        source: std::io::Error,
    },
    /// The port file cannot be written.
    #[error("cannot write the port file {}: {source}", path.display())]
    PortFile {
        /// The file asked for.
        path: PathBuf,
        /// The system's reason.
        source: std::io::Error,
    },
    /// No device.
    #[error(transparent)]
    Device(#[from] DeviceError),
    /// The device is there but the renderer did not start on it.
    #[error("the renderer did not start: {0}")]
    Renderer(#[from] RenderError),
    /// A thread could not be started, or ended before it was asked to.
    #[error("thread {name}: {reason}")]
    Thread {
        /// Name of the thread.
        name: &'static str,
        /// What happened.
        reason: String,
    },
    /// Jobs cannot be kept.
    #[error("jobs cannot be kept: {0}")]
    Data(#[from] DataError),
    /// The metrics recorder could not be installed.
    #[error("metrics: {0}")]
    Metrics(String),
    /// Accepting connections failed.
    #[error("serving failed: {0}")]
    Serve(#[from] std::io::Error),
}
