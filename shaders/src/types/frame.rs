//! What every frame needs, and what it counts.

mirrors! {
    /// What one frame needs to know.
    struct Frame {
        clip_from_relative: [[f32; 4]; 4],
        right: [f32; 3],
        width: u32,
        up: [f32; 3],
        height: u32,
        forward: [f32; 3],
        near: f32,
        camera_from_anchor: [f32; 3],
        far: f32,
        pixel_offset: [f32; 2],
        sample_index: u32,
        seed: u32,
        background: [f32; 3],
        exposure_scale: f32,
        statistics_scale: f32,
        accumulated: u32,
        environment_size: [u32; 2],
        environment_rotation: [f32; 2],
        restart: u32,
        padding: u32,
    }

    /// The part of a pass that one dispatch does.
    struct Band {
        first: [u32; 3],
        padding: u32,
    }

    /// Counted on the device each frame.
    struct Statistics {
        non_finite: u32,
        negative: u32,
        clamped: u32,
        transmittance: u32,
        displayed: u32,
        truncated: u32,
        unfinished: u32,
        variance_of_halves: f32,
        radiance: f32,
        measured_pixels: f32,
    }
}
