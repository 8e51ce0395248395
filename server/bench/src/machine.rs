//! What a figure was measured on.

use serde::Serialize;
use tyndall_render::Renderer;

/// Ticks a second of the kernel's CPU clock as `/proc` shows it: 100 on every Linux.
const TICKS: f64 = 100.0;

/// What a figure was measured on.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Machine {
    /// Adapter.
    pub device: String,
    /// Driver and its version.
    pub driver: String,
    /// Commit of the program, from the build; "unknown" outside of a repository.
    pub commit: &'static str,
    /// Version of the program.
    pub version: &'static str,
    /// CPU threads of the machine.
    pub threads: usize,
}

impl Machine {
    /// The machine that `renderer` runs on.
    pub fn of(renderer: &Renderer) -> Self {
        let adapter = renderer.adapter();
        Self {
            device: adapter.name.clone(),
            driver: adapter.driver.clone(),
            commit: env!("TYNDALL_COMMIT"),
            version: env!("CARGO_PKG_VERSION"),
            threads: std::thread::available_parallelism().map_or(1, usize::from),
        }
    }
}

/// CPU time of this process, all threads. Unit: s. `None` where `/proc` is not there.
pub(crate) fn cpu_seconds() -> Option<f64> {
    let text = std::fs::read_to_string("/proc/self/stat").ok()?;
    // The name, second field, may hold spaces; it ends with the last parenthesis.
    let fields: Vec<&str> = text.rsplit_once(')')?.1.split_whitespace().collect();
    let ticks = |index: usize| fields.get(index)?.parse::<f64>().ok();
    Some((ticks(11)? + ticks(12)?) / TICKS)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cpu_time_grows_with_work() {
        let Some(before) = cpu_seconds() else {
            println!("skipped: no /proc");
            return;
        };
        let started = std::time::Instant::now();
        let mut sum = 0.0_f64;
        while started.elapsed().as_millis() < 60 {
            sum += sum.sin() + 1.0;
        }
        assert!(sum.is_finite());
        assert!(cpu_seconds().unwrap() > before);
    }
}
