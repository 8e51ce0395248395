//! What the camera sees: the G-buffer by rasterization, and its direct light.
//!
//! Transports order 0 of the partition: emission and direct light of surfaces, attenuated
//! along both legs through the sum of all analytic media (closed forms). Bias: shadow maps only.

use tyndall_scene::SceneFacts;

use crate::engine::{
    ColorTarget, Constants, DepthTarget, Permutation, RasterDraw, RasterPass, RasterState,
    Recording, ResourceSpec, cleared, find,
};
use crate::error::RenderError;
use crate::frame::{
    Dispatch, FramePlan, NewPass, Parts, Pass, PassId, PipelineList, PlanInput, PlannedPass,
    Programs, Reach,
};
use crate::gpu_scene::{DrawClass, VERTEX_LAYOUT};

/// Depth, base colour, normal, emission of what the camera sees.
pub(crate) const GBUFFER: PassId = PassId("gbuffer");
/// Direct light of surfaces, attenuated.
pub(crate) const SHADE: PassId = PassId("shade");

/// Format of the G-buffer's colours, in the order of `stages/surfaces/gbuffer.wesl`.
pub(crate) const GBUFFER_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;

const DEPTH: ResourceSpec =
    ResourceSpec::texture("gbuffer_depth", wgpu::TextureFormat::Depth32Float);
const BASE_COLOR: ResourceSpec = ResourceSpec::texture("gbuffer_base_color", GBUFFER_FORMAT);
const NORMAL: ResourceSpec = ResourceSpec::texture("gbuffer_normal", GBUFFER_FORMAT);
/// Emission of what the camera sees; drawn where triangles emit.
pub(crate) const EMISSION: ResourceSpec = ResourceSpec::texture("gbuffer_emission", GBUFFER_FORMAT);

/// Light of surfaces that arrives at the eye (W·m⁻²·sr⁻¹), and the mean transmittance on the way.
pub(crate) const SURFACE_RADIANCE: ResourceSpec =
    ResourceSpec::texture("surface_radiance", wgpu::TextureFormat::Rgba32Float);

/// The same as it leaves the surfaces, and the sky, before the media on the way.
pub(crate) const LEAVING_RADIANCE: ResourceSpec =
    ResourceSpec::texture("leaving_radiance", wgpu::TextureFormat::Rgba32Float);

/// Where on its way to the eye the light of surfaces is wanted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Place {
    /// Where it arrives.
    Eye,
    /// Where it starts.
    Surface,
}

impl Place {
    /// What shaders are told.
    pub fn constants(self) -> Constants {
        Constants::default().flag("LEAVING", self == Self::Surface)
    }
}

/// Reversed depth of what the camera sees.
pub(crate) fn depth(facts: &SceneFacts) -> ResourceSpec {
    drawn_or_empty(DEPTH, facts)
}

/// Linear base colour of what the camera sees, and its roughness.
pub(crate) fn base_color(facts: &SceneFacts) -> ResourceSpec {
    drawn_or_empty(BASE_COLOR, facts)
}

/// Unit normal of what the camera sees, toward it, and how metallic it is.
pub(crate) fn normal(facts: &SceneFacts) -> ResourceSpec {
    drawn_or_empty(NORMAL, facts)
}

/// Without triangles nothing is drawn: the view keeps a texture of its own that holds zeros.
fn drawn_or_empty(spec: ResourceSpec, facts: &SceneFacts) -> ResourceSpec {
    if facts.triangles > 0 {
        spec
    } else {
        spec.kept()
    }
}

/// Plans the G-buffer.
pub(crate) fn plan_gbuffer(plan: &mut FramePlan, input: &PlanInput<'_>) {
    let facts = input.facts;
    let emissive = facts.emissive_triangles > 0;
    if facts.triangles > 0 {
        let permutation = Permutation::of("gbuffer")
            .with_if(emissive, "emissive")
            .with_if(facts.textures + facts.data_textures > 0, "textured");
        let targets = [DEPTH.drawn(), BASE_COLOR.drawn(), NORMAL.drawn()];
        plan.run(
            NewPass::new(
                GBUFFER,
                Programs::Several(permutation.clone()),
                DrawSurfaces {
                    emissive,
                    opaque: permutation.name().to_owned(),
                    discarding: permutation
                        .of_shader("gbuffer+discarding")
                        .name()
                        .to_owned(),
                },
            )
            .accesses(targets)
            .accesses(emissive.then(|| EMISSION.drawn())),
            format!(
                "{} triangles in {} instances",
                facts.triangles, facts.instances
            ),
        );
    } else {
        plan.skip(GBUFFER, "", "no triangles: only the depth is cleared");
    }
    if !emissive {
        plan.skip(GBUFFER, "emission target", "no emissive triangles");
    }
}

/// Plans the direct light, written to [`SURFACE_RADIANCE`] or [`LEAVING_RADIANCE`].
pub(crate) fn plan_shade(plan: &mut FramePlan, input: &PlanInput<'_>, place: Place) {
    let facts = input.facts;
    let emissive = facts.emissive_triangles > 0;
    let permutation = Permutation::of("shade")
        .with_if(facts.glossy_materials > 0, "glossy")
        .with_if(emissive, "emissive")
        .with_if(facts.media > 0, "media");
    let permutation = input
        .visibility_feature()
        .into_iter()
        .fold(permutation, Permutation::with)
        .with_if(facts.grids > 0, "grids")
        .with_if(facts.environment_map, "environment_map");
    let (written, before) = match place {
        Place::Eye => (SURFACE_RADIANCE, ""),
        Place::Surface => (LEAVING_RADIANCE, " on the way there"),
    };
    plan.run(
        NewPass::new(SHADE, Programs::One(permutation), Dispatch(Reach::Picture))
            .iterations(input.iterations_a_point())
            .constants(place.constants())
            .accesses([
                depth(facts).read(),
                base_color(facts).read(),
                normal(facts).read(),
                written.written_as("surface_radiance"),
            ])
            .accesses(emissive.then(|| EMISSION.read())),
        format!(
            "{} lights on surfaces, attenuated by {} media{before}",
            input.lights(),
            facts.media
        ),
    );
}

/// Draws every instance.
#[derive(Debug)]
struct DrawSurfaces {
    /// Whether emission is drawn, too.
    emissive: bool,
    /// Permutation of what hides everything behind it.
    opaque: String,
    /// Permutation of what has holes or only one side.
    discarding: String,
}

impl Pass for DrawSurfaces {
    fn pipelines(&self, _planned: &PlannedPass, list: &mut PipelineList) {
        let state = gbuffer_state(if self.emissive { 3 } else { 2 });
        for program in [&self.opaque, &self.discarding] {
            list.raster(program, &state);
        }
    }

    fn record(
        &self,
        planned: &PlannedPass,
        recording: &mut Recording<'_>,
        parts: &Parts<'_>,
    ) -> Result<(), RenderError> {
        let geometry = &parts.assets.geometry;
        let (opaque, discarding) = (find(&self.opaque)?, find(&self.discarding)?);
        let draws: Vec<_> = geometry
            .draws
            .iter()
            .map(|draw| RasterDraw {
                shader: match draw.class {
                    DrawClass::Opaque => opaque,
                    DrawClass::SingleSided | DrawClass::Masked => discarding,
                },
                call: draw.call(),
            })
            .collect();
        let views = |spec: ResourceSpec| parts.resources.texture(spec.name);
        let draws_emission = self.emissive.then_some(EMISSION);
        let drawn = [BASE_COLOR, NORMAL].into_iter().chain(draws_emission);
        let colors: Vec<_> = drawn.filter_map(views).map(cleared).collect();
        let state = gbuffer_state(colors.len());
        recording.raster(
            GBUFFER.name(),
            &RasterPass {
                state: &state,
                colors: &colors,
                depth: views(DEPTH).map(cleared),
                geometry: Some((&geometry.vertices, &geometry.indices)),
                draws: &draws,
            },
            &planned.bindings(parts)?,
        )
    }
}

/// State of the G-buffer's pipelines with so many colours.
pub(crate) fn gbuffer_state(colors: usize) -> RasterState {
    RasterState {
        vertices: Some(&VERTEX_LAYOUT),
        topology: wgpu::PrimitiveTopology::TriangleList,
        colors: vec![ColorTarget::replaced(GBUFFER_FORMAT); colors],
        depth: Some(DepthTarget {
            bias: wgpu::DepthBiasState::default(),
        }),
    }
}
