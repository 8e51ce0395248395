//! What the planner needs to know about a scene, computed once per change on the CPU.

use std::collections::BTreeSet;

use glam::DVec3;

use crate::scene::{
    Aabb, Camera, Geometry, Hull, Instance, Light, Material, Medium, MediumShape, Scene,
    TextureRef, box_corners,
};

/// Numbers and yes/no facts that decide which passes a scene needs.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
#[allow(
    clippy::struct_excessive_bools,
    reason = "independent facts, not the states of a machine"
)]
pub struct SceneFacts {
    /// Triangles over all instances.
    pub triangles: u64,
    /// Placed meshes.
    pub instances: usize,
    /// Textures of base colour and emission in use.
    pub textures: usize,
    /// Materials that are metallic or glossy somewhere, used or not.
    pub glossy_materials: usize,
    /// Metallic-roughness and normal maps in use.
    pub data_textures: usize,
    /// Instances whose material has an alpha cutoff.
    pub alpha_masked_instances: usize,
    /// Triangles that emit light, over all instances.
    pub emissive_triangles: u64,
    /// Point lights with non-zero intensity.
    pub point_lights: usize,
    /// Spot lights with non-zero intensity.
    pub spot_lights: usize,
    /// Directional lights with non-zero irradiance.
    pub directional_lights: usize,
    /// Those of these lights that cast shadows.
    pub shadow_casters: usize,
    /// Whether radiance arrives from infinity.
    pub environment: bool,
    /// Whether that radiance comes from a map.
    pub environment_map: bool,
    /// Media with a non-zero coefficient.
    pub media: usize,
    /// Media of those whose density is a grid.
    pub grids: usize,
    /// Voxels along the diagonal of the grid that has most, by its shortest voxel edge; 0 without a grid.
    pub voxels_across: u32,
    /// Whether the density of some medium varies: a grid, a sphere or height fog that thins out.
    pub heterogeneous: bool,
    /// Whether some medium has `σ_s` > 0.
    pub scatters: bool,
    /// Whether some medium emits.
    pub medium_emits: bool,
    /// Whether some scattering medium's phase function is not constant.
    pub anisotropic: bool,
    /// Largest |g| of a lobe of a scattering medium's phase function; 0 without one.
    pub max_abs_g: f32,
    /// Largest `σ_s/σ_t` over media and channels; 0 without a medium.
    pub max_albedo: f32,
    /// Optical depth across the diagonal of `bounds`, through the sum of all media, of the
    /// densest channel; an upper estimate for the planner.
    pub optical_thickness: f64,
    /// Box around all triangles, positioned lights and bounded media. Unit: m.
    #[serde(skip)]
    pub bounds: Aabb,
    /// Box around all triangles only; `None` without triangles. Unit: m.
    #[serde(skip)]
    pub surface_bounds: Option<Aabb>,
    /// Box around all triangles at all times: what a shadow map is fitted to, so that it stands
    /// still while casters move. Unit: m.
    #[serde(skip)]
    pub swept_bounds: Option<Aabb>,
}

impl SceneFacts {
    /// Lights with a position or a direction that send something.
    pub fn lights(&self) -> usize {
        self.positioned_lights() + self.directional_lights
    }

    /// Those of them that have a position.
    pub fn positioned_lights(&self) -> usize {
        self.point_lights + self.spot_lights
    }

    /// Depth maps that they need if all of them cast shadows: a cube of six around a point light.
    pub fn shadow_views(&self) -> usize {
        6 * self.point_lights + self.spot_lights + self.directional_lights
    }
}

/// Computes the facts of a scene. Cost: one pass over instances; the first time of a
/// geometry also one over its vertices.
pub fn facts(scene: &Scene) -> SceneFacts {
    let geometry = &scene.geometry;
    let surface_bounds = geometry.bounds();
    let bounds = bounds(scene, surface_bounds);
    let triangles = |instance: &Instance| (geometry.meshes[instance.mesh].indices.len() / 3) as u64;
    let material =
        |instance: &Instance| &geometry.materials[geometry.meshes[instance.mesh].material];
    let emits = |instance: &Instance| material(instance).emission != [0.0; 3];
    let lit = |wanted: fn(&Light) -> Option<[f32; 3]>| {
        let powers = scene.lights.iter().filter_map(wanted);
        powers.filter(|power| *power != [0.0; 3]).count()
    };
    let media: Vec<&Medium> = scene.media.iter().filter(|m| !is_vacuum(m)).collect();
    let scattering = || media.iter().filter(|m| m.sigma_s != [0.0; 3]);
    SceneFacts {
        triangles: geometry.instances.iter().map(triangles).sum(),
        instances: geometry.instances.len(),
        textures: used_textures(geometry, |m| [m.base_color_texture, m.emission_texture]).len(),
        glossy_materials: geometry
            .materials
            .iter()
            .filter(|m| !m.is_diffuse())
            .count(),
        data_textures: used_textures(geometry, |m| {
            [m.metallic_roughness_texture, m.normal_texture]
        })
        .len(),
        alpha_masked_instances: geometry
            .instances
            .iter()
            .filter(|instance| material(instance).alpha_cutoff.is_some())
            .count(),
        emissive_triangles: geometry
            .instances
            .iter()
            .filter(|instance| emits(instance))
            .map(triangles)
            .sum(),
        point_lights: lit(|light| match light {
            Light::Point(light) => Some(light.intensity),
            _ => None,
        }),
        spot_lights: lit(|light| match light {
            Light::Spot(light) => Some(light.intensity),
            _ => None,
        }),
        directional_lights: lit(|light| match light {
            Light::Directional(light) => Some(light.irradiance),
            _ => None,
        }),
        shadow_casters: scene
            .lights
            .iter()
            .filter(|light| light.casts_shadows() && light.is_lit())
            .count(),
        environment: scene
            .environment
            .as_ref()
            .is_some_and(|environment| environment.radiance != [0.0; 3]),
        environment_map: scene.environment.as_ref().is_some_and(|environment| {
            environment.radiance != [0.0; 3] && environment.map.is_some()
        }),
        media: media.len(),
        grids: media
            .iter()
            .filter(|m| matches!(m.shape, MediumShape::Grid { .. }))
            .count(),
        voxels_across: media.iter().map(|m| voxels_across(m)).max().unwrap_or(0),
        heterogeneous: media.iter().any(|m| varies(&m.shape)),
        scatters: scattering().next().is_some(),
        medium_emits: media.iter().any(|m| m.emission != [0.0; 3]),
        anisotropic: scattering().any(|m| !m.phase.is_isotropic()),
        max_abs_g: scattering()
            .map(|m| m.phase.largest_g())
            .fold(0.0, f32::max),
        max_albedo: media.iter().map(|m| albedo(m)).fold(0.0, f32::max),
        optical_thickness: optical_thickness(&media, &bounds),
        bounds,
        surface_bounds,
        swept_bounds: geometry.swept_bounds(),
    }
}

/// Whether a medium does nothing.
fn is_vacuum(medium: &Medium) -> bool {
    [medium.sigma_s, medium.sigma_a, medium.emission] == [[0.0; 3]; 3]
}

/// Voxels along a grid's diagonal, by the shortest edge of a voxel; 0 of other media.
fn voxels_across(medium: &Medium) -> u32 {
    let MediumShape::Grid {
        grid,
        world_from_lattice,
    } = &medium.shape
    else {
        return 0;
    };
    let [low, high] = grid.clip;
    let diagonal = world_from_lattice.transform_vector3(high - low).length();
    let rows = world_from_lattice.inverse().matrix3.transpose();
    let per_metre = rows.x_axis.length().max(rows.y_axis.length());
    (diagonal * per_metre.max(rows.z_axis.length())).ceil() as u32
}

/// Whether a density differs from place to place.
fn varies(shape: &MediumShape) -> bool {
    match shape {
        MediumShape::Homogeneous { .. } => false,
        MediumShape::HeightFog { falloff, .. } => *falloff > 0.0,
        MediumShape::Sphere { .. } | MediumShape::Grid { .. } => true,
    }
}

/// Largest `σ_s/σ_t` over the channels.
fn albedo(medium: &Medium) -> f32 {
    let channels = medium.sigma_s.iter().zip(&medium.sigma_a);
    channels
        .map(|(s, a)| if s + a > 0.0 { s / (s + a) } else { 0.0 })
        .fold(0.0, f32::max)
}

/// Textures that `of` names of the materials that some instance shows.
fn used_textures(
    geometry: &Geometry,
    of: fn(&Material) -> [Option<TextureRef>; 2],
) -> BTreeSet<usize> {
    let materials: BTreeSet<usize> = geometry
        .instances
        .iter()
        .map(|instance| geometry.meshes[instance.mesh].material)
        .collect();
    materials
        .into_iter()
        .flat_map(|index| of(&geometry.materials[index]))
        .flatten()
        .map(|texture| texture.texture)
        .collect()
}

/// Optical depth across the diagonal of `bounds`, of the densest channel.
fn optical_thickness(media: &[&Medium], bounds: &Aabb) -> f64 {
    let mut depth = [0.0; 3];
    for medium in media {
        let length = path_length(&medium.shape, bounds);
        for (channel, depth) in depth.iter_mut().enumerate() {
            let sigma_t = f64::from(medium.sigma_s[channel]) + f64::from(medium.sigma_a[channel]);
            *depth += sigma_t * length;
        }
    }
    depth.into_iter().fold(0.0, f64::max)
}

/// Length of the diagonal through a medium, weighted by its relative density. Unit: m.
fn path_length(shape: &MediumShape, bounds: &Aabb) -> f64 {
    let across = |own: Option<&Aabb>, up: DVec3| {
        intersection(bounds, own).map_or(0.0, |part| {
            // The diagonal that climbs along `up` from the lowest to the highest corner.
            let ends = up.cmplt(DVec3::ZERO);
            let low = DVec3::select(ends, part.max, part.min);
            let diagonal = DVec3::select(ends, part.min, part.max) - low;
            let length = diagonal.length();
            let integral = shape.density_integral(low, diagonal / length, length);
            integral.unwrap_or(0.0)
        })
    };
    match shape {
        MediumShape::Homogeneous { bounds: own } => across(own.as_ref(), DVec3::Y),
        MediumShape::HeightFog {
            up, bounds: own, ..
        } => across(own.as_ref(), up.as_dvec3()),
        // Along a diameter.
        MediumShape::Sphere { center, radius } => {
            let start = *center - DVec3::X * *radius;
            let integral = shape.density_integral(start, DVec3::X, 2.0 * radius);
            integral.unwrap_or(0.0)
        }
        // The densest column of bricks along an axis of the lattice.
        MediumShape::Grid {
            grid,
            world_from_lattice,
        } => {
            let axes = world_from_lattice.matrix3;
            [axes.x_axis, axes.y_axis, axes.z_axis]
                .iter()
                .zip(grid.stats().columns)
                .map(|(step, column)| step.length() * column)
                .fold(0.0, f64::max)
        }
    }
}

/// Where both are; all of `a` if `b` fills space.
fn intersection(a: &Aabb, b: Option<&Aabb>) -> Option<Aabb> {
    let Some(b) = b else { return Some(*a) };
    let (min, max) = (a.min.max(b.min), a.max.min(b.max));
    min.cmplt(max).all().then_some(Aabb { min, max })
}

/// Box around surfaces, positioned lights and bounded media; around the camera without any.
fn bounds(scene: &Scene, surface_bounds: Option<Aabb>) -> Aabb {
    let mut hull = Hull::default();
    if let Some(Aabb { min, max }) = surface_bounds {
        hull.add(min);
        hull.add(max);
    }
    for position in scene.lights.iter().filter_map(Light::position) {
        hull.add(position);
    }
    for medium in &scene.media {
        match &medium.shape {
            MediumShape::Homogeneous {
                bounds: Some(bounds),
            }
            | MediumShape::HeightFog {
                bounds: Some(bounds),
                ..
            } => {
                hull.add(bounds.min);
                hull.add(bounds.max);
            }
            MediumShape::Sphere { center, radius } => {
                hull.add(*center - *radius);
                hull.add(*center + *radius);
            }
            MediumShape::Grid {
                grid,
                world_from_lattice,
            } => {
                for corner in box_corners(grid.clip[0], grid.clip[1]) {
                    hull.add(world_from_lattice.transform_point3(corner));
                }
            }
            MediumShape::Homogeneous { bounds: None }
            | MediumShape::HeightFog { bounds: None, .. } => {}
        }
    }
    hull.padded().unwrap_or_else(|| {
        let Camera {
            position, target, ..
        } = scene.camera;
        Aabb {
            min: position.min(target) - 1.0,
            max: position.max(target) + 1.0,
        }
    })
}
