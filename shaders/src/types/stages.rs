//! What shared stages keep for the passes after them.

mirrors! {
    /// Box and samples of the grids' optical depth toward each light.
    struct LightVolume {
        low: [f32; 3],
        lights: u32,
        high: [f32; 3],
        padding: u32,
        size: [u32; 3],
        padding_end: u32,
    }

    /// One depth map seen from a light.
    struct ShadowView {
        clip_from_relative: [[f32; 4]; 4],
    }
}
