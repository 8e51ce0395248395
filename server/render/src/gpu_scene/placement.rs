//! What depends on where instances stand and is made only where rays are traced: the BVH and the
//! attributes of its triangles.
//!
//! Another placement gets another BVH rather than a refitted one: it costs one build a frame in which
//! something moved (0.29 s for 100,000 triangles, measured on one core of a busy machine in the
//! development profile), keeps traversal as fast as for a still scene, and the same placement always
//! gives the same bits. Passes that trace no rays pay nothing of it.

use std::sync::{Arc, OnceLock};

use glam::DVec3;
use tyndall_scene::SharedGeometry;

use super::bvh::CpuBvh;
use super::{GpuBvh, GpuTriangles};
use crate::engine::{Bindings, Device};
use crate::error::RenderError;

/// One placement of a geometry.
#[derive(Debug)]
pub(crate) struct GpuPlacement {
    pub source: SharedGeometry,
    /// Point that BVH coordinates are relative to: the middle of the surfaces.
    pub anchor: DVec3,
    cpu_bvh: OnceLock<Arc<CpuBvh>>,
    bvh: OnceLock<GpuBvh>,
    triangles: OnceLock<GpuTriangles>,
}

impl GpuPlacement {
    /// Uploads nothing yet.
    pub fn new(source: &SharedGeometry) -> Self {
        let middle = |bounds: tyndall_scene::Aabb| 0.5 * (bounds.min + bounds.max);
        Self {
            source: source.clone(),
            anchor: source.bounds().map_or(DVec3::ZERO, middle),
            cpu_bvh: OnceLock::new(),
            bvh: OnceLock::new(),
            triangles: OnceLock::new(),
        }
    }

    /// The BVH on the CPU, built on the first call.
    pub fn cpu_bvh(&self) -> Result<Arc<CpuBvh>, RenderError> {
        if let Some(known) = self.cpu_bvh.get() {
            return Ok(Arc::clone(known));
        }
        let built = Arc::new(CpuBvh::build(&self.source, self.anchor)?);
        Ok(Arc::clone(self.cpu_bvh.get_or_init(|| built)))
    }

    /// Builds and uploads the BVH on the first call.
    pub fn need_bvh(&self, device: &Device) -> Result<(), RenderError> {
        if self.bvh.get().is_none() {
            let built = GpuBvh::upload(device, self.cpu_bvh()?)?;
            self.bvh.get_or_init(|| built);
        }
        Ok(())
    }

    /// Uploads what paths ask about triangles on the first call; builds the BVH, too.
    pub fn need_triangles(&self, device: &Device) -> Result<(), RenderError> {
        self.need_bvh(device)?;
        if let Some(bvh) = self.bvh.get()
            && self.triangles.get().is_none()
        {
            let uploaded = GpuTriangles::upload(device, &self.source, bvh)?;
            self.triangles.get_or_init(|| uploaded);
        }
        Ok(())
    }

    /// Whether the BVH is built, and with `triangles` what paths ask about them, too.
    pub fn has(&self, triangles: bool) -> bool {
        self.bvh.get().is_some() && (!triangles || self.triangles.get().is_some())
    }

    /// Emissive triangles, once they are uploaded.
    pub fn emitter_count(&self) -> u32 {
        self.triangles.get().map_or(0, |t| t.emitter_count)
    }

    /// Adds what passes read of it, once it is built.
    pub fn bind<'a>(&'a self, bindings: &mut Bindings<'a>) {
        if let Some(bvh) = self.bvh.get() {
            bindings
                .buffer("bvh_nodes", &bvh.nodes)
                .buffer("bvh_vertices", &bvh.vertices);
        }
        if let Some(triangles) = self.triangles.get() {
            bindings
                .buffer("triangle_surfaces", &triangles.surfaces)
                .buffer("emitters", &triangles.emitters);
        }
    }
}
