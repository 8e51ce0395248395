//! What views of one scene share on the device: geometry, grids, environment. Found by identity, so a
//! scene that differs in camera, lights or coefficients only uploads nothing of it again.

use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, Weak};

use tyndall_scene::Scene;

use super::{GpuEnvironment, GpuGeometry, GpuGrids, GpuPlacement};
use crate::engine::{Bindings, Device};
use crate::error::RenderError;

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

/// Parts that some view still uses. Any thread may ask for some: nothing is held while others are made.
#[derive(Debug, Default)]
pub(crate) struct AssetCache {
    geometries: Known<GpuGeometry>,
    placements: Known<GpuPlacement>,
    grids: Known<GpuGrids>,
    environments: Known<GpuEnvironment>,
    uploaded_geometries: AtomicU64,
}

impl AssetCache {
    /// The parts of a scene, uploaded where no view has them.
    pub fn assets(&self, device: &Device, scene: &Scene) -> Result<GpuAssets, RenderError> {
        let upload_geometry = || {
            self.uploaded_geometries.fetch_add(1, Ordering::Relaxed);
            GpuGeometry::upload(device, &scene.geometry).map(Some)
        };
        let geometry = found(self.geometries.find_or(
            |known| known.source.same_surfaces(&scene.geometry),
            upload_geometry,
        )?)?;
        let placement = found(self.placements.find_or(
            |known| serves_placement(known, scene),
            || Ok(Some(GpuPlacement::new(&scene.geometry))),
        )?)?;
        Ok(GpuAssets {
            geometry,
            placement,
            grids: self.grids.find_or(
                |known| known.serve(scene),
                || GpuGrids::upload(device, scene),
            )?,
            environment: self.environments.find_or(
                |known| known.serves(scene),
                || GpuEnvironment::upload(device, scene),
            )?,
        })
    }

    /// The parts of a scene, if all of them are there.
    pub fn known(&self, scene: &Scene) -> Option<GpuAssets> {
        let grids = self.grids.find(|known| known.serve(scene));
        let environment = self.environments.find(|known| known.serves(scene));
        let is_whole = grids.is_some() == GpuGrids::is_needed(scene)
            && environment.is_some() == GpuEnvironment::is_needed(scene);
        let geometry = |known: &GpuGeometry| known.source.same_surfaces(&scene.geometry);
        is_whole.then_some(GpuAssets {
            geometry: self.geometries.find(geometry)?,
            placement: self
                .placements
                .find(|known| serves_placement(known, scene))?,
            grids,
            environment,
        })
    }

    /// How often meshes, materials and textures went to the device.
    pub fn uploaded_geometries(&self) -> u64 {
        self.uploaded_geometries.load(Ordering::Relaxed)
    }
}

fn serves_placement(known: &GpuPlacement, scene: &Scene) -> bool {
    known.source == scene.geometry || known.source.same_placement(&scene.geometry)
}

/// Every scene has a geometry, if only an empty one.
fn found<T>(part: Option<Arc<T>>) -> Result<Arc<T>, RenderError> {
    part.ok_or_else(|| RenderError::Refused("no geometry".into()))
}

/// Parts of one kind that some view still uses.
#[derive(Debug)]
struct Known<T>(Mutex<Vec<Weak<T>>>);

impl<T> Default for Known<T> {
    fn default() -> Self {
        Self(Mutex::default())
    }
}

impl<T> Known<T> {
    /// Whoever panicked left whole entries behind.
    fn lock(&self) -> MutexGuard<'_, Vec<Weak<T>>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The known part that `serves`.
    fn find(&self, serves: impl Fn(&T) -> bool) -> Option<Arc<T>> {
        let mut known = self.lock();
        known.retain(|part| part.strong_count() > 0);
        let mut parts = known.iter().filter_map(Weak::upgrade);
        parts.find(|part| serves(part))
    }

    /// The known part that `serves`, or a new one.
    fn find_or(
        &self,
        serves: impl Fn(&T) -> bool,
        upload: impl FnOnce() -> Result<Option<T>, RenderError>,
    ) -> Result<Option<Arc<T>>, RenderError> {
        if let Some(part) = self.find(serves) {
            return Ok(Some(part));
        }
        let uploaded = upload()?.map(Arc::new);
        if let Some(part) = &uploaded {
            self.lock().push(Arc::downgrade(part));
        }
        Ok(uploaded)
    }
}
