//! Where in their pixels the samples of a view lie.

use super::View;
use crate::picture::spread_pairs;

impl View {
    /// Which of its places in pixels and strata the technique looks at: others than in the pictures before,
    /// where those are carried over.
    pub(super) fn place_index(&self) -> u32 {
        let index = self.accumulation.base_samples();
        if self.shares_places() {
            spread_pairs(index)
        } else if self.carries() {
            index + self.restart
        } else {
            index
        }
    }

    /// Whether traced samples lie where the technique's do, so that what both see of an edge cancels. What
    /// is carried over was seen at other places: coherent ones of a frame would stand against it.
    pub(super) fn shares_places(&self) -> bool {
        let past = if self.accumulation.is_new() {
            &self.seen
        } else {
            &self.last_seen
        };
        self.has_base() && past.is_none()
    }

    /// Whether pictures are carried over to the next.
    fn carries(&self) -> bool {
        self.state.resources.has_previous()
    }
}
