//! Whether a device is open: what the routes ask.

use std::sync::atomic::{AtomicBool, Ordering};

use crate::telemetry;

/// Whether the render thread has a device.
#[derive(Debug)]
pub(crate) struct Readiness {
    ready: AtomicBool,
}

impl Readiness {
    pub(crate) fn new() -> Self {
        Self {
            ready: AtomicBool::new(false),
        }
    }

    pub(crate) fn get(&self) -> bool {
        self.ready.load(Ordering::Acquire)
    }

    pub(super) fn set(&self, ready: bool) {
        self.ready.store(ready, Ordering::Release);
        telemetry::ready(ready);
    }
}
