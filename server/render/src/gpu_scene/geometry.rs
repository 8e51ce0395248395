//! Vertices, indices, draws, materials and textures of a geometry, uploaded once and shared by all its
//! placements.

use bytemuck::{Pod, Zeroable};
use tyndall_scene::{Geometry, SharedGeometry};

use super::upload::{buffer, check};
use super::{TextureArrays, TextureKind, materials};
use crate::engine::{Bindings, Device, DrawCall};
use crate::error::RenderError;

/// One vertex: position, normal, two texture coordinates, colour.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
struct Vertex {
    position: [f32; 3],
    normal: [f32; 3],
    texcoord0: [f32; 2],
    texcoord1: [f32; 2],
    color: [u8; 4],
}

/// Layout of the vertex buffer; locations as in the raster shaders.
pub(crate) static VERTEX_LAYOUT: wgpu::VertexBufferLayout<'static> = wgpu::VertexBufferLayout {
    array_stride: size_of::<Vertex>() as u64,
    step_mode: wgpu::VertexStepMode::Vertex,
    attributes: &wgpu::vertex_attr_array![
        0 => Float32x3, 1 => Float32x3, 2 => Float32x2, 3 => Float32x2, 4 => Unorm8x4
    ],
};

/// Which pipeline a draw needs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum DrawClass {
    /// Every fragment stays: early depth test.
    Opaque,
    /// Single-sided: fragments seen from behind go.
    SingleSided,
    /// Fragments below the alpha cutoff go, in shadow maps too.
    Masked,
}

/// One mesh drawn for a run of instances.
#[derive(Debug, Clone)]
pub(crate) struct Draw {
    pub class: DrawClass,
    pub indices: std::ops::Range<u32>,
    pub base_vertex: i32,
    pub instances: std::ops::Range<u32>,
}

impl Draw {
    /// What a raster pass draws.
    pub fn call(&self) -> DrawCall<'static> {
        DrawCall::Indexed {
            indices: self.indices.clone(),
            base_vertex: self.base_vertex,
            instances: self.instances.clone(),
        }
    }
}

/// Geometry on the device.
#[derive(Debug)]
pub(crate) struct GpuGeometry {
    /// The placement it was uploaded for; any other of the same surfaces is drawn with it, too.
    pub source: SharedGeometry,
    pub vertices: wgpu::Buffer,
    pub indices: wgpu::Buffer,
    pub draws: Vec<Draw>,
    /// Order of `source.instances` in the instance buffer.
    pub instance_order: Vec<usize>,
    pub materials: wgpu::Buffer,
    /// Base colour and emission.
    pub textures: Option<TextureArrays>,
    /// Metallic-roughness and normal maps: only the reference reads them.
    pub data_textures: Option<TextureArrays>,
}

impl GpuGeometry {
    /// Uploads a geometry. Errors where the device's buffers are too small for it.
    pub fn upload(device: &Device, source: &SharedGeometry) -> Result<Self, RenderError> {
        let mut vertices = Vec::new();
        let mut indices = Vec::new();
        let mut ranges = Vec::with_capacity(source.meshes.len());
        for mesh in &source.meshes {
            let base_vertex = vertices.len();
            let first = indices.len() as u32;
            vertices.extend((0..mesh.positions.len()).map(|i| Vertex {
                position: mesh.positions[i],
                normal: mesh.normals[i],
                texcoord0: mesh.texcoords[0].get(i).copied().unwrap_or_default(),
                texcoord1: mesh.texcoords[1].get(i).copied().unwrap_or_default(),
                color: mesh.colors.get(i).copied().unwrap_or([255; 4]),
            }));
            indices.extend_from_slice(&mesh.indices);
            ranges.push((base_vertex, first..indices.len() as u32));
        }
        let limits = device.device.limits();
        for (what, bytes) in [
            ("bytes of vertices", size_of_val(vertices.as_slice())),
            ("bytes of indices", size_of_val(indices.as_slice())),
        ] {
            check(
                what,
                bytes as u64,
                limits.max_buffer_size.min(i32::MAX as u64),
            )?;
        }
        let mut instance_order: Vec<usize> = (0..source.instances.len()).collect();
        let key = |i: &usize| {
            let mesh = source.instances[*i].mesh;
            (class_of(source, mesh), mesh)
        };
        instance_order.sort_by_key(key);
        let draws = group_draws(source, &instance_order, &ranges);
        let textures = TextureArrays::upload(device, source, TextureKind::Color)?;
        let data_textures = TextureArrays::upload(device, source, TextureKind::Data)?;
        let materials =
            materials::upload(device, source, textures.as_ref(), data_textures.as_ref());
        Ok(Self {
            vertices: buffer(
                device,
                "geometry.vertices",
                bytemuck::cast_slice(&vertices),
                wgpu::BufferUsages::VERTEX,
            ),
            indices: buffer(
                device,
                "geometry.indices",
                bytemuck::cast_slice(&indices),
                wgpu::BufferUsages::INDEX,
            ),
            draws,
            instance_order,
            materials,
            textures,
            data_textures,
            source: source.clone(),
        })
    }

    /// Adds what passes read of it.
    pub fn bind<'a>(&'a self, bindings: &mut Bindings<'a>) {
        bindings.buffer("materials", &self.materials);
        // A geometry with textures of one kind only binds them as both: nothing is sampled.
        if let Some(data) = self.data_textures.as_ref().or(self.textures.as_ref()) {
            bindings
                .texture("data_array_0", data.view(0))
                .texture("data_array_1", data.view(1))
                .texture("data_array_2", data.view(2))
                .texture("data_array_3", data.view(3));
        }
        if let Some(textures) = self.textures.as_ref().or(self.data_textures.as_ref()) {
            bindings
                .texture("texture_array_0", textures.view(0))
                .texture("texture_array_1", textures.view(1))
                .texture("texture_array_2", textures.view(2))
                .texture("texture_array_3", textures.view(3))
                .sampler("texture_sampler", &textures.sampler);
        }
    }
}

fn class_of(source: &Geometry, mesh: usize) -> DrawClass {
    let material = &source.materials[source.meshes[mesh].material];
    if material.alpha_cutoff.is_some() {
        DrawClass::Masked
    } else if material.double_sided {
        DrawClass::Opaque
    } else {
        DrawClass::SingleSided
    }
}

fn group_draws(
    source: &Geometry,
    order: &[usize],
    ranges: &[(usize, std::ops::Range<u32>)],
) -> Vec<Draw> {
    let mut draws: Vec<Draw> = Vec::new();
    let mut last_mesh = None;
    for (slot, index) in order.iter().enumerate() {
        let mesh = source.instances[*index].mesh;
        let slot = slot as u32;
        if last_mesh == Some(mesh)
            && let Some(draw) = draws.last_mut()
        {
            draw.instances.end = slot + 1;
            continue;
        }
        last_mesh = Some(mesh);
        let (base_vertex, indices) = &ranges[mesh];
        draws.push(Draw {
            class: class_of(source, mesh),
            indices: indices.clone(),
            base_vertex: *base_vertex as i32,
            instances: slot..slot + 1,
        });
    }
    draws
}
