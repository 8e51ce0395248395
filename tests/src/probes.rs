//! Shaders of the tests' own, built from `probes.txt`: single functions with buffers in and out.

use tyndall_shaders::{Binding, EntryPoint, Override, Shader, Stage};

static PROBES: &[Shader] = include!(concat!(env!("OUT_DIR"), "/table.rs"));

/// Every probe, in the order of `probes.txt`.
pub fn all() -> &'static [Shader] {
    PROBES
}

/// The probe named `name` in `probes.txt`.
pub fn named(name: &str) -> &'static Shader {
    PROBES
        .iter()
        .find(|probe| probe.name == name)
        .unwrap_or_else(|| panic!("{name} is no line of probes.txt"))
}
