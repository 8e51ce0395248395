//! How large the error of the mean is expected to be: summed up over tiles, then over the picture.

use crate::engine::{Access, Bytes, Permutation, Recording, ResourceSpec, Size};
use crate::error::RenderError;
use crate::frame::{FramePlan, NewPass, Parts, Pass, PassId, PipelineList, PlannedPass, Programs};
use crate::picture::When;

/// The mean's own error.
pub(crate) const PASS: PassId = PassId("estimate");

/// Four f32 a tile of 8×8 pixels.
const TILE_SUMS: ResourceSpec =
    ResourceSpec::buffer("tile_sums", Bytes::PerTile { side: 8, bytes: 16 });

/// Permutation that sums up the tiles.
const TOTAL: &str = "estimate+total";

/// Plans the estimate from what `reads` tells: of the corrected picture, or of the mean by its halves.
pub(crate) fn plan(
    plan: &mut FramePlan,
    corrected: bool,
    reads: impl IntoIterator<Item = Access>,
    reason: &str,
) {
    let permutation = Permutation::of("estimate")
        .with("tiles")
        .with_if(corrected, "corrected");
    plan.run(
        NewPass::new(PASS, Programs::One(permutation), TilesThenTotal)
            .when(When::Estimated)
            .accesses(reads)
            .accesses([TILE_SUMS.written()]),
        reason,
    );
}

/// One dispatch over tiles and one of a single group over them.
#[derive(Debug)]
struct TilesThenTotal;

impl Pass for TilesThenTotal {
    fn pipelines(&self, planned: &PlannedPass, list: &mut PipelineList) {
        list.compute(planned.program());
        list.compute(TOTAL);
    }

    fn record(
        &self,
        planned: &PlannedPass,
        recording: &mut Recording<'_>,
        parts: &Parts<'_>,
    ) -> Result<(), RenderError> {
        let constants = planned.constants(parts);
        let bindings = planned.bindings(parts)?;
        let tiles = Size::from(parts.size());
        recording.compute(PASS.name(), planned.program(), &constants, &bindings, tiles)?;
        let total = Size::from([1, 1]);
        recording.compute(PASS.name(), TOTAL, &constants, &bindings, total)
    }
}
