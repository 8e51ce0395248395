//! Density grids on the device: the brick atlases of all grids of a scene, one after the other.

use tyndall_scene::{Medium, MediumShape, Scene, SharedGrid};
use tyndall_shaders::types;
use tyndall_volume::{AtlasLimits, BRICK_SIDE, BrickAtlas};

use super::Origin;
use super::upload::{buffer, check};
use crate::engine::{Bindings, Device};
use crate::error::RenderError;

/// Uploaded grids.
#[derive(Debug)]
pub(crate) struct GpuGrids {
    sources: Vec<SharedGrid>,
    places: Vec<Place>,
    tables: wgpu::Buffer,
    values: wgpu::Buffer,
    ranges: wgpu::Buffer,
    majorants: wgpu::Buffer,
}

/// Where a grid's parts begin, and its lattice without the placement in the world.
#[derive(Debug, Clone, Copy)]
struct Place {
    value: types::Grid,
    origin: glam::DVec3,
}

/// The grids that a scene's media use, each once.
fn used(scene: &Scene) -> Vec<SharedGrid> {
    let mut grids: Vec<SharedGrid> = Vec::new();
    for medium in &scene.media {
        if let MediumShape::Grid { grid, .. } = &medium.shape
            && !grids.contains(grid)
        {
            grids.push(grid.clone());
        }
    }
    grids
}

impl GpuGrids {
    /// Uploads the grids of a scene; `None` without any.
    pub fn upload(device: &Device, scene: &Scene) -> Result<Option<Self>, RenderError> {
        let sources = used(scene);
        if sources.is_empty() {
            return Ok(None);
        }
        let limit = device.device.limits().max_storage_buffer_binding_size;
        let mut places = Vec::with_capacity(sources.len());
        let (mut tables, mut values): (Vec<u32>, Vec<u32>) = Default::default();
        let (mut ranges, mut majorants): (Vec<[f32; 2]>, Vec<[f32; 2]>) = Default::default();
        for source in &sources {
            let limits = AtlasLimits {
                bytes: limit,
                ..AtlasLimits::default()
            };
            let atlas = BrickAtlas::new(source, &limits).map_err(|error| {
                RenderError::Refused(format!("grid {:?}: {error}", source.name))
            })?;
            let place = types::Grid {
                clip_min: atlas.clip[0].as_vec3().to_array(),
                clip_max: atlas.clip[1].as_vec3().to_array(),
                cell_side: (atlas.majorants.cell_bricks * BRICK_SIDE) as f32,
                first_table: tables.len() as u32,
                samples: atlas.cells.map(|cells| cells + 1),
                first_slot: ranges.len() as u32,
                bricks: atlas.bricks,
                first_cell: majorants.len() as u32,
                cells: atlas.majorants.size,
                ..Default::default()
            };
            places.push(Place {
                value: place,
                origin: atlas.origin.as_dvec3(),
            });
            tables.extend(atlas.table);
            values.extend(atlas.values);
            ranges.extend(atlas.ranges);
            majorants.extend(atlas.majorants.ranges);
            check("bytes of voxels", values.len() as u64 * 4, limit)?;
            check("bytes of brick tables", tables.len() as u64 * 4, limit)?;
            check("bytes of majorants", majorants.len() as u64 * 8, limit)?;
        }
        let storage =
            |label: &str, bytes: &[u8]| buffer(device, label, bytes, wgpu::BufferUsages::STORAGE);
        Ok(Some(Self {
            tables: storage("grids.tables", bytemuck::cast_slice(&tables)),
            values: storage("grids.values", bytemuck::cast_slice(&values)),
            ranges: storage("grids.ranges", bytemuck::cast_slice(&ranges)),
            majorants: storage("grids.majorants", bytemuck::cast_slice(&majorants)),
            sources,
            places,
        }))
    }

    /// Whether `scene` has any.
    pub fn is_needed(scene: &Scene) -> bool {
        !used(scene).is_empty()
    }

    /// Whether these are the grids of `scene`.
    pub fn serve(&self, scene: &Scene) -> bool {
        self.sources == used(scene)
    }

    /// One entry a medium that is a grid, in the order of the media.
    pub fn values(&self, scene: &Scene, origin: Origin) -> Vec<types::Grid> {
        let value = |medium: &Medium| {
            let MediumShape::Grid {
                grid,
                world_from_lattice,
            } = &medium.shape
            else {
                return None;
            };
            let place = self.places[self.sources.iter().position(|known| known == grid)?];
            let lattice_from_world = world_from_lattice.inverse();
            let matrix = lattice_from_world.matrix3;
            let shift = lattice_from_world.transform_point3(origin.0) - place.origin;
            let row = |i: usize| {
                let r = matrix.row(i);
                [r.x as f32, r.y as f32, r.z as f32, shift[i] as f32]
            };
            let [low, high] = grid.clip;
            let extent = world_from_lattice
                .transform_vector3(high - low)
                .length()
                .max(1e-9);
            let sigma_t = (0..3)
                .map(|c| f64::from(medium.sigma_s[c]) + f64::from(medium.sigma_a[c]))
                .fold(0.0, f64::max);
            let mean_free_path = 1.0 / (sigma_t * grid.stats().mean).max(1e-12);
            Some(types::Grid {
                row_x: row(0),
                row_y: row(1),
                row_z: row(2),
                // Nearer than either a light is worth distances of its own.
                near_radius: (0.25 * extent).min(mean_free_path) as f32,
                extent: extent as f32,
                ..place.value
            })
        };
        scene.media.iter().filter_map(value).collect()
    }

    /// Adds what passes read of it.
    pub fn bind<'a>(&'a self, bindings: &mut Bindings<'a>) {
        bindings
            .buffer("grid_tables", &self.tables)
            .buffer("grid_values", &self.values)
            .buffer("grid_ranges", &self.ranges)
            .buffer("grid_majorants", &self.majorants);
    }
}
