//! An open device, and the errors it reports outside calls.

use std::sync::{Arc, Mutex};

use tyndall_shaders::types::Band;
use wgpu::util::DeviceExt as _;

use super::adapter::AdapterSummary;
use crate::error::RenderError;

/// What the start-up self-test found.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct SelfTest {
    /// The driver stops an invocation after so many loop iterations; `None` if it doesn't.
    pub loop_cap: Option<u32>,
}

/// An open device. Errors it reports outside calls are collected, not printed.
#[derive(Debug)]
#[allow(clippy::struct_field_names, reason = "wgpu calls it a device, too")]
pub struct Device {
    pub(crate) device: wgpu::Device,
    pub(crate) queue: wgpu::Queue,
    pub(super) self_test: SelfTest,
    /// Says that a dispatch begins at the first workgroup of its pass.
    first_band: wgpu::Buffer,
    summary: AdapterSummary,
    fault: Arc<Mutex<Option<Fault>>>,
}

#[derive(Debug, Clone)]
enum Fault {
    Lost(String),
    Refused(String),
}

impl Device {
    pub(super) fn from_parts(
        device: wgpu::Device,
        queue: wgpu::Queue,
        summary: AdapterSummary,
    ) -> Self {
        let fault = Arc::new(Mutex::new(None));
        let lost = Arc::clone(&fault);
        device.set_device_lost_callback(move |reason, message| {
            if reason != wgpu::DeviceLostReason::Destroyed {
                note(&lost, Fault::Lost(message));
            }
        });
        let refused = Arc::clone(&fault);
        device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| {
            note(&refused, Fault::Refused(error.to_string()));
        }));
        let first_band = band_buffer(&device, [0; 3]);
        Self {
            device,
            queue,
            first_band,
            summary,
            self_test: SelfTest::default(),
            fault,
        }
    }

    /// The adapter in use.
    pub fn summary(&self) -> &AdapterSummary {
        &self.summary
    }

    /// What the start-up self-test found.
    pub fn self_test(&self) -> SelfTest {
        self.self_test
    }

    /// Says at which workgroup of its pass a dispatch begins.
    pub(super) fn band(&self, first: [u32; 3]) -> wgpu::Buffer {
        if first == [0; 3] {
            self.first_band.clone()
        } else {
            band_buffer(&self.device, first)
        }
    }

    /// Memory allocated on the device, by its allocator's own report, if it makes one. Unit: byte.
    pub(crate) fn allocated_bytes(&self) -> Option<u64> {
        let report = self.device.generate_allocator_report()?;
        Some(report.total_allocated_bytes)
    }

    /// The first error the device reported since the last call, if any.
    pub(crate) fn check(&self) -> Result<(), RenderError> {
        let Ok(mut fault) = self.fault.lock() else {
            return Err(RenderError::DeviceLost("its error handler panicked".into()));
        };
        match fault.as_ref() {
            None => Ok(()),
            // A lost device stays lost.
            Some(Fault::Lost(message)) => Err(RenderError::DeviceLost(message.clone())),
            Some(Fault::Refused(message)) => {
                let error = RenderError::Refused(message.clone());
                *fault = None;
                Err(error)
            }
        }
    }
}

fn band_buffer(device: &wgpu::Device, first: [u32; 3]) -> wgpu::Buffer {
    let band = Band { first, padding: 0 };
    device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
        label: Some("band"),
        contents: bytemuck::bytes_of(&band),
        usage: wgpu::BufferUsages::STORAGE,
    })
}

fn note(slot: &Mutex<Option<Fault>>, fault: Fault) {
    if let Ok(mut slot) = slot.lock()
        && (slot.is_none() || matches!(fault, Fault::Lost(_)))
    {
        *slot = Some(fault);
    }
}
