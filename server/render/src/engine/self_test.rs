//! Start-up self-test: known answers that catch drivers which compute wrong results.
//!
//! Mesa 22.3's software driver silently stops each SIMD group after 65,535 loop iterations in all.
//! Short loops must be right, or the device is refused; the long loop decides whether the planner
//! must keep an invocation below that number.

use super::bindings::Bindings;
use super::constants::Constants;
use super::device::{Device, SelfTest};
use super::pipelines::Pipelines;
use super::readback::read_now;
use crate::error::DeviceError;

/// Iterations of the long loop: beyond the cap of the known faulty driver.
const LONG: u32 = 200_000;
/// Side of the nested loop: 40,000 iterations, below the cap.
const NESTED: u32 = 200;
/// Workgroups of 64.
const GROUPS: u32 = 4;

/// Runs the self-test.
pub(super) fn run(device: &Device) -> Result<SelfTest, DeviceError> {
    let wrong = |what: String| DeviceError::SelfTest {
        adapter: device.summary().name.clone(),
        what,
    };
    let long = dispatch(device, LONG, 0).map_err(&wrong)?;
    let short = dispatch(device, 10_000, NESTED).map_err(&wrong)?;
    let expect_long = (0..LONG).map(|i| 1 + (i & 1)).sum::<u32>();
    let expect_short = (0..10_000_u32).map(|i| 1 + (i & 1)).sum::<u32>();
    let expect_nested = (0..NESTED)
        .flat_map(|i| (0..NESTED).map(move |j| 1 + ((i ^ j) & 1)))
        .sum::<u32>();
    for (i, pair) in short.chunks_exact(2).enumerate() {
        if pair != [expect_short, expect_nested] {
            return Err(wrong(format!(
                "invocation {i} counted {pair:?} instead of [{expect_short}, {expect_nested}]"
            )));
        }
    }
    let capped = long.chunks_exact(2).any(|pair| pair[0] != expect_long);
    Ok(SelfTest {
        loop_cap: capped.then_some(65_535),
    })
}

fn dispatch(device: &Device, single: u32, nested: u32) -> Result<Vec<u32>, String> {
    let words = 2 * 64 * GROUPS;
    let size = u64::from(words) * 4;
    let pipelines = Pipelines::default();
    let program = pipelines
        .compute(device, "self_test", &Constants::default())
        .map_err(|error| error.to_string())?;
    let counts = device.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("self_test.counts"),
        size: 16,
        usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    });
    device
        .queue
        .write_buffer(&counts, 0, bytemuck::cast_slice(&[single, nested, 1, 0]));
    let results = device.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("self_test.results"),
        size,
        usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC,
        mapped_at_creation: false,
    });
    let staging = device.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("self_test.staging"),
        size,
        usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    });
    let mut bindings = Bindings::default();
    bindings
        .buffer("counts", &counts)
        .buffer("results", &results);
    let groups = program
        .bind(device, &bindings)
        .map_err(|error| error.to_string())?;
    let mut encoder = device
        .device
        .create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    {
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
        program.set(&mut pass, &groups);
        pass.dispatch_workgroups(GROUPS, 1, 1);
    }
    encoder.copy_buffer_to_buffer(&results, 0, &staging, 0, Some(size));
    device.queue.submit([encoder.finish()]);
    read_now(device, &staging)
        .map(|bytes| bytemuck::pod_collect_to_vec(&bytes))
        .map_err(|error| error.to_string())
}
