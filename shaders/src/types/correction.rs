//! What the correction reads of its levels and of the last picture.

/// Side of a tile over which new samples are compared with carried ones. Unit: pixel.
pub const HISTORY_TILE: u32 = 16;

mirrors! {
    /// A level of the residual's pyramid, the next coarser one, and the one after that.
    struct PyramidLevel {
        width: u32,
        height: u32,
        first: u32,
        coarsest: u32,
        coarse_width: u32,
        coarse_height: u32,
        coarse_first: u32,
        window_width: u32,
        window_height: u32,
        window_first: u32,
        enough: f32,
    }

    /// The camera of the last picture.
    struct HistoryView {
        right: [f32; 3],
        most: f32,
        up: [f32; 3],
        most_base: f32,
        forward: [f32; 3],
        changed: u32,
        moved: [f32; 3],
        base_samples: f32,
        same_place: f32,
        spread: f32,
        size: [u32; 2],
        count_scale: f32,
        padding: [u32; 3],
    }

    /// What new samples say against carried ones, in a tile of pixels.
    struct TileChange {
        a: [f32; 4],
        b: [f32; 4],
        cells: [f32; 4],
    }
}
