//! Which adapters there are, and which one is taken: a GPU before software, always.

use serde::Serialize;

use crate::error::DeviceError;

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

/// Share of a memory heap beyond which the driver is not asked for more: an allocation then fails
/// with an error instead of taking the device down. Unit: percent.
const MOST_OF_A_HEAP: u8 = 95;

/// Every Vulkan adapter, in the order of the loader.
pub(super) fn enumerate() -> Vec<wgpu::Adapter> {
    let mut descriptor = wgpu::InstanceDescriptor::new_without_display_handle();
    descriptor.backends = wgpu::Backends::VULKAN;
    descriptor.memory_budget_thresholds.for_resource_creation = Some(MOST_OF_A_HEAP);
    let instance = wgpu::Instance::new(descriptor);
    pollster::block_on(instance.enumerate_adapters(wgpu::Backends::VULKAN))
}

/// Every Vulkan adapter, best first.
pub(super) fn all() -> Vec<AdapterSummary> {
    let mut found: Vec<_> = enumerate().iter().map(wgpu::Adapter::get_info).collect();
    found.sort_by_key(|info| rank(info.device_type));
    found.iter().map(summarize).collect()
}

/// The best of `adapters` that `options` allow.
pub(super) fn choose(
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

/// An adapter as shown to users.
pub(super) fn summarize(info: &wgpu::AdapterInfo) -> AdapterSummary {
    AdapterSummary {
        name: info.name.clone(),
        driver: format!("{} {}", info.driver, info.driver_info)
            .trim()
            .to_owned(),
        kind: kind_of(info.device_type),
    }
}
