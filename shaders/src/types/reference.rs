//! The path tracer's own.

/// `PathRules::medium_order`: any number of scatterings in media.
pub const ORDER_ALL: u32 = 0;
/// `PathRules::medium_order`: none.
pub const ORDER_NONE: u32 = 1;
/// `PathRules::medium_order`: exactly one.
pub const ORDER_SINGLE: u32 = 2;
/// `PathRules::medium_order`: at least two.
pub const ORDER_MULTIPLE: u32 = 3;

mirrors! {
    /// Which paths the reference counts.
    struct PathRules {
        max_scatterings: u32,
        max_surface_scatterings: u32,
        medium_order: u32,
        max_events: u32,
    }

    /// The part of the picture that one dispatch of the reference works on.
    struct Slice {
        first_row: u32,
        rows: u32,
        first_place: u32,
        places: u32,
        first_sample: u32,
        samples: u32,
        segments: u32,
        cleared: u32,
        stride: u32,
        offset_x: u32,
        offset_y: u32,
        shares_places: u32,
    }
}
