//! Every shader builds a pipeline on a device that validates and executes nothing.

use tyndall_render::{Device, probe};
use tyndall_tests::probes;

#[test]
fn every_permutation_builds_a_pipeline() {
    let device = Device::noop().unwrap();
    let failures = probe::failing_pipelines(&device);
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

#[test]
fn every_probe_builds_a_pipeline() {
    let device = Device::noop().unwrap();
    assert!(!probes::all().is_empty());
    for shader in probes::all() {
        if let Err(error) = probe::build(&device, shader) {
            panic!("{}: {error}", shader.name);
        }
    }
}
