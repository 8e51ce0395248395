//! The pass that traces paths, for a picture of its own or to correct another, and what it keeps of
//! every pixel.

use tyndall_scene::MediumOrder;
use tyndall_shaders::types::{self, PathRules};

use crate::engine::{Bytes, Permutation, Recording, ResourceSpec, Size};
use crate::error::RenderError;
use crate::frame::{
    FramePlan, NewPass, Parts, Pass, PassId, PlanInput, PlannedPass, Programs, Traces,
};
use crate::picture::When;
use crate::stages::film::FILM;

/// Unbiased path tracing of everything.
pub(crate) const PASS: PassId = PassId("reference");

/// The traced mean where it is not the picture itself, four f32 a pixel.
pub(crate) const TRACED_FILM: ResourceSpec = per_pixel("traced_film");
/// Sum of squared deviations and number of samples, and mean of the even samples and their number,
/// four f32 a pixel each: see `techniques/reference/path_trace.wesl`.
pub(crate) const MOMENTS: ResourceSpec = per_pixel("moments");
/// See [`MOMENTS`].
pub(crate) const EVEN_MEANS: ResourceSpec = per_pixel("even_means");
/// Base colour and depth.
pub(crate) const FILM_ALBEDO: ResourceSpec = per_pixel("film_albedo");
/// Normal and share that met a surface.
pub(crate) const FILM_NORMAL: ResourceSpec = per_pixel("film_normal");
/// Four words a pixel each: a path that waits for the next dispatch. No buffer takes more than the film
/// does, so that pictures of every technique may have the same size.
const WAITING: [ResourceSpec; 4] = [
    per_pixel("waiting_origins"),
    per_pixel("waiting_directions"),
    per_pixel("waiting_throughputs"),
    per_pixel("waiting_radiances"),
];
/// Which paths count, on the device.
const RULES: ResourceSpec =
    ResourceSpec::buffer("path_rules", Bytes::Fixed(size_of::<PathRules>() as u64)).kept();

/// Segments after which a path is given up, and counted as truncated.
const MAX_EVENTS: u32 = 1 << 20;

const fn per_pixel(name: &'static str) -> ResourceSpec {
    ResourceSpec::buffer(name, Bytes::PerPixel(16)).kept()
}

/// Plans the paths. Their mean is the picture, unless that is corrected.
pub(crate) fn plan(plan: &mut FramePlan, input: &PlanInput<'_>) {
    let facts = input.facts;
    let film = if input.is_corrected() {
        TRACED_FILM
    } else {
        FILM
    };
    let surfaces = facts.triangles > 0;
    let textured = surfaces && facts.textures + facts.data_textures > 0;
    let permutation = Permutation::of("reference")
        .with_if(surfaces, "surfaces")
        .with_if(textured, "textured")
        .with_if(facts.grids > 0, "grids")
        .with_if(facts.environment_map, "environment_map");
    let kept = [MOMENTS, EVEN_MEANS, FILM_ALBEDO, FILM_NORMAL];
    plan.run(
        NewPass::new(PASS, Programs::One(permutation), TraceSlice)
            .when(When::Traced)
            .traces(if surfaces {
                Traces::Triangles
            } else {
                Traces::Nothing
            })
            .values(RULES, &rules(input))
            .accesses([film.written_as("film")])
            .accesses(kept.into_iter().chain(WAITING).map(ResourceSpec::written)),
        format!(
            "{} lights, {} emissive triangles, {} media of which {} grids",
            input.lights(),
            facts.emissive_triangles,
            facts.media,
            facts.grids
        ),
    );
}

fn rules(input: &PlanInput<'_>) -> PathRules {
    let paths = &input.settings.reference;
    let limit = |most: Option<u32>| most.unwrap_or(1 << 30);
    PathRules {
        max_scatterings: limit(paths.max_scatterings),
        max_surface_scatterings: limit(paths.max_surface_scatterings),
        medium_order: match paths.medium_order {
            MediumOrder::All => types::ORDER_ALL,
            MediumOrder::None => types::ORDER_NONE,
            MediumOrder::Single => types::ORDER_SINGLE,
            MediumOrder::Multiple => types::ORDER_MULTIPLE,
        },
        max_events: MAX_EVENTS,
    }
}

/// Traces the frame's slice of the picture.
#[derive(Debug)]
struct TraceSlice;

impl Pass for TraceSlice {
    /// Of a new picture no pixel has a sample, whether or not this frame takes any.
    fn begin(
        &self,
        planned: &PlannedPass,
        recording: &mut Recording<'_>,
        parts: &Parts<'_>,
    ) -> Result<(), RenderError> {
        if parts.share.restarts {
            let cleared = planned.accesses.iter().filter(|a| a.kind.writes());
            for access in cleared {
                let buffer = parts.buffer(&access.resource)?;
                recording.encoder.clear_buffer(buffer, 0, None);
            }
        }
        Ok(())
    }

    fn record(
        &self,
        planned: &PlannedPass,
        recording: &mut Recording<'_>,
        parts: &Parts<'_>,
    ) -> Result<(), RenderError> {
        let Some(slice) = parts.share.slice else {
            return Ok(());
        };
        // A slice is as long as a dispatch may be.
        recording.end_part();
        recording.compute(
            PASS.name(),
            planned.program(),
            &planned.constants(parts),
            &planned.bindings(parts)?,
            Size::from(slice.invocations(parts.size()[0])),
        )?;
        recording.end_part();
        Ok(())
    }
}
