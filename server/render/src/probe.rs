//! For tests: single shaders on their own, with buffers bound by name.

use crate::device::Device;
use crate::error::RenderError;
use crate::programs::{Bindings, Constants, Programs, RasterTargets};
use crate::readback::read_now;
use crate::targets::GBUFFER_FORMATS;
use tyndall_shaders::{Stage, types};

/// How many of what a probe is built for.
#[derive(Debug, Clone, Copy, Default)]
pub struct Counts {
    /// Media.
    pub media: u32,
    /// Emissive triangles.
    pub emitters: u32,
}

/// [`run_for`] with `medium_count` media and nothing else.
pub fn run(
    device: &Device,
    shader: &str,
    medium_count: u32,
    buffers: &[(&'static str, &[u8])],
    output_bytes: u64,
    workgroups: u32,
) -> Result<Vec<u8>, RenderError> {
    let counts = Counts {
        media: medium_count,
        ..Counts::default()
    };
    run_for(device, shader, counts, buffers, output_bytes, workgroups)
}

/// Runs compute permutation `shader`, built for so many things, over `workgroups` × 1 × 1 with read-only `buffers` by name, and
/// returns the bytes of its buffer `outputs`, which starts at zero.
pub fn run_for(
    device: &Device,
    shader: &str,
    counts: Counts,
    buffers: &[(&'static str, &[u8])],
    output_bytes: u64,
    workgroups: u32,
) -> Result<Vec<u8>, RenderError> {
    let programs = Programs::default();
    let program = programs.compute(
        device,
        shader,
        Constants {
            medium_count: counts.media,
            emitter_count: counts.emitters,
            // Phase functions of every kind are asked for.
            mixed_phases: true,
            ..Constants::default()
        },
    )?;
    let buffer = |size: u64, usage: wgpu::BufferUsages| {
        device.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("probe"),
            size,
            usage,
            mapped_at_creation: false,
        })
    };
    let storage = wgpu::BufferUsages::STORAGE;
    let inputs: Vec<_> = buffers
        .iter()
        .map(|(name, bytes)| {
            let input = buffer(bytes.len() as u64, storage | wgpu::BufferUsages::COPY_DST);
            device.queue.write_buffer(&input, 0, bytes);
            (*name, input)
        })
        .collect();
    let outputs = buffer(output_bytes, storage | wgpu::BufferUsages::COPY_SRC);
    let staging = buffer(
        output_bytes,
        wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
    );
    let mut bindings = Bindings::default();
    for (name, input) in &inputs {
        bindings.buffer(name, input);
    }
    bindings.buffer("outputs", &outputs);
    let groups = program.bind(device, &bindings)?;
    let mut encoder = device
        .device
        .create_command_encoder(&wgpu::CommandEncoderDescriptor {
            label: Some("probe"),
        });
    {
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
        program.set(&mut pass, &groups);
        pass.dispatch_workgroups(workgroups, 1, 1);
    }
    encoder.copy_buffer_to_buffer(&outputs, 0, &staging, 0, None);
    device.queue.submit([encoder.finish()]);
    read_now(device, &staging)
}

/// Builds the pipeline of every permutation; returns the names of those that fail, with the reason.
pub fn failing_pipelines(device: &Device) -> Vec<String> {
    let programs = Programs::default();
    tyndall_shaders::all()
        .iter()
        .filter_map(|shader| {
            let built = if shader.has(Stage::Compute) {
                programs
                    .compute(device, shader.name, Constants::default())
                    .map(|_| ())
            } else {
                let colors = match (
                    shader.has(Stage::Fragment),
                    shader.name.contains("emissive"),
                ) {
                    _ if shader.name.starts_with("shadow_map") => 0,
                    (_, true) => 3,
                    (_, false) => 2,
                };
                let targets = RasterTargets {
                    colors: &GBUFFER_FORMATS[..colors],
                    depth_bias: wgpu::DepthBiasState::default(),
                };
                programs.raster(device, shader.name, &targets).map(|_| ())
            };
            built.err().map(|error| format!("{}: {error}", shader.name))
        })
        .collect()
}

/// The frame values that a view of `scene` would upload for sample `index`.
pub fn frame_values(
    scene: &tyndall_scene::Scene,
    size: (u32, u32),
    pixel_offset: [f32; 2],
) -> types::Frame {
    let facts = tyndall_scene::facts(scene);
    crate::gpu_scene::frame_values(
        scene,
        &facts,
        glam::DVec3::ZERO,
        size,
        crate::gpu_scene::SampleValues {
            pixel_offset,
            sample_index: 0,
            accumulated: 1,
            turn: 0,
            march: crate::plan::March::of(
                &facts,
                &scene.render,
                crate::plan::PlanLimits::default(),
            ),
        },
    )
}

/// The media of `scene` relative to its camera.
pub fn medium_values(scene: &tyndall_scene::Scene) -> Vec<types::Medium> {
    let origin = crate::gpu_scene::Origin(scene.camera.position);
    crate::gpu_scene::all_medium_values(&scene.media, origin)
}

/// Bytes of the BVH of `scene`'s geometry relative to the world's origin: nodes, vertices.
pub fn bvh_bytes(scene: &tyndall_scene::Scene) -> Result<(Vec<u8>, Vec<u8>), RenderError> {
    let parts = crate::gpu_scene::bvh_parts(&scene.geometry, glam::DVec3::ZERO)?;
    Ok((parts.nodes, parts.vertices))
}

/// What the device knows of `scene`'s emissive triangles, relative to the world's origin.
#[derive(Debug)]
pub struct EmitterBytes {
    /// Three a triangle, in the order of the BVH's leaves.
    pub vertices: Vec<u8>,
    /// One a triangle.
    pub surfaces: Vec<types::TriangleSurface>,
    /// Without textures.
    pub materials: Vec<types::Material>,
    /// By cumulative power.
    pub emitters: Vec<types::Emitter>,
}

/// The emissive triangles of `scene`, in buffers.
pub fn emitter_bytes(scene: &tyndall_scene::Scene) -> Result<EmitterBytes, RenderError> {
    let parts = crate::gpu_scene::bvh_parts(&scene.geometry, glam::DVec3::ZERO)?;
    let (surfaces, emitters) = crate::gpu_scene::triangle_values(&scene.geometry, &parts.order);
    Ok(EmitterBytes {
        vertices: parts.vertices,
        surfaces,
        materials: crate::gpu_scene::material_values(&scene.geometry, None, None),
        emitters,
    })
}

/// Radiance and density of every pixel of a map, and the alias table: threshold's bits, other pixel.
pub fn environment_values(map: &tyndall_scene::EnvironmentMap) -> (Vec<[f32; 4]>, Vec<[u32; 2]>) {
    crate::gpu_scene::environment_values(map)
}
