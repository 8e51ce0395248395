//! Brings interleaved strata together, fills in pixels that were not marched, and marches those that
//! neither restores.

use super::march::March;
use crate::engine::{Access, Bytes, Extent, Permutation, Recording, ResourceSpec, Size};
use crate::error::RenderError;
use crate::frame::{Parts, Pass, PassId, PipelineList, PlannedPass};
use crate::stages::surfaces::SURFACE_RADIANCE;

/// Brings interleaved strata together, and fills in pixels that were not marched.
pub(super) const PASS: PassId = PassId("gather");

/// Its part that marches the listed pixels in full, in measured times.
const REJECTED: &str = "rejected_pixels";

/// In-scatter of the marched pixels, a share of it if interleaved.
const MARCHED: ResourceSpec =
    ResourceSpec::texture("marched_radiance", wgpu::TextureFormat::Rgba32Float);
/// Interleaved strata brought together along the rows, and along both axes.
const ROWS: ResourceSpec = ResourceSpec::texture("gathered_rows", wgpu::TextureFormat::Rgba32Float);
const GATHERED: ResourceSpec =
    ResourceSpec::texture("gathered_radiance", wgpu::TextureFormat::Rgba32Float);
/// See `low_resolution/pixel_list.wesl`: four words, then up to one a pixel.
const LIST: ResourceSpec = ResourceSpec::buffer(
    "rejected_pixels",
    Bytes::OfPicture(|[width, height]| 16 + 4 * u64::from(width) * u64::from(height)),
);
/// Permutations that bring strata together along rows, then along columns.
const ALONG_BOTH_AXES: [&str; 2] = ["gather+rows", "gather+columns"];

/// First words of an empty list: groups along x, y and z, and number of pixels.
pub(super) const EMPTY_LIST: [u32; 4] = [0, 1, 1, 0];
/// Holds those.
pub(super) const EMPTY: ResourceSpec = ResourceSpec::buffer("empty_list", Bytes::Fixed(16)).kept();

/// How pixels share what they march.
#[derive(Debug, Clone, Copy)]
pub(super) struct Shared {
    interleaved: bool,
    spacing: u32,
}

impl Shared {
    /// If they do.
    pub fn of(march: March) -> Option<Self> {
        march.is_shared().then_some(Self {
            interleaved: march.interleave > 1,
            spacing: march.spacing,
        })
    }

    /// The pixels that are marched.
    fn sized(self, spec: ResourceSpec) -> ResourceSpec {
        spec.sized(Extent::Picture {
            divisor: self.spacing,
        })
    }

    /// What the march writes.
    pub fn marched(self) -> ResourceSpec {
        self.sized(MARCHED)
    }

    /// What the gathering reads and writes beside depth and in-scatter.
    pub fn accesses(self) -> Vec<Access> {
        let mut accesses = vec![SURFACE_RADIANCE.read(), LIST.written(), LIST.counted()];
        let marched = self.marched();
        if self.interleaved {
            let (rows, gathered) = (self.sized(ROWS), self.sized(GATHERED));
            accesses.extend([
                marched.read(),
                rows.written_as("gathered_rows_written"),
                rows.read(),
                gathered.written_as("gathered_radiance_written"),
                gathered.read(),
            ]);
        } else {
            accesses.push(marched.read_as("gathered_radiance"));
        }
        accesses
    }
}

/// Gathers, lists what it could not restore, and marches that with the planned permutation.
#[derive(Debug)]
pub(super) struct Gather {
    pub shared: Shared,
    /// Permutation that restores pixels and lists those it can't.
    pub restoring: Permutation,
}

impl Pass for Gather {
    fn pipelines(&self, planned: &PlannedPass, list: &mut PipelineList) {
        if self.shared.interleaved {
            for program in ALONG_BOTH_AXES {
                list.compute(program);
            }
        }
        list.compute(self.restoring.name());
        list.compute(planned.program());
    }

    fn record(
        &self,
        planned: &PlannedPass,
        recording: &mut Recording<'_>,
        parts: &Parts<'_>,
    ) -> Result<(), RenderError> {
        let bindings = planned.bindings(parts)?;
        let constants = planned.constants(parts);
        let list = parts.buffer(&LIST)?;
        let empty = parts.buffer(&EMPTY)?;
        recording
            .encoder
            .copy_buffer_to_buffer(empty, 0, list, 0, Some(16));
        let name = PASS.name();
        if self.shared.interleaved {
            let marched = parts.size().map(|side| side.div_ceil(self.shared.spacing));
            for program in ALONG_BOTH_AXES {
                recording.compute(name, program, &constants, &bindings, Size::from(marched))?;
            }
        }
        let restoring = self.restoring.name();
        let whole = Size::from(parts.size());
        recording.compute(name, restoring, &constants, &bindings, whole)?;
        let [width, height] = parts.size();
        recording.compute_listed(
            REJECTED,
            planned.program(),
            &constants,
            &bindings,
            (list, width * height, planned.iterations),
        )
    }
}
