//! Materials as the shaders read them.

use tyndall_scene::{Geometry, TextureRef, Wrap};
use tyndall_shaders::types::{self, NO_TEXTURE, TextureSlot};

use super::TextureArrays;
use super::upload::buffer;
use crate::engine::Device;

pub(super) fn upload(
    device: &Device,
    source: &Geometry,
    textures: Option<&TextureArrays>,
    data: Option<&TextureArrays>,
) -> wgpu::Buffer {
    buffer(
        device,
        "geometry.materials",
        bytemuck::cast_slice(&material_values(source, textures, data)),
        wgpu::BufferUsages::STORAGE,
    )
}

/// The materials, with the places of their textures.
pub(crate) fn material_values(
    source: &Geometry,
    textures: Option<&TextureArrays>,
    data: Option<&TextureArrays>,
) -> Vec<types::Material> {
    source
        .materials
        .iter()
        .map(|material| types::Material {
            base_color: material.base_color,
            emission: material.emission,
            alpha_cutoff: material.alpha_cutoff.unwrap_or(0.0),
            double_sided: material.double_sided.into(),
            base_color_slot: slot(source, textures, material.base_color_texture.as_ref()),
            emission_slot: slot(source, textures, material.emission_texture.as_ref()),
            metallic: material.metallic,
            roughness: material.roughness,
            normal_scale: material.normal_scale,
            diffuse_only: material.is_diffuse().into(),
            metallic_roughness_slot: slot(
                source,
                data,
                material.metallic_roughness_texture.as_ref(),
            ),
            normal_slot: slot(source, data, material.normal_texture.as_ref()),
            ..Default::default()
        })
        .collect()
}

fn slot(
    source: &Geometry,
    textures: Option<&TextureArrays>,
    used: Option<&TextureRef>,
) -> TextureSlot {
    let place = used.and_then(|used| textures?.place(used.texture).map(|place| (used, place)));
    let Some((used, (array, layer))) = place else {
        return TextureSlot {
            array: NO_TEXTURE,
            ..Default::default()
        };
    };
    let [wrap_u, wrap_v] = source.textures[used.texture].wrap.map(|wrap| match wrap {
        Wrap::Repeat => types::WRAP_REPEAT,
        Wrap::MirroredRepeat => types::WRAP_MIRRORED,
        Wrap::ClampToEdge => types::WRAP_CLAMP,
    });
    TextureSlot {
        transform_u: used.uv_transform[0],
        array,
        transform_v: used.uv_transform[1],
        layer,
        wrap_u,
        wrap_v,
        texcoord_set: used.texcoord_set.into(),
        padding: 0,
    }
}
