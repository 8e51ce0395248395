//! Every sampler on the device against the distribution that it claims, by Pearson's test.
//!
//! Numbers come from the shader's own generator with fixed seeds. False alarms: 2.1e-6 a test, of
//! all of them together below 1e-4 (Šidák). Degrees of freedom: bins less one, printed by each test.
//! The densities that the shaders compute are compared with f64 at every sample.

#![allow(clippy::print_stdout, reason = "helper functions of tests")]

mod bsdf;
mod directions;
mod distances;
mod lights;
mod phases;
mod sobol;
mod triangles;

use std::sync::LazyLock;

use glam::{DVec3, Vec3};
use tyndall_render::Device;
use tyndall_tests::gpu;

static DEVICE: LazyLock<Device> = LazyLock::new(gpu::device);

/// Samples of a test.
pub const COUNT: usize = 1 << 17;

/// Samplers of `tests/probes/sampling.wesl`.
#[derive(Debug, Clone, Copy)]
#[allow(missing_docs, reason = "named as the shader's functions")]
pub enum Which {
    Cosine,
    Phase,
    Triangle,
    Equiangular,
    Bsdf,
    SphericalTriangle,
    Reservoir,
}

/// Two vectors a sample.
pub fn sample(which: Which, seed: u32, parameters: [[f32; 4]; 3]) -> Vec<[[f32; 4]; 2]> {
    let [a, b, c] = parameters;
    let inputs = [[f32::from(which as u8), seed as f32, 0.0, 0.0], a, b, c];
    let buffers = [("inputs", bytemuck::cast_slice(&inputs))];
    let found = gpu::probe_vec4(&DEVICE, "probe_sampling", 0, &buffers, 2 * COUNT);
    let (pairs, _) = found.as_chunks::<2>();
    pairs.to_vec()
}

/// A unit axis that is none of the coordinates'.
pub const AXIS: Vec3 = Vec3::new(0.36, -0.48, 0.8);

/// `v` with a fourth component.
pub fn with(v: Vec3, w: f32) -> [f32; 4] {
    v.extend(w).to_array()
}

/// The first three of a vector.
pub fn direction(v: [f32; 4]) -> DVec3 {
    Vec3::new(v[0], v[1], v[2]).as_dvec3()
}

/// Azimuth about `axis` in turns, [0, 1).
pub fn turn(axis: DVec3, v: DVec3) -> f64 {
    let x = axis.any_orthonormal_vector();
    let y = axis.cross(x);
    let angle = v.dot(y).atan2(v.dot(x)) / (2.0 * std::f64::consts::PI);
    angle.rem_euclid(1.0).min(1.0 - 1e-12)
}

/// Fails where a density of the device is farther from `exact` than `tolerance` of it.
pub fn assert_density(name: &str, found: f32, exact: f64, tolerance: f64) {
    let error = gpu::relative_error(found, exact);
    assert!(error < tolerance, "{name}: density {found} for {exact}");
}
