//! A scene named on the command line: a preset or a file, with the overrides of the flags.

use std::path::Path;

use anyhow::{Context as _, bail};
use clap::Args;
use tyndall_render::DeviceOptions;
use tyndall_scene::description::render::{CorrectionMode, Technique};
use tyndall_scene::{Loaded, presets};

/// Which adapter renders.
#[derive(Debug, Clone, Args)]
pub struct DeviceArguments {
    /// Part of the adapter's name (see `tyndall adapters`); the best one without it.
    #[arg(long, env = "TYNDALL_ADAPTER")]
    pub adapter: Option<String>,
    /// Fail rather than render on the CPU.
    #[arg(long, env = "TYNDALL_REQUIRE_GPU", hide_env_values = true)]
    pub require_gpu: bool,
}

impl DeviceArguments {
    pub fn options(&self) -> DeviceOptions {
        DeviceOptions {
            adapter: self.adapter.clone(),
            require_gpu: self.require_gpu,
        }
    }
}

/// Loads a preset or a file; prints the file's warnings.
pub fn load(name: &str) -> anyhow::Result<Loaded> {
    let loaded = if let Some(description) = presets::description(name) {
        tyndall_scene::build(description, None).with_context(|| format!("preset {name}"))?
    } else {
        let path = Path::new(name);
        if !path.exists() {
            let known: Vec<_> = presets::names().iter().map(|preset| preset.name).collect();
            bail!("{name}: neither a file nor a preset ({})", known.join(", "));
        }
        tyndall_scene::load(path).with_context(|| name.to_owned())?
    };
    for warning in &loaded.warnings {
        tracing::warn!("{name}: {warning}");
    }
    Ok(loaded)
}

/// A technique by its JSON name.
pub fn technique(name: &str) -> Result<Technique, String> {
    serde_json::from_value(name.into()).map_err(|error| error.to_string())
}

/// A mode of correction by its JSON name.
pub fn correction(name: &str) -> Result<CorrectionMode, String> {
    serde_json::from_value(name.into()).map_err(|error| error.to_string())
}

/// Seconds of `10`, `10s`, `500ms` or `2m`; the range is the scene description's.
pub fn seconds(text: &str) -> Result<f64, String> {
    let text = text.trim();
    let units = [("ms", 1e-3), ("min", 60.0), ("m", 60.0), ("s", 1.0)];
    let (number, unit) = units
        .iter()
        .find_map(|(suffix, unit)| text.strip_suffix(suffix).map(|number| (number, *unit)))
        .unwrap_or((text, 1.0));
    number
        .trim()
        .parse::<f64>()
        .map(|value| value * unit)
        .map_err(|error| format!("{error}: expected a time like 10, 10s, 500ms or 2m"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_have_units() {
        let cases = [
            ("10", 10.0),
            ("10s", 10.0),
            ("2.5 s", 2.5),
            ("500ms", 0.5),
            ("2m", 120.0),
            ("-1", -1.0),
        ];
        for (text, expected) in cases {
            assert_eq!(seconds(text), Ok(expected), "{text}");
        }
        for text in ["", "s", "ten", "1h"] {
            assert!(seconds(text).is_err(), "{text}");
        }
    }

    #[test]
    fn techniques_have_their_json_names() {
        assert_eq!(technique("reference"), Ok(Technique::Reference));
        let error = technique("magic").unwrap_err();
        assert!(error.contains("reference"), "{error}");
    }
}
