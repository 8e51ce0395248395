//! Edits and cameras that came while edits rest: the newest state wins, so that nothing piles up.
//!
//! A slider that is dragged sends an edit for every animation frame, each of which replaces the one before. While
//! the session's share of time lets none be made, the newest of them is kept, and the newest camera
//! behind it: what was said before is not answered before.

use std::time::Instant;

use tyndall_scene::SceneEdit;
use tyndall_stream::protocol::{CameraUpdate, EditRequest};

/// An edit that waits, and what it stands for.
#[derive(Debug, PartialEq)]
pub(super) struct WaitingEdit {
    /// The newest.
    pub(super) request: EditRequest,
    /// Input number of the first edit that it replaces, its own without one: a refusal is told of that, as what
    /// the client sent since was never looked at.
    pub(super) first_input: u64,
    /// When the newest came.
    pub(super) came: Instant,
}

/// What waits for the end of a rest.
#[derive(Debug, Default)]
pub(super) struct Waiting {
    edit: Option<WaitingEdit>,
    camera: Option<CameraUpdate>,
}

impl Waiting {
    pub(super) fn has_edit(&self) -> bool {
        self.edit.is_some()
    }

    /// Whether an edit may be kept in place of the one that waits, if any does: it says everything anew, and no
    /// camera came in between.
    pub(super) fn takes(&self, edit: &SceneEdit) -> bool {
        self.edit
            .as_ref()
            .is_none_or(|before| self.camera.is_none() && replaces(edit, &before.request.edit))
    }

    /// Keeps an edit in place of the one that waits.
    pub(super) fn keep_edit(&mut self, request: EditRequest, came: Instant) {
        let before = self.edit.as_ref();
        self.edit = Some(WaitingEdit {
            first_input: before.map_or(request.input, |before| before.first_input),
            request,
            came,
        });
    }

    /// Keeps the newest camera. One that surfaces let through on any part of the way goes through them.
    pub(super) fn keep_camera(&mut self, camera: &CameraUpdate) {
        let before = self.camera.as_ref();
        let stops = before.is_none_or(|before| before.stops_at_surfaces);
        self.camera = Some(CameraUpdate {
            stops_at_surfaces: camera.stops_at_surfaces && stops,
            ..camera.clone()
        });
    }

    /// Takes what waits, in the order in which it came.
    pub(super) fn take(&mut self) -> (Option<WaitingEdit>, Option<CameraUpdate>) {
        (self.edit.take(), self.camera.take())
    }
}

/// Whether `newer` says everything anew that `older` says.
fn replaces(newer: &SceneEdit, older: &SceneEdit) -> bool {
    let SceneEdit {
        camera,
        exposure_ev,
        lights,
        media,
        render,
        time_seconds,
        playing,
    } = older;
    (camera.is_none() || newer.camera.is_some())
        && (exposure_ev.is_none() || newer.exposure_ev.is_some())
        && (lights.is_none() || newer.lights.is_some())
        && (media.is_none() || newer.media.is_some())
        && (render.is_none() || newer.render.is_some())
        && (time_seconds.is_none() || newer.time_seconds.is_some())
        && (playing.is_none() || newer.playing.is_some())
}

#[cfg(test)]
mod tests {
    use tyndall_stream::protocol::CameraPose;

    use super::*;

    fn exposure(input: u64, ev: f64) -> EditRequest {
        let edit = SceneEdit {
            exposure_ev: Some(ev),
            ..SceneEdit::default()
        };
        EditRequest { input, edit }
    }

    fn camera(input: u64, stops_at_surfaces: bool) -> CameraUpdate {
        CameraUpdate {
            input,
            camera: CameraPose {
                position: [input as f64, 0.0, 0.0],
                target: [0.0; 3],
                up: [0.0, 1.0, 0.0],
                vertical_fov_degrees: 50.0,
            },
            stops_at_surfaces,
        }
    }

    #[test]
    fn the_newest_of_a_slider_is_kept_and_stands_for_all() {
        let mut waiting = Waiting::default();
        let now = Instant::now();
        for input in 4..=90 {
            let edit = exposure(input, input as f64);
            assert!(waiting.takes(&edit.edit));
            waiting.keep_edit(edit, now);
        }
        let (edit, camera) = waiting.take();
        let edit = edit.expect("an edit waits");
        assert_eq!(edit.request, exposure(90, 90.0));
        assert_eq!(edit.first_input, 4);
        assert_eq!(camera, None);
        assert!(!waiting.has_edit());
    }

    #[test]
    fn an_edit_of_something_else_replaces_none() {
        let mut waiting = Waiting::default();
        let now = Instant::now();
        waiting.keep_edit(exposure(1, 1.0), now);
        let other = SceneEdit {
            playing: Some(true),
            ..SceneEdit::default()
        };
        assert!(!waiting.takes(&other));
        // Nor does one after a camera that is to be shown after the first.
        waiting.keep_camera(&camera(3, true));
        assert!(!waiting.takes(&exposure(4, 2.0).edit));
    }

    #[test]
    fn of_cameras_the_newest_waits_and_a_way_through_surfaces_stays_one() {
        let mut waiting = Waiting::default();
        waiting.keep_camera(&camera(1, true));
        waiting.keep_camera(&camera(2, false));
        waiting.keep_camera(&camera(3, true));
        let (_, kept) = waiting.take();
        assert_eq!(kept, Some(camera(3, false)));
        waiting.keep_camera(&camera(4, true));
        assert_eq!(waiting.take().1, Some(camera(4, true)));
    }
}
