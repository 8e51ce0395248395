//! For tests: single shaders on their own, with buffers bound by name.

pub mod engine;

use crate::engine::{Bindings, Constants, Device, Pipelines, read_now};
use crate::error::RenderError;
use crate::stages::{shadow_maps, surfaces};
use tyndall_shaders::{Shader, Stage, types};

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
    shader: &'static Shader,
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

/// Runs a compute shader, of whatever table, built for so many things, over `workgroups` × 1 × 1 with
/// read-only `buffers` by name, and returns the bytes of its buffer `outputs`, which starts at zero.
pub fn run_for(
    device: &Device,
    shader: &'static Shader,
    counts: Counts,
    buffers: &[(&'static str, &[u8])],
    output_bytes: u64,
    workgroups: u32,
) -> Result<Vec<u8>, RenderError> {
    let constants = Constants::default()
        .number("MEDIUM_COUNT", counts.media)
        .flag("EMITTERS", counts.emitters > 0)
        // Phase functions of every kind are asked for.
        .flag("MIXED_PHASES", true);
    let program = Pipelines::default().compute_of(device, shader, &constants)?;
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

/// Builds the pipeline of a shader, of whatever table.
pub fn build(device: &Device, shader: &'static Shader) -> Result<(), RenderError> {
    let pipelines = Pipelines::default();
    if shader.has(Stage::Compute) {
        pipelines
            .compute_of(device, shader, &Constants::default())
            .map(|_| ())
    } else {
        pipelines
            .raster_of(device, shader, &engine::added_state())
            .map(|_| ())
    }
}

/// Builds the pipeline of every permutation; returns the names of those that fail, with the reason.
pub fn failing_pipelines(device: &Device) -> Vec<String> {
    let pipelines = Pipelines::default();
    tyndall_shaders::all()
        .iter()
        .filter_map(|shader| {
            let built = if shader.has(Stage::Compute) {
                pipelines
                    .compute(device, shader.name, &Constants::default())
                    .map(|_| ())
            } else {
                let state = if shader.name.starts_with("shadow_map") {
                    shadow_maps::depth_state()
                } else if shader.name.contains("emissive") {
                    surfaces::gbuffer_state(3)
                } else {
                    surfaces::gbuffer_state(2)
                };
                pipelines.raster(device, shader.name, &state).map(|_| ())
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
            restart: 0,
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
    let bvh = crate::gpu_scene::CpuBvh::build(&scene.geometry, glam::DVec3::ZERO)?;
    Ok(bvh.bytes())
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
    let bvh = crate::gpu_scene::CpuBvh::build(&scene.geometry, glam::DVec3::ZERO)?;
    let (surfaces, emitters) = crate::gpu_scene::triangle_values(&scene.geometry, bvh.order());
    Ok(EmitterBytes {
        vertices: bvh.bytes().1,
        surfaces,
        materials: crate::gpu_scene::material_values(&scene.geometry, None, None),
        emitters,
    })
}

/// Radiance and density of every pixel of a map, and the alias table: threshold's bits, other pixel.
pub fn environment_values(map: &tyndall_scene::EnvironmentMap) -> (Vec<[f32; 4]>, Vec<[u32; 2]>) {
    crate::gpu_scene::environment_values(map)
}
