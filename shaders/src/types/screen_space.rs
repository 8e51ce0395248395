//! The filter's own.

mirrors! {
    /// What the plan decided of the filter.
    struct FilterSettings {
        ambient: [f32; 3],
        glows: f32,
        separation_luminance: f32,
        separation_depth: f32,
        padding: [u32; 2],
    }

    /// A level of the picture and the next coarser one.
    struct FilterLevel {
        width: u32,
        height: u32,
        first: u32,
        coarse_width: u32,
        coarse_height: u32,
        coarse_first: u32,
        pixels: u32,
        last: u32,
        variance: f32,
        coarse_variance: f32,
        next_variance: f32,
        largest_variance: f32,
    }

    /// Rows of the picture whose light a dispatch adds.
    struct GatherRows {
        first: u32,
        end: u32,
        last: u32,
        padding: u32,
    }
}
