//! Allocations: of what kind they are, how many bytes they take, and how they are made.

use super::device::Device;
use super::resources::{AccessKind, Bytes, Extent, ResourceSpec, Shape};

/// Everything that two allocations must agree on to take each other's place.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Texture {
        size: wgpu::Extent3d,
        format: wgpu::TextureFormat,
        mips: u32,
        usage: wgpu::TextureUsages,
    },
    Buffer {
        bytes: u64,
        usage: wgpu::BufferUsages,
    },
}

/// An allocation.
#[derive(Debug)]
pub(super) enum Memory {
    Texture {
        whole: wgpu::TextureView,
        /// One a level.
        levels: Vec<wgpu::TextureView>,
    },
    Buffer(wgpu::Buffer),
}

impl Kind {
    /// For the uses of both.
    pub fn joined(self, other: Self) -> Self {
        match (self, other) {
            (
                Self::Texture {
                    size,
                    format,
                    mips,
                    usage,
                },
                Self::Texture { usage: more, .. },
            ) => Self::Texture {
                size,
                format,
                mips,
                usage: usage | more,
            },
            (Self::Buffer { bytes, usage }, Self::Buffer { usage: more, .. }) => Self::Buffer {
                bytes,
                usage: usage | more,
            },
            // One name has one shape.
            (own, _) => own,
        }
    }

    /// What an allocation takes.
    pub fn bytes(self) -> u64 {
        match self {
            Self::Buffer { bytes, .. } => bytes,
            Self::Texture {
                size, format, mips, ..
            } => {
                let texel = u64::from(format.block_copy_size(None).unwrap_or(4));
                let is_volume = size.depth_or_array_layers > 1;
                let level = |mip: u32| {
                    let side = |length: u32| u64::from((length >> mip).max(1));
                    let depth = if is_volume {
                        side(size.depth_or_array_layers)
                    } else {
                        1
                    };
                    side(size.width) * side(size.height) * depth * texel
                };
                (0..mips).map(level).sum()
            }
        }
    }

    /// Allocates.
    pub fn make(self, device: &Device, name: &'static str) -> Memory {
        match self {
            Self::Buffer { bytes, usage } => {
                Memory::Buffer(device.device.create_buffer(&wgpu::BufferDescriptor {
                    label: Some(name),
                    size: bytes,
                    usage,
                    mapped_at_creation: false,
                }))
            }
            Self::Texture {
                size,
                format,
                mips,
                usage,
            } => {
                let texture = device.device.create_texture(&wgpu::TextureDescriptor {
                    label: Some(name),
                    size,
                    mip_level_count: mips,
                    sample_count: 1,
                    dimension: if size.depth_or_array_layers > 1 {
                        wgpu::TextureDimension::D3
                    } else {
                        wgpu::TextureDimension::D2
                    },
                    format,
                    usage,
                    view_formats: &[],
                });
                let level = |mip: u32| {
                    texture.create_view(&wgpu::TextureViewDescriptor {
                        base_mip_level: mip,
                        mip_level_count: Some(1),
                        ..Default::default()
                    })
                };
                Memory::Texture {
                    whole: texture.create_view(&wgpu::TextureViewDescriptor::default()),
                    levels: (0..mips).map(level).collect(),
                }
            }
        }
    }
}

/// The kind of a resource that is accessed so, for a picture of this size.
pub(super) fn kind_of(spec: &ResourceSpec, access: AccessKind, size: [u32; 2]) -> Kind {
    match spec.shape {
        Shape::Texture {
            format,
            extent,
            mips,
        } => {
            let size = extent.of(size);
            let dimension = dimension(extent);
            Kind::Texture {
                size,
                format,
                mips: if mips == 0 {
                    size.max_mips(dimension)
                } else {
                    mips.min(size.max_mips(dimension))
                },
                usage: wgpu::TextureUsages::TEXTURE_BINDING
                    | wgpu::TextureUsages::COPY_SRC
                    | match access {
                        AccessKind::Write => wgpu::TextureUsages::STORAGE_BINDING,
                        AccessKind::Attachment => wgpu::TextureUsages::RENDER_ATTACHMENT,
                        AccessKind::Read | AccessKind::ReadWhenWritten | AccessKind::Counts => {
                            wgpu::TextureUsages::empty()
                        }
                    },
            }
        }
        Shape::Buffer(bytes) => Kind::Buffer {
            bytes: Bytes::of(bytes, size),
            usage: wgpu::BufferUsages::STORAGE
                | wgpu::BufferUsages::COPY_SRC
                | wgpu::BufferUsages::COPY_DST
                | if access == AccessKind::Counts {
                    wgpu::BufferUsages::INDIRECT
                } else {
                    wgpu::BufferUsages::empty()
                },
        },
    }
}

fn dimension(extent: Extent) -> wgpu::TextureDimension {
    match extent {
        Extent::Picture { .. } => wgpu::TextureDimension::D2,
        Extent::Volume(_) => wgpu::TextureDimension::D3,
    }
}
