//! `tyndall serve`: the page and its stream.

use std::net::SocketAddr;
use std::path::PathBuf;

use anyhow::Context as _;
use clap::Args;
use tokio_util::sync::CancellationToken;
use tyndall_service::{DataFolder, ServeOptions};

use super::serve_limits::LimitArguments;
use crate::scene_argument::{self, DeviceArguments};

/// Serve the page and stream pictures to it.
#[derive(Debug, Args)]
pub struct Serve {
    /// Preset, .json scene, or bare .gltf, .glb or .obj model that new sessions see.
    #[arg(default_value = tyndall_scene::presets::DEFAULT)]
    scene: String,
    /// Address to listen on; port 0 takes a free one. Anything but loopback needs --token.
    #[arg(long, env = "TYNDALL_BIND", default_value = "127.0.0.1:8080")]
    bind: SocketAddr,
    /// Secret that clients must show (Authorization: Bearer, or ?token= in the page's address, where
    /// + / = % & # are written as %2B %2F %3D %25 %26 %23).
    #[arg(long, env = "TYNDALL_TOKEN", hide_env_values = true)]
    token: Option<String>,
    /// Write the bound address here.
    #[arg(long)]
    port_file: Option<PathBuf>,
    /// Another origin whose pages may ask, such as <https://tyndall.example.org> behind a gateway
    /// (repeatable).
    #[arg(long = "allow-origin")]
    allowed_origins: Vec<String>,
    /// Folder that keeps jobs and their results; without it one of the user's data folder.
    #[arg(long, env = "TYNDALL_DATA", value_name = "FOLDER")]
    data: Option<PathBuf>,
    /// The ffmpeg that makes videos; without it the one of the search path.
    #[arg(long, value_name = "FILE")]
    ffmpeg: Option<PathBuf>,
    #[command(flatten)]
    device: DeviceArguments,
    #[command(flatten, next_help_heading = "Limits")]
    limits: LimitArguments,
}

impl Serve {
    pub fn run(self) -> anyhow::Result<()> {
        let options = ServeOptions {
            device: self.device.options(),
            token: self.token,
            port_file: self.port_file,
            allowed_origins: self.allowed_origins,
            limits: self.limits.limits(),
            memory: self.limits.memory(),
            data: data_folder(self.data),
            jobs: self.limits.jobs(),
            ffmpeg: self.ffmpeg,
            end_process: true,
            ..ServeOptions::new(self.bind, scene_argument::load(&self.scene)?)
        };
        let runtime = tokio::runtime::Builder::new_multi_thread()
            .enable_all()
            .build()
            .context("cannot start the async runtime")?;
        let served = runtime.block_on(tyndall_service::serve(options, CancellationToken::new()));
        // A scene that is still being built is not waited for.
        runtime.shutdown_background();
        Ok(served?)
    }
}

/// The folder that was named, or the usual one of this user.
fn data_folder(named: Option<PathBuf>) -> DataFolder {
    if let Some(folder) = named {
        return DataFolder::Named(folder);
    }
    let absolute = |name: &str| {
        let value = std::env::var_os(name).map(PathBuf::from);
        value.filter(|folder| folder.is_absolute())
    };
    let home = || absolute("HOME").map(|home| home.join(".local/share"));
    match absolute("XDG_DATA_HOME").or_else(home) {
        Some(folder) => DataFolder::Usual(folder.join("tyndall")),
        None => DataFolder::Temporary,
    }
}
