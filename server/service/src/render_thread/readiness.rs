//! Whether a device is open, what it allows, and what went wrong without ending the service: what the
//! routes ask.

use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use tyndall_render::PlanLimits;

use crate::bell::lock;
use crate::telemetry;

/// Whether the render thread has a device.
#[derive(Debug, Default)]
pub(crate) struct Readiness {
    ready: AtomicBool,
    limits: Mutex<PlanLimits>,
    renderer_panics: AtomicU64,
    encoder_panics: AtomicU64,
}

/// Where a picture made a thread panic.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Place {
    Renderer,
    Encoder,
}

impl Readiness {
    pub(crate) fn get(&self) -> bool {
        self.ready.load(Ordering::Acquire)
    }

    pub(super) fn set(&self, ready: bool) {
        self.ready.store(ready, Ordering::Release);
        telemetry::ready(ready);
    }

    /// What the planner must respect on the device that was opened last.
    pub(crate) fn plan_limits(&self) -> PlanLimits {
        *lock(&self.limits)
    }

    /// A device is open that allows so much.
    pub(super) fn opened(&self, limits: PlanLimits) {
        *lock(&self.limits) = limits;
        self.set(true);
    }

    /// Counts a picture that was given up after a panic.
    pub(crate) fn panicked(&self, place: Place) {
        let (count, name) = match place {
            Place::Renderer => (&self.renderer_panics, "render"),
            Place::Encoder => (&self.encoder_panics, "encoder"),
        };
        count.fetch_add(1, Ordering::Relaxed);
        telemetry::panicked(name);
    }

    /// Pictures that were given up after a panic in the renderer, and in an encoder.
    pub(crate) fn panics(&self) -> (u64, u64) {
        let count = |counter: &AtomicU64| counter.load(Ordering::Relaxed);
        (count(&self.renderer_panics), count(&self.encoder_panics))
    }
}
