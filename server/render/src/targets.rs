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
    pub needs: TargetNeeds,
    /// Present when the plan shades surfaces.
    pub surfaces: Option<SurfaceTargets>,
    /// Present when the plan marches.
    pub in_scattered_radiance: Option<wgpu::TextureView>,
    /// Present when the plan looks at area lights.
    pub area_radiance: Option<wgpu::TextureView>,
    /// Present when pixels share what they march.
    pub shared_march: Option<SharedMarchTargets>,
    /// Four f32 a pixel.
    pub film: wgpu::Buffer,
    /// Present when the plan traces paths.
    pub reference: Option<ReferenceTargets>,
    /// Present when traced samples correct the picture.
    pub correction: Option<Correction>,
    /// One RGBA8 word a pixel.
    pub displayed: wgpu::Buffer,
}

/// What the camera's rays meet, and its direct light.
#[derive(Debug)]
pub(crate) struct SurfaceTargets {
    pub depth: wgpu::TextureView,
    pub base_color: wgpu::TextureView,
    pub normal: wgpu::TextureView,
    /// Present when the plan has an emission target.
    pub emission: Option<wgpu::TextureView>,
    pub surface_radiance: wgpu::TextureView,
}

/// What the reference keeps of each pixel beside its mean.
#[derive(Debug)]
pub(crate) struct ReferenceTargets {
    /// The traced mean, four f32 a pixel, where it is not the picture itself.
    pub traced_film: Option<wgpu::Buffer>,
    /// Four f32 a pixel each: see `techniques/reference/path_trace.wesl`.
    pub moments: wgpu::Buffer,
    pub even_means: wgpu::Buffer,
    /// Base colour and depth.
    pub film_albedo: wgpu::Buffer,
    /// Normal and share that met a surface.
    pub film_normal: wgpu::Buffer,
    /// Four words a pixel each: a path that waits for the next dispatch. No buffer takes more than the
    /// film does, so that pictures of every technique may have the same size.
    pub waiting: [(&'static str, wgpu::Buffer); 4],
    /// Four f32 a tile of 8×8 pixels.
    pub tile_sums: wgpu::Buffer,
}

impl ReferenceTargets {
    /// For a picture of this size; `corrected` if the traced mean is not the picture itself.
    fn new(
        device: &Device,
        (width, height): (u32, u32),
        corrected: bool,
        buffer: impl Fn(&str, u64) -> wgpu::Buffer,
    ) -> Self {
        Self {
            traced_film: corrected.then(|| buffer("traced_film", 16)),
            moments: buffer("moments", 16),
            even_means: buffer("even_means", 16),
            film_albedo: buffer("film_albedo", 16),
            film_normal: buffer("film_normal", 16),
            waiting: [
                "waiting_origins",
                "waiting_directions",
                "waiting_throughputs",
                "waiting_radiances",
            ]
            .map(|name| (name, buffer(name, 16))),
            // As many as 8×8 tiles, rounded up on both sides, for any shape.
            tile_sums: device.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("tile_sums"),
                size: u64::from(width.div_ceil(8)) * u64::from(height.div_ceil(8)) * 16,
                usage: wgpu::BufferUsages::STORAGE,
                mapped_at_creation: false,
            }),
        }
    }

    /// Records that no pixel has a sample.
    pub fn clear(&self, encoder: &mut wgpu::CommandEncoder) {
        let own = [
            &self.moments,
            &self.even_means,
            &self.film_albedo,
            &self.film_normal,
        ];
        let waiting = self.waiting.iter().map(|(_, buffer)| buffer);
        for buffer in own.into_iter().chain(waiting).chain(&self.traced_film) {
            encoder.clear_buffer(buffer, 0, None);
        }
    }

    /// Where the traced mean is: a film of its own, or the picture.
    pub fn film<'a>(&'a self, targets: &'a Targets) -> &'a wgpu::Buffer {
        self.traced_film.as_ref().unwrap_or(&targets.film)
    }
}

/// What a march that pixels share and its gathering keep, of the pixels that are marched. Alpha: see
/// `techniques/single_scattering/march_end.wesl`.
#[derive(Debug)]
pub(crate) struct SharedMarchTargets {
    /// In-scatter, a share of it if interleaved.
    pub marched_radiance: wgpu::TextureView,
    /// Present when interleaved.
    pub gathered: Option<GatheredTargets>,
    /// See `techniques/single_scattering/pixel_list.wesl`.
    pub rejected_pixels: wgpu::Buffer,
    /// An empty list's first words.
    empty_list: wgpu::Buffer,
}

/// Interleaved strata brought together.
#[derive(Debug)]
pub(crate) struct GatheredTargets {
    /// Along the rows.
    pub rows: wgpu::TextureView,
    /// Along both.
    pub radiance: wgpu::TextureView,
}

impl SharedMarchTargets {
    /// For a list of up to `pixels`, with textures of the marched pixels.
    fn new(
        device: &Device,
        pixels: u64,
        needs: SharedMarch,
        texture: impl Fn(&str) -> wgpu::TextureView,
    ) -> Self {
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
            gathered: needs.interleaved.then(|| GatheredTargets {
                rows: texture("gathered_rows"),
                radiance: texture("gathered_radiance"),
            }),
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

    /// What every pixel has of the marched ones: gathered, or marched in full.
    pub fn restorable(&self) -> &wgpu::TextureView {
        let gathered = self.gathered.as_ref();
        gathered.map_or(&self.marched_radiance, |gathered| &gathered.radiance)
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
    pub surfaces: bool,
    pub emission: bool,
    pub in_scatter: bool,
    pub area: bool,
    pub shared_march: Option<SharedMarch>,
    pub reference: bool,
    pub correction: bool,
    /// Whether it carries residuals over from picture to picture.
    pub history: bool,
}

/// How pixels share what they march.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct SharedMarch {
    /// Strata of a ray.
    pub interleaved: bool,
    /// Side of the block of which one is marched.
    pub spacing: u32,
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
        // No buffer takes more than 16 bytes a pixel.
        let max_pixels = limits.max_storage_buffer_binding_size / 16;
        let pixels = u64::from(width) * u64::from(height);
        if pixels == 0 || pixels > max_pixels || width.max(height) > max_side {
            return Err(RenderError::Size {
                width,
                height,
                max_pixels,
                max_side,
            });
        }
        let sized = |(width, height): (u32, u32),
                     label: &str,
                     format: wgpu::TextureFormat,
                     usage: wgpu::TextureUsages| {
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
        let texture = |label: &str, format: wgpu::TextureFormat, usage: wgpu::TextureUsages| {
            sized((width, height), label, format, usage)
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
            needs,
            surfaces: needs.surfaces.then(|| SurfaceTargets {
                depth: texture("gbuffer.depth", wgpu::TextureFormat::Depth32Float, drawn),
                base_color: texture("gbuffer.base_color", color_format, drawn),
                normal: texture("gbuffer.normal", normal_format, drawn),
                emission: needs
                    .emission
                    .then(|| texture("gbuffer.emission", emission_format, drawn)),
                surface_radiance: texture("surface_radiance", radiance, stored),
            }),
            in_scattered_radiance: needs
                .in_scatter
                .then(|| texture("in_scattered_radiance", radiance, stored)),
            area_radiance: needs
                .area
                .then(|| texture("area_radiance", radiance, stored)),
            shared_march: needs.shared_march.map(|shared| {
                let side = shared.spacing.max(1);
                let marched = (width.div_ceil(side), height.div_ceil(side));
                let stored = |label: &str| sized(marched, label, radiance, stored);
                SharedMarchTargets::new(device, pixels, shared, stored)
            }),
            correction: needs
                .correction
                .then(|| Correction::new(device, width, height, needs.history)),
            reference: needs
                .reference
                .then(|| ReferenceTargets::new(device, (width, height), needs.correction, buffer)),
            film: buffer("film", 16),
            displayed: buffer("displayed", 4),
        })
    }
}
