//! Camera-relative values of instances, lights and media.

use glam::{DVec3, Vec3};
use tyndall_scene::{Geometry, Light, Medium, MediumShape, PhaseFunction, PhaseParameters};
use tyndall_shaders::types;

/// The point every uploaded position is relative to: the camera.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Origin(pub DVec3);

impl Origin {
    /// Subtracts in f64, then rounds.
    fn relative(self, position: DVec3) -> [f32; 3] {
        (position - self.0).as_vec3().to_array()
    }
}

/// Instances in the order of `order`.
pub(crate) fn instance_values(
    source: &Geometry,
    order: &[usize],
    origin: Origin,
) -> Vec<types::Instance> {
    order
        .iter()
        .map(|index| {
            let instance = &source.instances[*index];
            let m = instance.world_from_object.matrix3;
            let t = instance.world_from_object.translation - origin.0;
            let row = |i: usize| {
                let r = m.row(i);
                [r.x as f32, r.y as f32, r.z as f32, t[i] as f32]
            };
            types::Instance {
                row_x: row(0),
                row_y: row(1),
                row_z: row(2),
                material: source.meshes[instance.mesh].material as u32,
                winding: if m.determinant() < 0.0 { -1.0 } else { 1.0 },
                padding: [0; 2],
            }
        })
        .collect()
}

/// A light; `shadow` is its first shadow view and the side of a texel, if it has one.
pub(crate) fn light_values(
    light: &Light,
    shadow: Option<(u32, f32)>,
    origin: Origin,
) -> types::Light {
    let (shadow_view, shadow_texel) = shadow.unwrap_or((types::NO_SHADOW, 0.0));
    let mut value = types::Light {
        shadow_view,
        shadow_texel,
        ..Default::default()
    };
    match light {
        Light::Point(point) => {
            value.kind = types::LIGHT_POINT;
            value.position = origin.relative(point.position);
            value.intensity = point.intensity;
            value.radius = point.radius;
        }
        Light::Spot(spot) => {
            value.kind = types::LIGHT_SPOT;
            value.position = origin.relative(spot.position);
            value.direction = spot.direction.to_array();
            value.intensity = spot.intensity;
            value.radius = spot.radius;
            value.cos_outer = spot.outer_angle.cos();
            // glTF's minimum of the difference keeps a hard edge finite.
            value.spot_scale = 1.0 / (spot.inner_angle.cos() - value.cos_outer).max(1e-4);
        }
        Light::Directional(sun) => {
            value.kind = types::LIGHT_DIRECTIONAL;
            value.direction = sun.direction.to_array();
            value.intensity = sun.irradiance;
        }
    }
    value
}

/// A phase function.
fn phase_values(phase: &PhaseFunction) -> types::Phase {
    let PhaseParameters { kind, parameters } = phase.parameters();
    types::Phase { parameters, kind }
}

/// A medium; `grid` is its place among the grids, if it is one.
pub(crate) fn medium_values(medium: &Medium, grid: u32, origin: Origin) -> types::Medium {
    let mut value = types::Medium {
        sigma_s: medium.sigma_s,
        sigma_t: std::array::from_fn(|i| medium.sigma_s[i] + medium.sigma_a[i]),
        phase: phase_values(&medium.phase),
        emission: medium.emission,
        up: Vec3::Y.to_array(),
        radius: 1.0,
        ..Default::default()
    };
    let mut bounded = None;
    match &medium.shape {
        MediumShape::Homogeneous { bounds } => {
            value.shape = types::MEDIUM_HOMOGENEOUS;
            bounded = *bounds;
        }
        MediumShape::HeightFog {
            up,
            falloff,
            origin: base,
            bounds,
        } => {
            value.shape = types::MEDIUM_HEIGHT_FOG;
            value.up = up.to_array();
            value.falloff = *falloff;
            value.camera_height = (origin.0 - *base).dot(up.as_dvec3()) as f32;
            bounded = *bounds;
        }
        MediumShape::Sphere { center, radius } => {
            value.shape = types::MEDIUM_SPHERE;
            value.center = origin.relative(*center);
            value.radius = *radius as f32;
        }
        MediumShape::Grid { .. } => {
            value.shape = types::MEDIUM_GRID;
            value.grid = grid;
        }
    }
    if let Some(bounds) = bounded {
        value.bounded = 1;
        value.bounds_min = origin.relative(bounds.min);
        value.bounds_max = origin.relative(bounds.max);
    }
    value
}

/// All media of a scene.
pub(crate) fn all_medium_values(media: &[Medium], origin: Origin) -> Vec<types::Medium> {
    let mut grids = 0;
    media
        .iter()
        .map(|medium| {
            let value = medium_values(medium, grids, origin);
            grids += u32::from(value.shape == types::MEDIUM_GRID);
            value
        })
        .collect()
}
