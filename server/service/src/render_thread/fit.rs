//! Smaller pictures where device memory is short.

use tyndall_scene::RenderSettings;

use crate::session::Wish;

/// How often a picture is made smaller before its wish is refused.
pub(super) const MOST_REDUCTIONS: u32 = 3;
/// Shortest side that a picture is reduced to. Unit: pixel.
const SHORTEST_SIDE: u32 = 64;
/// Share of the allowed memory that a smaller picture aims at, along one side: not everything that a
/// picture needs grows with its pixels.
const MARGIN: f64 = 0.95;

/// The size that a picture got instead of the wish's, kept so that it is not looked for in every frame.
pub(super) struct Fit {
    /// Unit: pixel.
    pub(super) size: (u32, u32),
    wanted: Wanted,
}

/// What the memory of a picture follows from, as far as it is worth another attempt in full size.
#[derive(PartialEq)]
struct Wanted {
    epoch: u32,
    /// Unit: pixel.
    size: (u32, u32),
    settings: RenderSettings,
    lights: usize,
    media: usize,
}

impl Wanted {
    fn of(wish: &Wish) -> Self {
        Self {
            epoch: wish.epoch,
            size: (wish.width, wish.height),
            settings: wish.scene.render.clone(),
            lights: wish.scene.lights.len(),
            media: wish.scene.media.len(),
        }
    }
}

impl Fit {
    /// The wish gets this size. Unit: pixel.
    pub(super) fn new(wish: &Wish, size: (u32, u32)) -> Self {
        Self {
            size,
            wanted: Wanted::of(wish),
        }
    }

    /// Whether this wish gets the size as well.
    pub(super) fn serves(&self, wish: &Wish) -> bool {
        self.wanted == Wanted::of(wish)
    }
}

/// The size to try after a picture of `size` needed more memory than it may have, of the same shape;
/// `None` where nothing smaller is allowed. Unit: pixel and byte.
pub(super) fn smaller(
    (width, height): (u32, u32),
    needed: u64,
    allowed: u64,
) -> Option<(u32, u32)> {
    let share = (allowed as f64 / needed.max(1) as f64).min(1.0);
    let least = f64::from(SHORTEST_SIDE) / f64::from(width.min(height).max(1));
    let factor = (share.sqrt() * MARGIN).max(least);
    let side = |side: u32| (f64::from(side) * factor).round() as u32;
    (factor < 1.0).then(|| (side(width), side(height)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_smaller_picture_keeps_its_shape_and_a_shortest_side() {
        assert_eq!(smaller((1600, 900), 4, 1), Some((760, 428)));
        assert_eq!(smaller((400, 100), 1000, 1), Some((256, 64)));
        assert_eq!(smaller((400, 64), 1000, 1), None);
        assert_eq!(smaller((4000, 2), 1000, 1), None);
        // A device that asks for less than it allows contradicts itself; the picture shrinks all the same.
        assert_eq!(smaller((1000, 1000), 1, 2), Some((950, 950)));
        assert_eq!(smaller((1000, 1000), 0, 0), Some((64, 64)));
    }
}
