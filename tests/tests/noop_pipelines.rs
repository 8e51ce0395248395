//! Every permutation builds a pipeline on a device that validates and executes nothing.

use tyndall_render::{Device, probe};

#[test]
fn every_permutation_builds_a_pipeline() {
    let device = Device::noop().unwrap();
    let failures = probe::failing_pipelines(&device);
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}
