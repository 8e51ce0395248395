//! `tyndall adapters`: what could render here.

use std::io::Write as _;

use clap::Args;
use tyndall_render::{AdapterKind, Device, DeviceError};

/// List the adapters, best first.
#[derive(Debug, Args)]
pub struct Adapters {
    /// A JSON array instead of lines.
    #[arg(long)]
    json: bool,
}

impl Adapters {
    pub fn run(self) -> anyhow::Result<()> {
        let adapters = Device::adapters();
        let mut out = std::io::stdout().lock();
        if self.json {
            writeln!(out, "{}", serde_json::to_string_pretty(&adapters)?)?;
        } else {
            for adapter in &adapters {
                let kind = match adapter.kind {
                    AdapterKind::Gpu => "GPU",
                    AdapterKind::Software => "software",
                    AdapterKind::Other => "other",
                };
                writeln!(out, "{:<9} {}  ({})", kind, adapter.name, adapter.driver)?;
            }
        }
        if adapters.is_empty() {
            return Err(DeviceError::NoAdapter.into());
        }
        Ok(())
    }
}
