//! A scene on the device: geometry shared by every view of it, and the camera-relative values of one
//! view. Positions are subtracted from the camera in f64 before they become f32.

mod assets;
mod bvh;
mod camera;
mod environment;
mod geometry;
mod grids;
mod inputs;
mod materials;
mod placement;
mod textures;
mod triangles;
mod upload;
mod values;

pub(crate) use assets::{AssetCache, GpuAssets};
pub(crate) use bvh::{CpuBvh, CpuHit, GpuBvh, world_triangles};
#[cfg(feature = "probe")]
pub(crate) use camera::frame_values;
pub(crate) use camera::{SampleValues, columns, history_view, pixel_ray};
pub(crate) use environment::GpuEnvironment;
#[cfg(feature = "probe")]
pub(crate) use environment::environment_values;
pub(crate) use geometry::{DrawClass, GpuGeometry, VERTEX_LAYOUT};
pub(crate) use grids::GpuGrids;
pub(crate) use inputs::Inputs;
#[cfg(feature = "probe")]
pub(crate) use materials::material_values;
pub(crate) use placement::GpuPlacement;
pub(crate) use textures::{TextureArrays, TextureKind};
pub(crate) use triangles::GpuTriangles;
#[cfg(feature = "probe")]
pub(crate) use triangles::triangle_values;
pub(crate) use values::{Origin, all_medium_values, instance_values, light_values};
