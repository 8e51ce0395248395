//! Where in the picture, and where in their pixels, the next samples of a view lie.

use super::View;
use crate::picture::{Cut, Slice, spread_pairs};

impl View {
    /// What of the picture is traced next.
    pub(super) fn next_slice(&self, corrected: bool) -> Slice {
        let done = self.accumulation.samples();
        let most = self.accumulation.most_samples(self.state.scene.render.stop);
        let cut = if corrected {
            Cut::Spread {
                is_new: self.accumulation.is_new(),
                turn: self.restart,
            }
        } else {
            Cut::Rows
        };
        Slice {
            shares_places: self.shares_places(),
            cleared: corrected,
            ..self.slices.next(self.size(), done, most, cut)
        }
    }

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
