//! An equirectangular environment on the device: radiance, and how to choose bright directions.

use tyndall_scene::{EnvironmentDistribution, EnvironmentMap, Scene};

use super::upload::{buffer, check};
use crate::engine::{Bindings, Device};
use crate::error::RenderError;

/// An uploaded environment map.
#[derive(Debug)]
pub(crate) struct GpuEnvironment {
    source: EnvironmentMap,
    /// Radiance and density over solid angle, row by row from the top.
    pixels: wgpu::Buffer,
    /// Alias table: threshold's bits and the other pixel.
    alias: wgpu::Buffer,
}

/// The map that lights a scene, unless it is black.
fn used(scene: &Scene) -> Option<&EnvironmentMap> {
    let environment = scene.environment.as_ref()?;
    let map = environment.map.as_ref()?;
    (environment.radiance != [0.0; 3]).then_some(map)
}

/// Radiance and density of every pixel, and the alias table.
pub(crate) fn environment_values(map: &EnvironmentMap) -> (Vec<[f32; 4]>, Vec<[u32; 2]>) {
    let distribution = EnvironmentDistribution::new(map);
    let pixels = map
        .pixels
        .iter()
        .zip(&distribution.pdf)
        .map(|([r, g, b], pdf)| [*r, *g, *b, *pdf])
        .collect();
    let alias = distribution
        .threshold
        .iter()
        .zip(&distribution.alias)
        .map(|(threshold, alias)| [threshold.to_bits(), *alias])
        .collect();
    (pixels, alias)
}

impl GpuEnvironment {
    /// Uploads the environment map of a scene; `None` without one.
    pub fn upload(device: &Device, scene: &Scene) -> Result<Option<Self>, RenderError> {
        let Some(map) = used(scene) else {
            return Ok(None);
        };
        let (pixels, alias) = environment_values(map);
        let limit = device.device.limits().max_storage_buffer_binding_size;
        check("bytes of environment", pixels.len() as u64 * 16, limit)?;
        let storage = wgpu::BufferUsages::STORAGE;
        Ok(Some(Self {
            source: map.clone(),
            pixels: buffer(
                device,
                "environment.pixels",
                bytemuck::cast_slice(&pixels),
                storage,
            ),
            alias: buffer(
                device,
                "environment.alias",
                bytemuck::cast_slice(&alias),
                storage,
            ),
        }))
    }

    /// Whether `scene` has one.
    pub fn is_needed(scene: &Scene) -> bool {
        used(scene).is_some()
    }

    /// Whether this is the environment of `scene`.
    pub fn serves(&self, scene: &Scene) -> bool {
        used(scene) == Some(&self.source)
    }

    /// Adds what passes read of it.
    pub fn bind<'a>(&'a self, bindings: &mut Bindings<'a>) {
        bindings
            .buffer("environment_pixels", &self.pixels)
            .buffer("environment_alias", &self.alias);
    }
}
