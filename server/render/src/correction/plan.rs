//! Whether the picture is corrected, and what the correction reads and writes.

use tyndall_scene::{CorrectionMode, RenderSettings, SceneFacts, StopRule};
use tyndall_shaders::types::{HISTORY_TILE, TileChange};

use super::levels::Correct;
use super::pyramid::cells;
use super::state::Correction;
use crate::engine::{Access, Bytes, Permutation, ResourceSpec};
use crate::frame::{FramePlan, KeptKind, NewPass, PassId, PlanInput, PlanLimits, Programs};
use crate::picture::When;
use crate::stages::estimate;
use crate::stages::film::{FILM, TECHNIQUE_FILM};
use crate::stages::surfaces::depth;
use crate::techniques::reference::paths::{EVEN_MEANS, MOMENTS, TRACED_FILM};

/// Brings the technique's picture toward the traced one.
pub(crate) const PASS: PassId = PassId("correction");

/// Two halves of four f32 a cell.
const RESIDUAL_BYTES: u64 = 32;

/// Residuals of all levels; what they were in the last picture, where they are carried over.
const RESIDUALS: ResourceSpec = ResourceSpec::buffer(
    "residuals",
    Bytes::OfPicture(|size| RESIDUAL_BYTES * cells(size)),
)
.kept();
const BAND_ENERGIES: ResourceSpec = per_cell("band_energies");
const WINDOW_ENERGIES: ResourceSpec = per_cell("window_energies");
const BELIEVED_ENERGIES: ResourceSpec = per_cell("believed_energies");
const CORRECTIONS: ResourceSpec = per_cell("corrections");
/// Expected square error of each pixel, mean of the channels: f32.
pub(crate) const SQUARE_ERRORS: ResourceSpec =
    ResourceSpec::buffer("square_errors", Bytes::PerPixel(4)).kept();

/// The technique's mean with what was carried over of it, and what that was in the last picture.
const STEADY_BASE: ResourceSpec =
    ResourceSpec::buffer("base_film", Bytes::PerPixel(16)).with_previous("history_base");
/// Distance and number of the technique's samples, two f32 a pixel. Unit: m.
const PLACES: ResourceSpec =
    ResourceSpec::buffer("residual_places", Bytes::PerPixel(8)).with_previous("history_places");
/// Residuals and technique's mean of the last picture, looked up where the present one sees the same.
const CARRIED: ResourceSpec = ResourceSpec::buffer("carried", Bytes::PerPixel(32)).kept();
const CARRIED_BASE: ResourceSpec = ResourceSpec::buffer("carried_base", Bytes::PerPixel(16)).kept();
const BASE_SCALES: ResourceSpec = per_tile("base_scales", 16);
const TILE_CHANGES: ResourceSpec = per_tile("tile_changes", size_of::<TileChange>() as u64);
const FORGETTING: ResourceSpec = per_tile("forgetting", 4);

const fn per_cell(name: &'static str) -> ResourceSpec {
    ResourceSpec::buffer(name, Bytes::OfPicture(|size| 16 * cells(size)))
}

const fn per_tile(name: &'static str, bytes: u64) -> ResourceSpec {
    let side = HISTORY_TILE;
    ResourceSpec::buffer(name, Bytes::PerTile { side, bytes })
}

/// Bytes of the largest buffer that a picture of this size needs.
pub(crate) fn largest_buffer(size: [u32; 2]) -> u64 {
    RESIDUAL_BYTES * cells(size)
}

/// Why nothing is corrected, if so; `traced` for a technique whose own samples are the traced ones.
pub(crate) fn without_correction(
    facts: &SceneFacts,
    settings: &RenderSettings,
    limits: PlanLimits,
    traced: bool,
) -> Option<&'static str> {
    // An error that is to be reached must be known.
    let judged = matches!(settings.stop, StopRule::RelativeError(_));
    if settings.correction == CorrectionMode::Off {
        Some(if traced {
            "off: the traced picture as it is"
        } else {
            "off"
        })
    } else if limits.loop_cap.is_some() {
        Some("this driver cuts long loops short, and paths with them")
    } else if limits.beyond_correction {
        Some("the picture is larger than this device's largest buffer of residuals")
    } else if facts.triangles == 0 && !facts.scatters && !judged && !traced {
        Some("nothing scatters: the picture is exact")
    } else {
        None
    }
}

/// Plans the correction of a technique's picture, or of a black one, and the estimate of its error.
pub(crate) fn plan(plan: &mut FramePlan, input: &PlanInput<'_>, base: bool) {
    // Without a technique there is no depth that residuals could be carried along with.
    let carries = base && input.settings.correction == CorrectionMode::Always;
    let grids = input.facts.grids > 0;
    let permutation = Permutation::of("correction")
        .with_if(base, "base")
        .with_if(carries, "history")
        .with_if(carries && grids, "grids");
    let what = if base {
        "traced samples less the technique's picture, band by band"
    } else {
        "bands of the traced picture that are above its noise"
    };
    let recorder = Correct {
        base,
        carries,
        grids,
    };
    let mut accesses = vec![
        TRACED_FILM.read(),
        MOMENTS.read(),
        EVEN_MEANS.read(),
        BAND_ENERGIES.written(),
        WINDOW_ENERGIES.written(),
        BELIEVED_ENERGIES.written(),
        CORRECTIONS.written(),
        SQUARE_ERRORS.written(),
        FILM.written(),
    ];
    if carries {
        accesses.push(RESIDUALS.with_previous("history").written());
        accesses.extend(carrying(input));
    } else {
        accesses.push(RESIDUALS.written());
        accesses.extend(base.then(|| TECHNIQUE_FILM.read_as("base_film")));
    }
    plan.run(
        NewPass::new(PASS, Programs::One(permutation), recorder)
            .when(When::Estimated)
            .accesses(accesses)
            .keeps(KeptKind::of::<Correction>(|device| {
                Box::new(Correction::new(device, [1, 1]))
            })),
        what,
    );
    estimate::plan(
        plan,
        true,
        [FILM.read(), SQUARE_ERRORS.read()],
        "error that the correction expects",
    );
}

/// What carrying residuals over from picture to picture takes.
fn carrying(input: &PlanInput<'_>) -> [Access; 9] {
    [
        TECHNIQUE_FILM.read(),
        // Looked at when a picture is new, in whose first frame it is drawn.
        depth(input.facts).read_when_written(),
        STEADY_BASE.written(),
        PLACES.written(),
        CARRIED.written(),
        CARRIED_BASE.written(),
        BASE_SCALES.written(),
        TILE_CHANGES.written(),
        FORGETTING.written(),
    ]
}
