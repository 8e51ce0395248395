//! Where in their pixels the samples of a view lie.

use super::View;
use crate::pixel_offsets::spread_pairs;

impl View {
    /// Which of its places in pixels and strata the technique looks at: others than in the pictures before,
    /// where those are carried over.
    pub(super) fn place_index(&self) -> u32 {
        let index = self.image.base_samples();
        if self.shares_places() {
            spread_pairs(index)
        } else if self.targets.needs.history {
            index + self.turn
        } else {
            index
        }
    }

    /// Whether traced samples lie where the technique's do, so that what both see of an edge cancels. What
    /// is carried over was seen at other places: coherent ones of a frame would stand against it.
    pub(super) fn shares_places(&self) -> bool {
        let past = if self.image.is_new() {
            &self.seen
        } else {
            &self.last_seen
        };
        self.has_base() && past.is_none()
    }
}
