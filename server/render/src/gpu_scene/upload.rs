//! Filled buffers, and limits of what they may hold.

use wgpu::util::DeviceExt as _;

use crate::engine::Device;
use crate::error::RenderError;

/// Refuses `needed` above `allowed`.
pub(super) fn check(what: &'static str, needed: u64, allowed: u64) -> Result<(), RenderError> {
    if needed > allowed {
        return Err(RenderError::TooLarge {
            what,
            needed,
            allowed,
        });
    }
    Ok(())
}

/// A filled buffer; an empty one gets one zeroed word, since the API has no empty bindings.
pub(super) fn buffer(
    device: &Device,
    label: &str,
    contents: &[u8],
    usage: wgpu::BufferUsages,
) -> wgpu::Buffer {
    let filler = [0_u8; 16];
    device
        .device
        .create_buffer_init(&wgpu::util::BufferInitDescriptor {
            label: Some(label),
            contents: if contents.is_empty() {
                &filler
            } else {
                contents
            },
            usage,
        })
}
