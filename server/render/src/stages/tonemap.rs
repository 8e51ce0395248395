//! Exposure, filmic curve and 8-bit encoding: the only lossy colour step.

use super::film::FILM;
use crate::engine::{Bytes, Permutation, ResourceSpec};
use crate::frame::{Dispatch, FramePlan, NewPass, PassId, Programs, Reach};
use crate::picture::When;

/// Exposure, curve, encoding.
pub(crate) const PASS: PassId = PassId("tonemap");

/// One RGBA8 word a pixel.
pub(crate) const DISPLAYED: ResourceSpec = ResourceSpec::buffer("displayed", Bytes::PerPixel(4));

/// Plans it, for every picture.
pub(crate) fn plan(plan: &mut FramePlan) {
    let programs = Programs::One(Permutation::of("tonemap"));
    plan.run(
        NewPass::new(PASS, programs, Dispatch(Reach::Picture))
            .when(When::Always)
            .accesses([FILM.read(), DISPLAYED.written()]),
        "8-bit picture for the screen",
    );
}
