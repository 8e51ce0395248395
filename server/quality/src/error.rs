//! Why a measure has no value.

/// Why a measure has no value.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum QualityError {
    /// An image without pixels.
    #[error("the image has no pixels: {width}×{height}")]
    Empty {
        /// Unit: pixel.
        width: u32,
        /// Unit: pixel.
        height: u32,
    },
    /// The pixels given are not width × height.
    #[error("{what}: {found} entries for {width}×{height} pixels")]
    Length {
        /// Which plane.
        what: &'static str,
        /// Entries found.
        found: usize,
        /// Unit: pixel.
        width: u32,
        /// Unit: pixel.
        height: u32,
    },
    /// Two images of different sizes.
    #[error("the images differ in size: {}×{} and {}×{}", image.0, image.1, reference.0, reference.1)]
    SizeMismatch {
        /// Width and height of the picture.
        image: (u32, u32),
        /// Width and height of the reference.
        reference: (u32, u32),
    },
    /// NaN or infinity in a picture or its variance.
    #[error("{count} values of the {which} are not finite")]
    NonFinite {
        /// Which picture.
        which: &'static str,
        /// How many values.
        count: u64,
    },
    /// A variance below 0.
    #[error("{count} variances of the {which} are negative")]
    NegativeVariance {
        /// Which picture.
        which: &'static str,
        /// How many values.
        count: u64,
    },
    /// The measure divides by the reference's mean.
    #[error("the {which} is black: its mean is {mean}, relative errors need one above 0")]
    Black {
        /// Which picture.
        which: &'static str,
        /// The mean, as text.
        mean: String,
    },
    /// The measure needs a variance that is not known.
    #[error("the {which} has no variance")]
    NoVariance {
        /// Which picture.
        which: &'static str,
    },
    /// The picture is smaller than one block.
    #[error("blocks of {side}×{side} pixels do not fit in {width}×{height}")]
    BlockTooLarge {
        /// Unit: pixel.
        side: u32,
        /// Unit: pixel.
        width: u32,
        /// Unit: pixel.
        height: u32,
    },
    /// Pixels per degree outside of what filters are built for.
    #[error("{found} pixels per degree: expected 1 to 1000")]
    PixelsPerDegree {
        /// The value, as text.
        found: String,
    },
}
