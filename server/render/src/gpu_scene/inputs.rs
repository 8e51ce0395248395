//! The buffers of one view that hold camera-relative values, refilled when what they hold changes.

use glam::{DVec3, DVec4};
use tyndall_scene::{Aabb, Camera, Light, MediumOrder, MediumShape, Scene, SceneFacts, ShadowMode};
use tyndall_shaders::types;

use super::{GpuAssets, Origin, all_medium_values, instance_values, light_values};
use crate::device::Device;
use crate::plan::March;
use crate::readback::statistics_scale;
use crate::slices::Slice;
use crate::techniques::shadow_maps::{ShadowMaps, columns};
use crate::tonemap::exposure_scale;

/// Segments after which a path is given up, and counted as truncated.
const MAX_EVENTS: u32 = 1 << 20;

/// Buffers of one view.
#[derive(Debug)]
pub(crate) struct Inputs {
    pub frame: wgpu::Buffer,
    pub instances: wgpu::Buffer,
    pub lights: wgpu::Buffer,
    pub media: wgpu::Buffer,
    pub grids: wgpu::Buffer,
    pub statistics: wgpu::Buffer,
    pub slice: wgpu::Buffer,
}

/// What of a frame changes with every sample.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SampleValues {
    pub pixel_offset: [f32; 2],
    pub sample_index: u32,
    /// Number of the sample in the running mean, from 1 on.
    pub accumulated: u32,
    /// Counts the restarts of the running mean.
    pub turn: u32,
    pub march: March,
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

    /// Whether the buffers hold as many lights and media as `scene` has.
    pub fn fits(&self, scene: &Scene) -> bool {
        self.lights.size() >= (scene.lights.len() * size_of::<types::Light>()) as u64
            && self.media.size() >= (scene.media.len() * size_of::<types::Medium>()) as u64
    }

    /// Uploads everything that depends on the scene's state or the camera's position; `sorted` puts lights
    /// first that may add most.
    pub fn upload_scene(
        &self,
        device: &Device,
        scene: &Scene,
        assets: &GpuAssets,
        shadows: &ShadowMaps,
        mode: ShadowMode,
        sorted: bool,
    ) {
        let origin = Origin(scene.camera.position);
        let write = |buffer: &wgpu::Buffer, bytes: &[u8]| {
            if !bytes.is_empty() {
                device.queue.write_buffer(buffer, 0, bytes);
            }
        };
        let instances = instance_values(&scene.geometry, &assets.geometry.instance_order, origin);
        write(&self.instances, bytemuck::cast_slice(&instances));
        // A traced shadow needs no map: any view number says that the light casts shadows.
        let shadow_of = |i: usize, light: &Light| match mode {
            ShadowMode::Mapped => shadows.of_light(i),
            ShadowMode::Traced => light.casts_shadows().then_some((0, 0.0)),
            ShadowMode::Off => None,
        };
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
        let media = all_medium_values(&scene.media, origin);
        write(&self.media, bytemuck::cast_slice(&media));
        if let Some(grids) = &assets.grids {
            let grids = grids.values(scene, origin);
            write(&self.grids, bytemuck::cast_slice(&grids));
        }
        shadows.upload(device, origin);
    }

    /// Uploads which part of the picture the reference works on.
    pub fn upload_slice(&self, device: &Device, slice: Slice) {
        let value = slice.values();
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

/// The frame's own values.
pub(crate) fn frame_values(
    scene: &Scene,
    facts: &SceneFacts,
    anchor: DVec3,
    (width, height): (u32, u32),
    sample: SampleValues,
) -> types::Frame {
    let camera = &scene.camera;
    let paths = &scene.render.reference;
    let environment = scene.environment.as_ref();
    let map = environment.and_then(|environment| environment.map.as_ref());
    let turn = environment.map_or(0.0, |environment| environment.rotation);
    let limit = |most: Option<u32>| most.unwrap_or(1 << 30);
    let (right, up, forward) = basis(camera);
    let [tan_x, tan_y] = half_angles(camera, (width, height));
    let diagonal = (facts.bounds.max - facts.bounds.min).length();
    let near = (1e-4 * diagonal).clamp(1e-4, 0.02);
    // Puts the sample's position in the pixel where the rasterizer samples: its centre.
    let shift_x = (1.0 - 2.0 * f64::from(sample.pixel_offset[0])) / f64::from(width);
    let shift_y = (2.0 * f64::from(sample.pixel_offset[1]) - 1.0) / f64::from(height);
    let row = |v: DVec3| DVec4::new(v.x, v.y, v.z, 0.0);
    let w = row(forward);
    let clip_from_relative = columns([
        row(right / tan_x) + w * shift_x,
        row(up / tan_y) + w * shift_y,
        DVec4::new(0.0, 0.0, 0.0, near),
        w,
    ]);
    types::Frame {
        clip_from_relative,
        right: (right * tan_x).as_vec3().to_array(),
        width,
        up: (up * tan_y).as_vec3().to_array(),
        height,
        forward: forward.as_vec3().to_array(),
        near: near as f32,
        camera_from_anchor: (camera.position - anchor).as_vec3().to_array(),
        far: far_distance(facts, camera, diagonal) as f32,
        pixel_offset: sample.pixel_offset,
        sample_index: sample.sample_index,
        seed: (scene.render.seed ^ (scene.render.seed >> 32)) as u32,
        background: environment.map_or([0.0; 3], |environment| environment.radiance),
        march_steps: sample.march.steps,
        march_jitter: scene.render.single_scattering.jitter.into(),
        exposure_scale: exposure_scale(camera.exposure_ev),
        statistics_scale: statistics_scale(width, height),
        accumulated: sample.accumulated,
        max_scatterings: limit(paths.max_scatterings),
        max_surface_scatterings: limit(paths.max_surface_scatterings),
        medium_order: match paths.medium_order {
            MediumOrder::All => types::ORDER_ALL,
            MediumOrder::None => types::ORDER_NONE,
            MediumOrder::Single => types::ORDER_SINGLE,
            MediumOrder::Multiple => types::ORDER_MULTIPLE,
        },
        max_events: MAX_EVENTS,
        environment_size: map.map_or([0; 2], |map| [map.width, map.height]),
        environment_turn: [turn.cos(), turn.sin()],
        turn: sample.turn,
        padding: [0; 3],
    }
}

/// Where a ray that meets nothing ends: beyond everything bounded, plus a stretch of whatever fills space.
fn far_distance(facts: &SceneFacts, camera: &Camera, diagonal: f64) -> f64 {
    let middle = 0.5 * (facts.bounds.min + facts.bounds.max);
    ((camera.position - middle).length() + 4.0 * diagonal).max(1.0)
}

/// Tangents of half the angles of view, horizontal and vertical.
fn half_angles(camera: &Camera, (width, height): (u32, u32)) -> [f64; 2] {
    let tan_y = (f64::from(camera.vertical_fov) / 2.0).tan();
    [tan_y * f64::from(width) / f64::from(height), tan_y]
}

/// Camera `last` as `camera` needs it to look up what it saw.
pub(crate) fn history_view(
    last: &Camera,
    camera: &Camera,
    [width, height]: [u32; 2],
) -> types::HistoryView {
    let (right, up, forward) = basis(last);
    let [tan_x, tan_y] = half_angles(last, (width, height));
    types::HistoryView {
        right: (right * tan_x).as_vec3().to_array(),
        up: (up * tan_y).as_vec3().to_array(),
        forward: forward.as_vec3().to_array(),
        moved: (camera.position - last.position).as_vec3().to_array(),
        ..Default::default()
    }
}

/// Right, up and forward of a camera; validation excludes degenerate ones.
fn basis(camera: &Camera) -> (DVec3, DVec3, DVec3) {
    let forward = (camera.target - camera.position).normalize_or(DVec3::NEG_Z);
    let right = forward.cross(camera.up.as_dvec3()).normalize_or(DVec3::X);
    (right, right.cross(forward), forward)
}
