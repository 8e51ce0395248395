//! What the engine can do that no pass needs alone, on real resources of a pool: draws without geometry
//! that add up, single levels of a texture, volumes, indirect draws.

use tyndall_shaders::Shader;

use crate::engine::{
    Access, Bindings, Bytes, ColorTarget, Device, DrawCall, Extent, Pipelines, Pool, RasterDraw,
    RasterPass, RasterState, Recording, ResourceSpec, Timing, ViewResources, cleared, kept,
    read_now,
};
use crate::error::RenderError;

/// Side of the picture that is drawn into. Unit: pixel.
pub const SIDE: u32 = 16;
/// Levels of the texture.
const LEVELS: u32 = 3;
/// Half floats, which every device can add up in.
const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;
const TARGET: ResourceSpec = ResourceSpec::texture("target", FORMAT).with_mips(LEVELS);
const COUNTS: ResourceSpec = ResourceSpec::buffer("counts", Bytes::Fixed(16)).kept();
const VOLUME: ResourceSpec = ResourceSpec::texture("volume", wgpu::TextureFormat::Rgba32Float)
    .sized(Extent::Volume([4, 4, 8]));

/// Draws with `shader` into level 1: `instances` triangles that cover it, then as many by an indirect draw
/// that keeps what is there; returns the red channel of levels 0 and 1, row by row.
pub fn added_levels(
    device: &Device,
    shader: &'static Shader,
    instances: u32,
) -> Result<[Vec<f32>; 2], RenderError> {
    let accesses = [TARGET.drawn(), COUNTS.written(), COUNTS.counted()];
    let resources = fit(device, &accesses)?;
    let missing = || RenderError::Refused("the pool made no such resource".into());
    let level = |i| resources.level(TARGET.name, i).ok_or_else(missing);
    let counts = resources.buffer(COUNTS.name).ok_or_else(missing)?;
    let words: [u32; 4] = [3, instances, 0, 0];
    device
        .queue
        .write_buffer(counts, 0, bytemuck::cast_slice(&words));
    let pipelines = Pipelines::default();
    let timing = Timing::new(device);
    let mut recording = Recording::new(device, &pipelines, &timing, false);
    let state = added_state();
    let direct = DrawCall::Vertices {
        vertices: 0..3,
        instances: 0..instances,
    };
    let indirect = DrawCall::Indirect(counts);
    let drawn = level(1)?;
    for (attachment, call) in [(cleared(drawn), direct), (kept(drawn), indirect)] {
        recording.raster(
            "draw",
            &RasterPass {
                state: &state,
                colors: &[attachment],
                depth: None,
                geometry: None,
                draws: &[RasterDraw { shader, call }],
            },
            &Bindings::default(),
        )?;
    }
    device.queue.submit(recording.finish().parts);
    Ok([
        read_level(device, level(0)?, (0, SIDE))?,
        read_level(device, level(1)?, (1, SIDE / 2))?,
    ])
}

/// State of draws without geometry that add up.
pub(super) fn added_state() -> RasterState {
    RasterState {
        vertices: None,
        topology: wgpu::PrimitiveTopology::TriangleList,
        colors: vec![ColorTarget::added(FORMAT)],
        depth: None,
    }
}

/// Bytes that the pool says a view needs with the texture, its levels and a volume.
pub fn pool_bytes(device: &Device) -> Result<u64, RenderError> {
    Ok(fit(device, &[TARGET.drawn(), VOLUME.written()])?.bytes())
}

/// Bytes of two textures of which one is written after the other was read last, and of two that overlap.
pub fn shared_bytes(device: &Device) -> Result<[u64; 2], RenderError> {
    let a = ResourceSpec::texture("a", FORMAT);
    let b = ResourceSpec::texture("b", FORMAT);
    let apart: [&[Access]; 4] = [&[a.written()], &[a.read()], &[b.written()], &[b.read()]];
    let together: [&[Access]; 3] = [&[a.written()], &[b.written()], &[a.read(), b.read()]];
    let bytes = |passes: &[&[Access]]| {
        let fitted = Pool::default().fit(device, passes, [SIDE, SIDE], None, true);
        fitted.map(|resources| resources.bytes())
    };
    Ok([bytes(&apart)?, bytes(&together)?])
}

fn fit(device: &Device, accesses: &[Access]) -> Result<ViewResources, RenderError> {
    Pool::default().fit(device, &[accesses], [SIDE, SIDE], None, true)
}

/// The red channel of a texture's level.
fn read_level(
    device: &Device,
    view: &wgpu::TextureView,
    (level, side): (u32, u32),
) -> Result<Vec<f32>, RenderError> {
    // Rows of a copy start at multiples of this.
    let row = (side * 8).next_multiple_of(256);
    let staging = device.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("probe.level"),
        size: u64::from(row * side),
        usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    });
    let mut encoder = device
        .device
        .create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    encoder.copy_texture_to_buffer(
        wgpu::TexelCopyTextureInfo {
            texture: view.texture(),
            mip_level: level,
            origin: wgpu::Origin3d::ZERO,
            aspect: wgpu::TextureAspect::All,
        },
        wgpu::TexelCopyBufferInfo {
            buffer: &staging,
            layout: wgpu::TexelCopyBufferLayout {
                offset: 0,
                bytes_per_row: Some(row),
                rows_per_image: None,
            },
        },
        wgpu::Extent3d {
            width: side,
            height: side,
            depth_or_array_layers: 1,
        },
    );
    device.queue.submit([encoder.finish()]);
    let bytes = read_now(device, &staging)?;
    let texel = |bytes: &[u8]| half(u16::from_le_bytes([bytes[0], bytes[1]]));
    let rows = bytes.chunks_exact(row as usize);
    Ok(rows
        .flat_map(|row| row[..side as usize * 8].chunks_exact(8).map(texel))
        .collect())
}

/// Value of a half float that is neither infinite nor subnormal.
fn half(bits: u16) -> f32 {
    if bits == 0 {
        return 0.0;
    }
    let exponent = f32::from((bits >> 10) & 31) - 15.0;
    (1.0 + f32::from(bits & 1023) / 1024.0) * exponent.exp2()
}
