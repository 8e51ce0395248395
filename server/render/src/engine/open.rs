//! Opens a device and tests it.

use super::adapter::{self, AdapterSummary, DeviceOptions};
use super::device::Device;
use super::self_test;
use crate::error::DeviceError;

impl Device {
    /// Opens the best adapter that `options` allow and runs the self-test on it.
    pub fn open(options: &DeviceOptions) -> Result<Self, DeviceError> {
        let adapter = adapter::choose(adapter::enumerate(), options)?;
        let summary = adapter::summarize(&adapter.get_info());
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
        opened.self_test = self_test::run(&opened)?;
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
        let summary = adapter::summarize(&adapter.get_info());
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

    /// Every Vulkan adapter, best first.
    pub fn adapters() -> Vec<AdapterSummary> {
        adapter::all()
    }
}
