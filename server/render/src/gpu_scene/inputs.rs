//! The buffers of one view that hold camera-relative values, refilled when what they hold changes.

use glam::DVec3;
use tyndall_scene::{Aabb, ChangeSet, Light, MediumShape, Scene, SceneFacts};
use tyndall_shaders::types;

use super::camera::{SampleValues, frame_values};
use super::{GpuAssets, Origin, all_medium_values, instance_values, light_values};
use crate::engine::{Bindings, Device};

/// A light's first shadow view and the side of its texels, by its number, if it casts shadows.
pub(crate) type ShadowOf<'a> = dyn Fn(usize, &Light) -> Option<(u32, f32)> + 'a;

/// Buffers of one view. Clones share them.
#[derive(Debug, Clone)]
pub(crate) struct Inputs {
    pub frame: wgpu::Buffer,
    pub instances: wgpu::Buffer,
    pub lights: wgpu::Buffer,
    pub media: wgpu::Buffer,
    pub grids: wgpu::Buffer,
    pub statistics: wgpu::Buffer,
    pub slice: wgpu::Buffer,
}

impl Inputs {
    pub fn new(device: &Device, scene: &Scene) -> Self {
        let buffer = |label: &str, size: usize, usage: wgpu::BufferUsages| {
            device.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(label),
                size: (size.max(16) as u64).next_multiple_of(16),
                usage: usage | wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            })
        };
        let none = wgpu::BufferUsages::empty();
        Self {
            frame: buffer("frame", size_of::<types::Frame>(), none),
            instances: buffer(
                "instances",
                scene.geometry.instances.len() * size_of::<types::Instance>(),
                none,
            ),
            lights: buffer(
                "lights",
                scene.lights.len().max(1) * size_of::<types::Light>(),
                none,
            ),
            media: buffer(
                "media",
                scene.media.len().max(1) * size_of::<types::Medium>(),
                none,
            ),
            grids: buffer(
                "grids",
                scene.media.len().max(1) * size_of::<types::Grid>(),
                none,
            ),
            statistics: buffer(
                "statistics",
                size_of::<types::Statistics>(),
                wgpu::BufferUsages::COPY_SRC,
            ),
            slice: buffer("slice", size_of::<types::Slice>(), none),
        }
    }

    /// Whether the buffers are made for as many lights and media as `scene` has: shaders read many
    /// lights' number from the length of their buffer.
    pub fn fits(&self, scene: &Scene) -> bool {
        self.lights.size() == (scene.lights.len().max(1) * size_of::<types::Light>()) as u64
            && self.media.size() == (scene.media.len().max(1) * size_of::<types::Medium>()) as u64
    }

    /// Whether both are the same buffers.
    pub fn same_as(&self, other: &Self) -> bool {
        self.frame == other.frame
    }

    /// Adds what passes read of them.
    pub fn bind<'a>(&'a self, bindings: &mut Bindings<'a>) {
        bindings
            .buffer("frame", &self.frame)
            .buffer("instances", &self.instances)
            .buffer("lights", &self.lights)
            .buffer("media", &self.media)
            .buffer("grids", &self.grids)
            .buffer("statistics", &self.statistics)
            .buffer("slice", &self.slice);
    }

    /// Uploads what of the scene's state `changed`; all positions are relative to the camera's. `shadow_of` gives
    /// each light's first shadow view and the side of its texels; `sorted` puts lights first that may add
    /// most.
    pub fn upload_scene(
        &self,
        device: &Device,
        scene: &Scene,
        assets: &GpuAssets,
        shadow_of: &ShadowOf<'_>,
        sorted: bool,
        changed: ChangeSet,
    ) {
        let origin = Origin(scene.camera.position);
        let write = |buffer: &wgpu::Buffer, bytes: &[u8]| {
            if !bytes.is_empty() {
                device.queue.write_buffer(buffer, 0, bytes);
            }
        };
        let placed = ChangeSet::CAMERA | ChangeSet::SURFACES | ChangeSet::PLACEMENT;
        if changed.intersects(placed) {
            let order = &assets.geometry.instance_order;
            let instances = instance_values(&scene.geometry, order, origin);
            write(&self.instances, bytemuck::cast_slice(&instances));
        }
        let mut order: Vec<(usize, &Light)> = scene.lights.iter().enumerate().collect();
        if sorted {
            let adds = |(_, light): &(usize, &Light)| most_added(light, scene);
            order.sort_by(|a, b| adds(b).total_cmp(&adds(a)));
        }
        let lights: Vec<_> = order
            .into_iter()
            .map(|(i, light)| light_values(light, shadow_of(i, light), origin))
            .collect();
        write(&self.lights, bytemuck::cast_slice(&lights));
        if !changed.intersects(ChangeSet::CAMERA | ChangeSet::MEDIA) {
            return;
        }
        let media = all_medium_values(&scene.media, origin);
        write(&self.media, bytemuck::cast_slice(&media));
        if let Some(grids) = &assets.grids {
            let grids = grids.values(scene, origin);
            write(&self.grids, bytemuck::cast_slice(&grids));
        }
    }

    /// Uploads which part of the picture the reference works on.
    pub fn upload_slice(&self, device: &Device, value: types::Slice) {
        device
            .queue
            .write_buffer(&self.slice, 0, bytemuck::bytes_of(&value));
    }

    /// Uploads the frame's own values.
    pub fn upload_frame(
        &self,
        device: &Device,
        scene: &Scene,
        facts: &SceneFacts,
        anchor: DVec3,
        size: (u32, u32),
        sample: SampleValues,
    ) {
        let value = frame_values(scene, facts, anchor, size, sample);
        device
            .queue
            .write_buffer(&self.frame, 0, bytemuck::bytes_of(&value));
    }
}

/// About the most that a light adds to a ray, up to a factor that all lights share: the irradiance at the
/// camera, over the stretch of a ray that passes it there, dimmed by what fills the space between. It only
/// decides in which order lights are looked at.
fn most_added(light: &Light, scene: &Scene) -> f64 {
    let most = |rgb: [f32; 3]| f64::from(rgb[0].max(rgb[1]).max(rgb[2]));
    let Some(position) = light.position() else {
        // From infinity it lights all of a ray.
        return if light.is_lit() { f64::INFINITY } else { 0.0 };
    };
    let distance = (position - scene.camera.position).length();
    let fills = |bounds: &Option<Aabb>| {
        bounds.is_none_or(|bounds| {
            let inside =
                |point: DVec3| point.cmpge(bounds.min).all() && point.cmple(bounds.max).all();
            inside(position) && inside(scene.camera.position)
        })
    };
    let filling = scene.media.iter().map(|medium| match &medium.shape {
        MediumShape::Homogeneous { bounds } if fills(bounds) => {
            let sigma_t = |c: usize| f64::from(medium.sigma_s[c]) + f64::from(medium.sigma_a[c]);
            sigma_t(0).min(sigma_t(1)).min(sigma_t(2))
        }
        _ => 0.0,
    });
    let passed = (-filling.sum::<f64>() * distance).exp();
    most(light.strength()) * passed / distance.max(f64::from(light.radius())).max(1e-9)
}
