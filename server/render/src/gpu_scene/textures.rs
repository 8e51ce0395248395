//! Textures as layers of arrays, one array a size class: no driver feature beyond the core is needed.
//!
//! Only what some pass reads is uploaded, colours and data apart. A texture that is not square or not a
//! power of two is resampled bilinearly in linear light to the class that holds it.

use tyndall_scene::{Geometry, Material, Texture, TextureRef};

use super::upload::check;
use crate::engine::Device;
use crate::error::RenderError;

/// Sides of the size classes. Larger textures are reduced to the last. Unit: texel.
const CLASSES: [u32; 4] = [64, 256, 1024, 2048];
/// Bytes of all arrays together that are allowed: 2 GiB.
const MAX_BYTES: u64 = 2 << 30;

/// What textures hold.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum TextureKind {
    /// Base colour and emission, sRGB-encoded.
    Color,
    /// Roughness, metalness and normals, as they are.
    Data,
}

impl TextureKind {
    fn of(self, material: &Material) -> [Option<&TextureRef>; 2] {
        match self {
            Self::Color => [
                material.base_color_texture.as_ref(),
                material.emission_texture.as_ref(),
            ],
            Self::Data => [
                material.metallic_roughness_texture.as_ref(),
                material.normal_texture.as_ref(),
            ],
        }
    }

    fn format(self) -> wgpu::TextureFormat {
        match self {
            Self::Color => wgpu::TextureFormat::Rgba8UnormSrgb,
            Self::Data => wgpu::TextureFormat::Rgba8Unorm,
        }
    }

    /// Value of every byte.
    fn decode_table(self) -> [f32; 256] {
        match self {
            Self::Color => srgb_table(),
            Self::Data => std::array::from_fn(|i| i as f32 / 255.0),
        }
    }
}

/// Uploaded texture arrays.
#[derive(Debug)]
pub(crate) struct TextureArrays {
    /// One view a class in use, at most four.
    views: Vec<wgpu::TextureView>,
    pub sampler: wgpu::Sampler,
    /// (array, layer) by index into `Geometry::textures`.
    places: Vec<Option<(u32, u32)>>,
}

impl TextureArrays {
    /// Uploads what the materials use of one kind; `None` without any.
    pub fn upload(
        device: &Device,
        source: &Geometry,
        kind: TextureKind,
    ) -> Result<Option<Self>, RenderError> {
        let mut used: Vec<usize> = source
            .materials
            .iter()
            .flat_map(|material| kind.of(material))
            .filter_map(|reference| reference.map(|r| r.texture))
            .collect();
        used.sort_unstable();
        used.dedup();
        if used.is_empty() {
            return Ok(None);
        }
        let mut places = vec![None; source.textures.len()];
        let mut views = Vec::new();
        let mut bytes = 0_u64;
        for (class, side) in CLASSES.iter().enumerate() {
            let members: Vec<usize> = used
                .iter()
                .copied()
                .filter(|i| class_of(&source.textures[*i]) == class)
                .collect();
            if members.is_empty() {
                continue;
            }
            let layers = members.len() as u64;
            check(
                "texture layers of one size",
                layers,
                device.device.limits().max_texture_array_layers.into(),
            )?;
            bytes += layers * u64::from(*side) * u64::from(*side) * 16 / 3;
            check("bytes of textures", bytes, MAX_BYTES)?;
            for (layer, index) in members.iter().enumerate() {
                places[*index] = Some((views.len() as u32, layer as u32));
            }
            views.push(upload_array(device, source, &members, *side, kind));
        }
        let sampler = device.device.create_sampler(&wgpu::SamplerDescriptor {
            label: Some("geometry.texture_sampler"),
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            mipmap_filter: wgpu::MipmapFilterMode::Linear,
            anisotropy_clamp: 4,
            address_mode_u: wgpu::AddressMode::Repeat,
            address_mode_v: wgpu::AddressMode::Repeat,
            ..Default::default()
        });
        Ok(Some(Self {
            views,
            sampler,
            places,
        }))
    }

    /// Array and layer of a texture.
    pub fn place(&self, texture: usize) -> Option<(u32, u32)> {
        self.places.get(texture).copied().flatten()
    }

    /// View to bind as array `index`; classes that are not in use repeat the first.
    pub fn view(&self, index: usize) -> &wgpu::TextureView {
        self.views.get(index).unwrap_or(&self.views[0])
    }
}

fn class_of(texture: &Texture) -> usize {
    let side = texture.width.max(texture.height);
    CLASSES
        .iter()
        .position(|class| side <= *class)
        .unwrap_or(CLASSES.len() - 1)
}

fn upload_array(
    device: &Device,
    source: &Geometry,
    members: &[usize],
    side: u32,
    kind: TextureKind,
) -> wgpu::TextureView {
    let levels = side.ilog2() + 1;
    let texture = device.device.create_texture(&wgpu::TextureDescriptor {
        label: Some("geometry.textures"),
        size: wgpu::Extent3d {
            width: side,
            height: side,
            depth_or_array_layers: members.len() as u32,
        },
        mip_level_count: levels,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: kind.format(),
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    });
    let decode = kind.decode_table();
    for (layer, index) in members.iter().enumerate() {
        let mut level_pixels = resample(&source.textures[*index], side, &decode);
        let mut level_side = side;
        for level in 0..levels {
            write_level(
                device,
                &texture,
                level,
                layer as u32,
                level_side,
                &level_pixels,
                &decode,
            );
            if level_side > 1 {
                level_pixels = halve(&level_pixels, level_side);
                level_side /= 2;
            }
        }
    }
    texture.create_view(&wgpu::TextureViewDescriptor {
        dimension: Some(wgpu::TextureViewDimension::D2Array),
        ..Default::default()
    })
}

fn write_level(
    device: &Device,
    texture: &wgpu::Texture,
    level: u32,
    layer: u32,
    side: u32,
    pixels: &[[f32; 4]],
    decode: &[f32; 256],
) {
    let bytes: Vec<u8> = pixels
        .iter()
        .flat_map(|p| {
            [
                encode(p[0], decode),
                encode(p[1], decode),
                encode(p[2], decode),
                (p[3] * 255.0 + 0.5) as u8,
            ]
        })
        .collect();
    device.queue.write_texture(
        wgpu::TexelCopyTextureInfo {
            texture,
            mip_level: level,
            origin: wgpu::Origin3d {
                x: 0,
                y: 0,
                z: layer,
            },
            aspect: wgpu::TextureAspect::All,
        },
        &bytes,
        wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some(4 * side),
            rows_per_image: Some(side),
        },
        wgpu::Extent3d {
            width: side,
            height: side,
            depth_or_array_layers: 1,
        },
    );
}

/// sRGB decoding of every byte (IEC 61966-2-1).
fn srgb_table() -> [f32; 256] {
    std::array::from_fn(|i| {
        let x = i as f32 / 255.0;
        if x <= 0.04045 {
            x / 12.92
        } else {
            ((x + 0.055) / 1.055).powf(2.4)
        }
    })
}

/// The byte whose decoded value is nearest.
fn encode(linear: f32, decode: &[f32; 256]) -> u8 {
    let above = decode.partition_point(|value| *value < linear).min(255);
    let below = above.saturating_sub(1);
    if linear - decode[below] < decode[above] - linear {
        below as u8
    } else {
        above as u8
    }
}

/// The texture at `side` × `side` in linear light, alpha as it is.
fn resample(texture: &Texture, side: u32, decode: &[f32; 256]) -> Vec<[f32; 4]> {
    let (width, height) = (texture.width as usize, texture.height as usize);
    let texel = |x: usize, y: usize| {
        let p = &texture.pixels[4 * (y * width + x)..][..4];
        [
            decode[p[0] as usize],
            decode[p[1] as usize],
            decode[p[2] as usize],
            f32::from(p[3]) / 255.0,
        ]
    };
    let n = side as usize;
    if width == n && height == n {
        return (0..n * n).map(|i| texel(i % n, i / n)).collect();
    }
    let mut out = Vec::with_capacity(n * n);
    for y in 0..n {
        let (y0, y1, fy) = taps(y, n, height);
        for x in 0..n {
            let (x0, x1, fx) = taps(x, n, width);
            let (a, b, c, d) = (texel(x0, y0), texel(x1, y0), texel(x0, y1), texel(x1, y1));
            out.push(std::array::from_fn(|k| {
                let top = a[k] + (b[k] - a[k]) * fx;
                let bottom = c[k] + (d[k] - c[k]) * fx;
                top + (bottom - top) * fy
            }));
        }
    }
    out
}

/// Neighbours and weight for output texel `i` of `n` in a row of `source` texels.
fn taps(i: usize, n: usize, source: usize) -> (usize, usize, f32) {
    let position =
        ((i as f32 + 0.5) * source as f32 / n as f32 - 0.5).clamp(0.0, source as f32 - 1.0);
    let first = position as usize;
    (first, (first + 1).min(source - 1), position - first as f32)
}

/// 2×2 box means.
fn halve(pixels: &[[f32; 4]], side: u32) -> Vec<[f32; 4]> {
    let n = side as usize;
    let mut out = Vec::with_capacity(n * n / 4);
    for y in (0..n).step_by(2) {
        for x in (0..n).step_by(2) {
            let at = |dx: usize, dy: usize| &pixels[(y + dy) * n + x + dx];
            let (a, b, c, d) = (at(0, 0), at(1, 0), at(0, 1), at(1, 1));
            out.push(std::array::from_fn(|k| 0.25 * (a[k] + b[k] + c[k] + d[k])));
        }
    }
    out
}
