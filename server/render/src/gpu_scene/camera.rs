//! The camera and the other values of a frame, as the shaders read them.

use glam::{DVec3, DVec4};
use tyndall_scene::{Camera, Scene, SceneFacts};
use tyndall_shaders::types;

use crate::engine::statistics_scale;

/// What of a frame changes with every sample.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SampleValues {
    pub pixel_offset: [f32; 2],
    pub sample_index: u32,
    /// Number of the sample in the running mean, from 1 on.
    pub accumulated: u32,
    /// Counts the restarts of the running mean.
    pub restart: u32,
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
    let environment = scene.environment.as_ref();
    let map = environment.and_then(|environment| environment.map.as_ref());
    let rotation = environment.map_or(0.0, |environment| environment.rotation);
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
        exposure_scale: camera.exposure_ev.exp2(),
        statistics_scale: statistics_scale(width, height),
        accumulated: sample.accumulated,
        environment_size: map.map_or([0; 2], |map| [map.width, map.height]),
        environment_rotation: [rotation.cos(), rotation.sin()],
        restart: sample.restart,
        padding: 0,
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

/// Unit direction through a point of the picture. Unit: pixel, from the left upper corner.
pub(crate) fn pixel_ray(camera: &Camera, (width, height): (u32, u32), [x, y]: [f64; 2]) -> DVec3 {
    let (right, up, forward) = basis(camera);
    let [tan_x, tan_y] = half_angles(camera, (width, height));
    let across = 2.0 * x / f64::from(width) - 1.0;
    let down = 1.0 - 2.0 * y / f64::from(height);
    (forward + right * (tan_x * across) + up * (tan_y * down)).normalize_or(forward)
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
        size: [width, height],
        ..Default::default()
    }
}

/// Right, up and forward of a camera; validation excludes degenerate ones.
fn basis(camera: &Camera) -> (DVec3, DVec3, DVec3) {
    let forward = (camera.target - camera.position).normalize_or(DVec3::NEG_Z);
    let right = forward.cross(camera.up.as_dvec3()).normalize_or(DVec3::X);
    (right, right.cross(forward), forward)
}

/// Column-major f32 matrix of four rows.
pub(crate) fn columns(rows: [DVec4; 4]) -> [[f32; 4]; 4] {
    std::array::from_fn(|column| std::array::from_fn(|row| rows[row][column] as f32))
}
