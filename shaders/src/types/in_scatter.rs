//! The march's own.

mirrors! {
    /// How camera rays are marched.
    struct MarchSettings {
        steps: u32,
        jitter: u32,
    }
}
