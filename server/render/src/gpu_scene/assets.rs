//! What views of one scene share on the device: geometry, grids, environment. Found by identity, so a
//! scene that differs in camera, lights or coefficients only uploads nothing of it again.

use std::sync::{Arc, Weak};

use tyndall_scene::Scene;

use super::{GpuEnvironment, GpuGeometry, GpuGrids, GpuPlacement};
use crate::device::Device;
use crate::error::RenderError;
use crate::programs::Bindings;

/// The shared parts of one scene.
#[derive(Debug, Clone)]
pub(crate) struct GpuAssets {
    pub geometry: Arc<GpuGeometry>,
    /// What of it depends on where instances stand.
    pub placement: Arc<GpuPlacement>,
    pub grids: Option<Arc<GpuGrids>>,
    pub environment: Option<Arc<GpuEnvironment>>,
}

impl GpuAssets {
    /// Adds what passes read of them.
    pub fn bind<'a>(&'a self, bindings: &mut Bindings<'a>) {
        self.geometry.bind(bindings);
        self.placement.bind(bindings);
        if let Some(grids) = &self.grids {
            grids.bind(bindings);
        }
        if let Some(environment) = &self.environment {
            environment.bind(bindings);
        }
    }
}

/// Parts that some view still uses.
#[derive(Debug, Default)]
pub(crate) struct AssetCache {
    geometries: Vec<Weak<GpuGeometry>>,
    placements: Vec<Weak<GpuPlacement>>,
    grids: Vec<Weak<GpuGrids>>,
    environments: Vec<Weak<GpuEnvironment>>,
    uploaded_geometries: u64,
}

impl AssetCache {
    /// The parts of a scene, uploaded where no view has them.
    pub fn assets(&mut self, device: &Device, scene: &Scene) -> Result<GpuAssets, RenderError> {
        let geometry = self.geometry(device, scene)?;
        let placement = found(find_or(
            &mut self.placements,
            |known| known.source == scene.geometry || known.source.same_placement(&scene.geometry),
            || Ok(Some(GpuPlacement::new(&scene.geometry))),
        )?)?;
        Ok(GpuAssets {
            geometry,
            placement,
            grids: find_or(
                &mut self.grids,
                |known| known.serve(scene),
                || GpuGrids::upload(device, scene),
            )?,
            environment: find_or(
                &mut self.environments,
                |known| known.serves(scene),
                || GpuEnvironment::upload(device, scene),
            )?,
        })
    }

    fn geometry(
        &mut self,
        device: &Device,
        scene: &Scene,
    ) -> Result<Arc<GpuGeometry>, RenderError> {
        let uploads = &mut self.uploaded_geometries;
        let upload = || {
            *uploads += 1;
            GpuGeometry::upload(device, &scene.geometry).map(Some)
        };
        found(find_or(
            &mut self.geometries,
            |known| known.source.same_surfaces(&scene.geometry),
            upload,
        )?)
    }

    /// How often meshes, materials and textures went to the device.
    pub fn uploaded_geometries(&self) -> u64 {
        self.uploaded_geometries
    }
}

/// Every scene has a geometry, if only an empty one.
fn found<T>(part: Option<Arc<T>>) -> Result<Arc<T>, RenderError> {
    part.ok_or_else(|| RenderError::Refused("no geometry".into()))
}

/// The known part that `serves`, or a new one.
fn find_or<T>(
    known: &mut Vec<Weak<T>>,
    serves: impl Fn(&T) -> bool,
    upload: impl FnOnce() -> Result<Option<T>, RenderError>,
) -> Result<Option<Arc<T>>, RenderError> {
    known.retain(|part| part.strong_count() > 0);
    let found = known
        .iter()
        .filter_map(Weak::upgrade)
        .find(|part| serves(part));
    if found.is_some() {
        return Ok(found);
    }
    let uploaded = upload()?.map(Arc::new);
    if let Some(part) = &uploaded {
        known.push(Arc::downgrade(part));
    }
    Ok(uploaded)
}
