//! Textures and buffers of one view at one size.

use crate::correction::Correction;
use crate::device::Device;
use crate::error::RenderError;

/// Formats of the G-buffer's colour targets, in the order of `techniques/surfaces/gbuffer.wesl`.
pub(crate) const GBUFFER_FORMATS: [wgpu::TextureFormat; 3] = [wgpu::TextureFormat::Rgba16Float; 3];

/// Everything whose size follows the picture's.
#[derive(Debug)]
pub(crate) struct Targets {
    pub width: u32,
    pub height: u32,
    pub depth: wgpu::TextureView,
    pub base_color: wgpu::TextureView,
    pub normal: wgpu::TextureView,
    /// Present when the plan has an emission target.
    pub emission: Option<wgpu::TextureView>,
    pub surface_radiance: wgpu::TextureView,
    /// Present when the plan marches.
    pub in_scattered_radiance: Option<wgpu::TextureView>,
    /// Present when the plan looks at area lights.
    pub area_radiance: Option<wgpu::TextureView>,
    /// Present when the march is interleaved.
    pub interleaved: Option<InterleavedTargets>,
    /// Four f32 a pixel.
    pub film: wgpu::Buffer,
    /// Present when the plan traces paths.
    pub reference: Option<ReferenceTargets>,
    /// Present when traced samples correct the picture.
    pub correction: Option<Correction>,
    /// One RGBA8 word a pixel.
    pub displayed: wgpu::Buffer,
}

/// What the reference keeps of each pixel beside its mean.
#[derive(Debug)]
pub(crate) struct ReferenceTargets {
    /// The traced mean, four f32 a pixel, where it is not the picture itself.
    pub traced_film: Option<wgpu::Buffer>,
    /// Eight f32 a pixel: see `techniques/reference/path_trace.wesl`.
    pub moments: wgpu::Buffer,
    /// Eight f32 a pixel: base colour, depth, normal, share that met a surface.
    pub film_surface: wgpu::Buffer,
    /// 64 bytes a pixel: a path that waits for the next dispatch.
    pub waiting_paths: wgpu::Buffer,
    /// Four f32 a tile of 8×8 pixels.
    pub tile_sums: wgpu::Buffer,
}

impl ReferenceTargets {
    /// Records that no pixel has a sample.
    pub fn clear(&self, encoder: &mut wgpu::CommandEncoder) {
        let own = [&self.moments, &self.film_surface, &self.waiting_paths];
        for buffer in own.into_iter().chain(&self.traced_film) {
            encoder.clear_buffer(buffer, 0, None);
        }
    }

    /// Where the traced mean is: a film of its own, or the picture.
    pub fn film<'a>(&'a self, targets: &'a Targets) -> &'a wgpu::Buffer {
        self.traced_film.as_ref().unwrap_or(&targets.film)
    }
}

/// What the interleaved march and its gathering keep.
#[derive(Debug)]
pub(crate) struct InterleavedTargets {
    /// A share of the in-scatter, and the distance at which the march ended.
    pub marched_radiance: wgpu::TextureView,
    /// Gathered along the rows.
    pub gathered_rows: wgpu::TextureView,
    /// See `techniques/single_scattering/pixel_list.wesl`.
    pub rejected_pixels: wgpu::Buffer,
    /// An empty list's first words.
    empty_list: wgpu::Buffer,
}

impl InterleavedTargets {
    fn new(device: &Device, pixels: u64, texture: impl Fn(&str) -> wgpu::TextureView) -> Self {
        let buffer = |label: &str, size: u64, usage: wgpu::BufferUsages| {
            device.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(label),
                size,
                usage,
                mapped_at_creation: false,
            })
        };
        let copied = wgpu::BufferUsages::COPY_DST;
        let listed = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::INDIRECT;
        let none: [u32; 4] = [0, 1, 1, 0];
        Self {
            marched_radiance: texture("marched_radiance"),
            gathered_rows: texture("gathered_rows"),
            rejected_pixels: buffer("rejected_pixels", 16 + 4 * pixels, listed | copied),
            empty_list: wgpu::util::DeviceExt::create_buffer_init(
                &device.device,
                &wgpu::util::BufferInitDescriptor {
                    label: Some("empty_list"),
                    contents: bytemuck::cast_slice(&none),
                    usage: wgpu::BufferUsages::COPY_SRC,
                },
            ),
        }
    }

    /// Records the emptying of the list.
    pub fn empty_list(&self, encoder: &mut wgpu::CommandEncoder) {
        encoder.copy_buffer_to_buffer(&self.empty_list, 0, &self.rejected_pixels, 0, Some(16));
    }
}

/// Which optional targets a plan uses.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[allow(clippy::struct_excessive_bools, reason = "independent targets")]
pub(crate) struct TargetNeeds {
    pub emission: bool,
    pub in_scatter: bool,
    pub area: bool,
    pub interleaved: bool,
    pub reference: bool,
    pub correction: bool,
    /// Whether it carries residuals over from picture to picture.
    pub history: bool,
}

impl Targets {
    /// Allocates for `width` × `height` pixels.
    pub fn new(
        device: &Device,
        width: u32,
        height: u32,
        needs: TargetNeeds,
    ) -> Result<Self, RenderError> {
        let limits = device.device.limits();
        let max_side = limits.max_texture_dimension_2d;
        // The film takes 16 bytes a pixel, the reference's waiting paths 64.
        let per_pixel = if needs.reference { 64 } else { 16 };
        let max_pixels = limits.max_storage_buffer_binding_size / per_pixel;
        let pixels = u64::from(width) * u64::from(height);
        if pixels == 0 || pixels > max_pixels || width.max(height) > max_side {
            return Err(RenderError::Size {
                width,
                height,
                max_pixels,
                max_side,
            });
        }
        let texture = |label: &str, format: wgpu::TextureFormat, usage: wgpu::TextureUsages| {
            device
                .device
                .create_texture(&wgpu::TextureDescriptor {
                    label: Some(label),
                    size: wgpu::Extent3d {
                        width,
                        height,
                        depth_or_array_layers: 1,
                    },
                    mip_level_count: 1,
                    sample_count: 1,
                    dimension: wgpu::TextureDimension::D2,
                    format,
                    usage: usage | wgpu::TextureUsages::TEXTURE_BINDING,
                    view_formats: &[],
                })
                .create_view(&wgpu::TextureViewDescriptor::default())
        };
        let drawn = wgpu::TextureUsages::RENDER_ATTACHMENT;
        let stored = wgpu::TextureUsages::STORAGE_BINDING;
        let buffer = |label: &str, bytes_per_pixel: u64| {
            device.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(label),
                size: pixels * bytes_per_pixel,
                usage: wgpu::BufferUsages::STORAGE
                    | wgpu::BufferUsages::COPY_SRC
                    | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            })
        };
        let [color_format, normal_format, emission_format] = GBUFFER_FORMATS;
        let radiance = wgpu::TextureFormat::Rgba32Float;
        Ok(Self {
            width,
            height,
            depth: texture("gbuffer.depth", wgpu::TextureFormat::Depth32Float, drawn),
            base_color: texture("gbuffer.base_color", color_format, drawn),
            normal: texture("gbuffer.normal", normal_format, drawn),
            emission: needs
                .emission
                .then(|| texture("gbuffer.emission", emission_format, drawn)),
            surface_radiance: texture("surface_radiance", radiance, stored),
            in_scattered_radiance: needs
                .in_scatter
                .then(|| texture("in_scattered_radiance", radiance, stored)),
            area_radiance: needs
                .area
                .then(|| texture("area_radiance", radiance, stored)),
            interleaved: needs.interleaved.then(|| {
                let stored = |label: &str| texture(label, radiance, stored);
                InterleavedTargets::new(device, pixels, stored)
            }),
            correction: needs
                .correction
                .then(|| Correction::new(device, width, height, needs.history)),
            reference: needs.reference.then(|| ReferenceTargets {
                traced_film: needs.correction.then(|| buffer("traced_film", 16)),
                moments: buffer("moments", 32),
                film_surface: buffer("film_surface", 32),
                waiting_paths: buffer("waiting_paths", 64),
                // As many as 8×8 tiles, rounded up on both sides, for any shape.
                tile_sums: device.device.create_buffer(&wgpu::BufferDescriptor {
                    label: Some("tile_sums"),
                    size: u64::from(width.div_ceil(8)) * u64::from(height.div_ceil(8)) * 16,
                    usage: wgpu::BufferUsages::STORAGE,
                    mapped_at_creation: false,
                }),
            }),
            film: buffer("film", 16),
            displayed: buffer("displayed", 4),
        })
    }
}
