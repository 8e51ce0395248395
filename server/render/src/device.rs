//! Chooses an adapter (a GPU before software, always) and opens it.

use std::sync::{Arc, Mutex};

use serde::Serialize;

use crate::error::{DeviceError, RenderError};
use crate::self_test::SelfTest;

/// What the user may say about the choice of adapter.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct DeviceOptions {
    /// Part of the adapter's name, any case; `None` takes the best.
    pub adapter: Option<String>,
    /// Refuse software adapters.
    pub require_gpu: bool,
}

/// What kind of device an adapter is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum AdapterKind {
    /// A real GPU: discrete, integrated or virtual.
    Gpu,
    /// A driver that renders on the CPU.
    Software,
    /// Unknown to wgpu.
    Other,
}

/// An adapter as shown to users.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct AdapterSummary {
    /// Device name.
    pub name: String,
    /// Driver name and version.
    pub driver: String,
    /// Kind of device.
    pub kind: AdapterKind,
}

/// An open device. Errors it reports outside calls are collected, not printed.
#[derive(Debug)]
#[allow(clippy::struct_field_names, reason = "wgpu calls it a device, too")]
pub struct Device {
    pub(crate) device: wgpu::Device,
    pub(crate) queue: wgpu::Queue,
    summary: AdapterSummary,
    self_test: SelfTest,
    fault: Arc<Mutex<Option<Fault>>>,
}

#[derive(Debug, Clone)]
enum Fault {
    Lost(String),
    Refused(String),
}

impl Device {
    /// Opens the best adapter that `options` allow and runs the self-test on it.
    pub fn open(options: &DeviceOptions) -> Result<Self, DeviceError> {
        let adapter = choose(enumerate(), options)?;
        let summary = summarize(&adapter.get_info());
        let wanted = wgpu::Features::TIMESTAMP_QUERY;
        let (device, queue) = pollster::block_on(adapter.request_device(&wgpu::DeviceDescriptor {
            label: Some("tyndall"),
            required_features: adapter.features() & wanted,
            required_limits: adapter.limits(),
            ..Default::default()
        }))
        .map_err(|source| DeviceError::Refused {
            adapter: summary.name.clone(),
            source,
        })?;
        let mut opened = Self::from_parts(device, queue, summary);
        opened.self_test = crate::self_test::run(&opened)?;
        Ok(opened)
    }

    /// A device that validates but executes nothing: builds every pipeline without a driver.
    /// It passes no self-test, since it computes nothing.
    #[cfg(feature = "noop")]
    pub fn noop() -> Result<Self, DeviceError> {
        let mut descriptor = wgpu::InstanceDescriptor::new_without_display_handle();
        descriptor.backends = wgpu::Backends::NOOP;
        descriptor.backend_options.noop.enable = true;
        let instance = wgpu::Instance::new(descriptor);
        let adapters = pollster::block_on(instance.enumerate_adapters(wgpu::Backends::NOOP));
        let adapter = adapters.into_iter().next().ok_or(DeviceError::NoAdapter)?;
        let summary = summarize(&adapter.get_info());
        let (device, queue) = pollster::block_on(adapter.request_device(&wgpu::DeviceDescriptor {
            label: Some("tyndall noop"),
            required_limits: wgpu::Limits {
                // wgpu's own tables hold no more.
                max_bind_groups: adapter.limits().max_bind_groups.min(8),
                ..adapter.limits()
            },
            ..Default::default()
        }))
        .map_err(|source| DeviceError::Refused {
            adapter: summary.name.clone(),
            source,
        })?;
        Ok(Self::from_parts(device, queue, summary))
    }

    fn from_parts(device: wgpu::Device, queue: wgpu::Queue, summary: AdapterSummary) -> Self {
        let fault = Arc::new(Mutex::new(None));
        let lost = Arc::clone(&fault);
        device.set_device_lost_callback(move |reason, message| {
            if reason != wgpu::DeviceLostReason::Destroyed {
                record(&lost, Fault::Lost(message));
            }
        });
        let refused = Arc::clone(&fault);
        device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| {
            record(&refused, Fault::Refused(error.to_string()));
        }));
        Self {
            device,
            queue,
            summary,
            self_test: SelfTest::default(),
            fault,
        }
    }

    /// Every Vulkan adapter, best first.
    pub fn adapters() -> Vec<AdapterSummary> {
        let mut found: Vec<_> = enumerate().iter().map(wgpu::Adapter::get_info).collect();
        found.sort_by_key(|info| rank(info.device_type));
        found.iter().map(summarize).collect()
    }

    /// The adapter in use.
    pub fn summary(&self) -> &AdapterSummary {
        &self.summary
    }

    /// What the start-up self-test found.
    pub fn self_test(&self) -> SelfTest {
        self.self_test
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

fn record(slot: &Mutex<Option<Fault>>, fault: Fault) {
    if let Ok(mut slot) = slot.lock()
        && (slot.is_none() || matches!(fault, Fault::Lost(_)))
    {
        *slot = Some(fault);
    }
}

fn enumerate() -> Vec<wgpu::Adapter> {
    let mut descriptor = wgpu::InstanceDescriptor::new_without_display_handle();
    descriptor.backends = wgpu::Backends::VULKAN;
    let instance = wgpu::Instance::new(descriptor);
    pollster::block_on(instance.enumerate_adapters(wgpu::Backends::VULKAN))
}

fn choose(
    mut adapters: Vec<wgpu::Adapter>,
    options: &DeviceOptions,
) -> Result<wgpu::Adapter, DeviceError> {
    if adapters.is_empty() {
        return Err(DeviceError::NoAdapter);
    }
    let found = adapters
        .iter()
        .map(|adapter| adapter.get_info().name)
        .collect::<Vec<_>>()
        .join(", ");
    if let Some(wanted) = &options.adapter {
        let needle = wanted.to_lowercase();
        adapters.retain(|adapter| adapter.get_info().name.to_lowercase().contains(&needle));
        if adapters.is_empty() {
            return Err(DeviceError::NoSuchAdapter {
                wanted: wanted.clone(),
                found,
            });
        }
    }
    adapters.sort_by_key(|adapter| rank(adapter.get_info().device_type));
    let best = adapters.into_iter().next().ok_or(DeviceError::NoAdapter)?;
    if options.require_gpu && kind_of(best.get_info().device_type) != AdapterKind::Gpu {
        return Err(DeviceError::NoGpu { found });
    }
    Ok(best)
}

fn rank(kind: wgpu::DeviceType) -> u8 {
    match kind {
        wgpu::DeviceType::DiscreteGpu => 0,
        wgpu::DeviceType::IntegratedGpu => 1,
        wgpu::DeviceType::VirtualGpu => 2,
        wgpu::DeviceType::Other => 3,
        wgpu::DeviceType::Cpu => 4,
    }
}

fn kind_of(kind: wgpu::DeviceType) -> AdapterKind {
    match kind {
        wgpu::DeviceType::DiscreteGpu
        | wgpu::DeviceType::IntegratedGpu
        | wgpu::DeviceType::VirtualGpu => AdapterKind::Gpu,
        wgpu::DeviceType::Cpu => AdapterKind::Software,
        wgpu::DeviceType::Other => AdapterKind::Other,
    }
}

fn summarize(info: &wgpu::AdapterInfo) -> AdapterSummary {
    AdapterSummary {
        name: info.name.clone(),
        driver: format!("{} {}", info.driver, info.driver_info)
            .trim()
            .to_owned(),
        kind: kind_of(info.device_type),
    }
}
