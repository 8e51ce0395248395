//! The textures and buffers of the depth maps.

use tyndall_shaders::types::ShadowView;

use crate::engine::{Bindings, Device};
use crate::error::RenderError;

/// Bytes of depth maps a view may use: 1 GiB.
const MAX_BYTES: u64 = 1 << 30;
/// Storage buffer offsets are multiples of this.
const STRIDE: u64 = 256;

/// Depth maps of one resolution.
#[derive(Debug)]
pub(super) struct Maps {
    pub array: wgpu::TextureView,
    pub layers: Vec<wgpu::TextureView>,
    /// What the shading passes index: tightly packed.
    pub views: wgpu::Buffer,
    /// The same for the depth passes, one a binding.
    pass_views: wgpu::Buffer,
}

impl Maps {
    /// Allocates so many layers.
    pub fn new(device: &Device, resolution: u32, layers: u32) -> Result<Self, RenderError> {
        let limits = device.device.limits();
        let bytes = u64::from(layers) * u64::from(resolution) * u64::from(resolution) * 4;
        for (what, needed, allowed) in [
            (
                "shadow map layers",
                u64::from(layers),
                u64::from(limits.max_texture_array_layers),
            ),
            (
                "shadow map texels a side",
                resolution.into(),
                limits.max_texture_dimension_2d.into(),
            ),
            ("bytes of shadow maps", bytes, MAX_BYTES),
        ] {
            if needed > allowed {
                return Err(RenderError::TooLarge {
                    what,
                    needed,
                    allowed,
                });
            }
        }
        let texture = device.device.create_texture(&wgpu::TextureDescriptor {
            label: Some("shadow_maps"),
            size: wgpu::Extent3d {
                width: resolution,
                height: resolution,
                depth_or_array_layers: layers,
            },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: wgpu::TextureFormat::Depth32Float,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING,
            view_formats: &[],
        });
        let buffer = |label: &str, size: u64| {
            device.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(label),
                size,
                usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            })
        };
        Ok(Self {
            array: texture.create_view(&wgpu::TextureViewDescriptor {
                dimension: Some(wgpu::TextureViewDimension::D2Array),
                ..Default::default()
            }),
            layers: (0..layers)
                .map(|layer| {
                    texture.create_view(&wgpu::TextureViewDescriptor {
                        dimension: Some(wgpu::TextureViewDimension::D2),
                        base_array_layer: layer,
                        array_layer_count: Some(1),
                        ..Default::default()
                    })
                })
                .collect(),
            views: buffer(
                "shadow_views",
                u64::from(layers) * size_of::<ShadowView>() as u64,
            ),
            pass_views: buffer("shadow_views.passes", u64::from(layers) * STRIDE),
        })
    }

    /// Uploads the layers' transforms.
    pub fn upload(&self, device: &Device, views: &[ShadowView]) {
        device
            .queue
            .write_buffer(&self.views, 0, bytemuck::cast_slice(views));
        for (i, view) in views.iter().enumerate() {
            device.queue.write_buffer(
                &self.pass_views,
                i as u64 * STRIDE,
                bytemuck::bytes_of(view),
            );
        }
    }

    /// Adds what the depth pass of a layer reads.
    pub fn bind_pass<'a>(&'a self, layer: usize, bindings: &mut Bindings<'a>) {
        let size = std::num::NonZeroU64::new(size_of::<ShadowView>() as u64)
            .unwrap_or(std::num::NonZeroU64::MIN);
        bindings.slice("shadow_view", &self.pass_views, layer as u64 * STRIDE, size);
    }
}
