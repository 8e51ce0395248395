//! The running mean of the technique's samples, and the frame's statistics.

use super::surfaces::SURFACE_RADIANCE;
use crate::engine::{Access, Bytes, Permutation, ResourceSpec};
use crate::frame::{Dispatch, FramePlan, NewPass, PassId, PlanInput, Programs, Reach};

/// Running mean and statistics.
pub(crate) const PASS: PassId = PassId("film");

/// The picture: RGB mean radiance (W·m⁻²·sr⁻¹) and mean transmittance, four f32 a pixel.
pub(crate) const FILM: ResourceSpec = ResourceSpec::buffer("film", Bytes::PerPixel(16)).kept();

/// The technique's own mean, four f32 a pixel, where traced samples correct it.
pub(crate) const TECHNIQUE_FILM: ResourceSpec =
    ResourceSpec::buffer("filmed_base", Bytes::PerPixel(16)).kept();

/// Where a technique's mean goes: it is the picture, unless that is corrected.
pub(crate) fn of_technique(input: &PlanInput<'_>) -> ResourceSpec {
    if input.is_corrected() {
        TECHNIQUE_FILM
    } else {
        FILM
    }
}

/// What a technique adds to the light of surfaces: the feature of `film` that reads it, and what is read.
pub(crate) type Layer = (&'static str, Access);

/// Plans the mean of the surfaces' light and `layers`, kept in `film`: the picture, or what the
/// correction starts from.
pub(crate) fn plan(plan: &mut FramePlan, film: ResourceSpec, layers: &[Layer]) {
    let features = layers.iter().map(|(feature, _)| feature);
    let permutation = features.fold(Permutation::of("film"), |p, feature| p.with(feature));
    plan.run(
        NewPass::new(PASS, Programs::One(permutation), Dispatch(Reach::Picture))
            .accesses([SURFACE_RADIANCE.read(), film.written_as("film")])
            .accesses(layers.iter().map(|(_, access)| *access)),
        "running mean while nothing changes",
    );
}
