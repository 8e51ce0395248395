//! One setting of a technique, as the benchmark measures it.

use tyndall_scene::{RenderSettings, Technique};

/// One setting of a technique.
#[derive(Debug, Clone, Copy)]
pub struct Rung {
    /// What transports the light.
    pub technique: Technique,
    /// What is special about the setting, as in `+interleaved`; empty for the plain technique.
    pub variant: &'static str,
    /// March steps a ray, for techniques that march.
    pub steps: Option<u32>,
    /// Samples a pixel.
    pub samples: u32,
    /// Whether traced samples, as many, correct the picture.
    pub corrected: bool,
    /// Changes the technique's own settings; technique, samples and correction are set already.
    pub configure: fn(&mut RenderSettings, &Self),
}

impl Rung {
    /// Name of technique, variant and correction.
    pub fn name(&self) -> String {
        let corrected = if self.corrected { "+correction" } else { "" };
        format!("{}{}{corrected}", self.technique.name(), self.variant)
    }
}
