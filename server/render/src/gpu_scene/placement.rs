//! What depends on where instances stand and is made only where rays are traced: the BVH and the
//! attributes of its triangles.
//!
//! Another placement gets another BVH rather than a refitted one: it costs one build a frame in which
//! something moved (0.29 s for 100,000 triangles, measured on one core of a busy machine in the
//! development profile), keeps traversal as fast as for a still scene, and the same placement always
//! gives the same bits. Passes that trace no rays pay nothing of it.

use std::sync::OnceLock;

use glam::DVec3;
use tyndall_scene::SharedGeometry;

use super::{GpuBvh, GpuTriangles};
use crate::device::Device;
use crate::error::RenderError;
use crate::programs::Bindings;

/// One placement of a geometry.
#[derive(Debug)]
pub(crate) struct GpuPlacement {
    pub source: SharedGeometry,
    /// Point that BVH coordinates are relative to: the middle of the surfaces.
    pub anchor: DVec3,
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
            bvh: OnceLock::new(),
            triangles: OnceLock::new(),
        }
    }

    /// Builds and uploads the BVH on the first call.
    pub fn need_bvh(&self, device: &Device) -> Result<(), RenderError> {
        if self.bvh.get().is_none() {
            let built = GpuBvh::build(device, &self.source, self.anchor)?;
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
