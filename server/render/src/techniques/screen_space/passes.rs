//! Plans the filter.

use tyndall_scene::{LevelFetch, ScreenSpaceFilter, ScreenSpaceSettings, SpreadModel};
use tyndall_shaders::types::FilterSettings;

use super::filter::{EXTENT, Filter, PASS};
use super::levels::{Levels, cells};
use crate::engine::{Access, Bytes, Constants, Permutation, ResourceSpec};
use crate::frame::{FramePlan, KeptKind, NewPass, PlanInput, Programs};
use crate::stages::film::Layer;
use crate::stages::surfaces::{EMISSION, LEAVING_RADIANCE, SURFACE_RADIANCE, depth};

/// What arrives unscattered (W·m⁻²·sr⁻¹), and the mean transmittance.
const ARRIVING: ResourceSpec =
    ResourceSpec::texture("arriving_radiance", wgpu::TextureFormat::Rgba32Float);
/// What is scattered, and the width of its spread, at all levels.
const SCATTERED: ResourceSpec = cells_of("scattered");
/// Of the splat pyramid: what stays at each level from 1 on.
const INJECTED: ResourceSpec = ResourceSpec::buffer(
    "injected",
    Bytes::OfPicture(|size| 16 * (cells(size) - u64::from(size[0]) * u64::from(size[1]))),
);
/// Bright pixels that are filtered apart.
const BRIGHT: ResourceSpec = cells_of("bright");
/// Deviations of spreads, blurred. Unit: px.
const BLURRED_SPREADS: ResourceSpec =
    ResourceSpec::buffer("blurred_spreads", Bytes::OfPicture(|size| 4 * cells(size)));
/// Sums of the gathering filter.
const GATHERED: ResourceSpec = ResourceSpec::buffer("gathered", Bytes::PerPixel(16));
/// The filter's settings on the device.
const SETTINGS: ResourceSpec = ResourceSpec::buffer(
    "filter_settings",
    Bytes::Fixed(size_of::<FilterSettings>() as u64),
)
.kept();

/// Four f32 for each cell of all levels.
const fn cells_of(name: &'static str) -> ResourceSpec {
    ResourceSpec::buffer(name, Bytes::OfPicture(|size| 16 * cells(size)))
}

/// Why the picture is only attenuated, if so.
pub(super) fn nothing_to_filter(input: &PlanInput<'_>) -> Option<&'static str> {
    let facts = input.facts;
    if facts.media == 0 {
        Some("no media")
    } else if facts.triangles == 0 && !facts.environment {
        Some("no surface and no sky: no light to spread")
    } else if !facts.scatters {
        Some("no medium scatters: attenuation alone is exact")
    } else {
        None
    }
}

/// Plans it; `area` is what area lights add to the surfaces' light, `once_elsewhere` whether what of their own
/// light is scattered once is added by another pass.
pub(super) fn plan(
    plan: &mut FramePlan,
    input: &PlanInput<'_>,
    area: Option<Layer>,
    once_elsewhere: bool,
) {
    let facts = input.facts;
    let settings = &input.settings.screen_space;
    let filter = Filter::of(settings);
    let emissive = once_elsewhere && facts.emissive_triangles > 0;
    let permutation = Permutation::of(filter.pixels())
        .with_if(filter.separated, "separated")
        .with_if(filter.blurred, "blurred")
        .with_if(emissive, "emissive")
        .with_if(area.is_some(), "area")
        .with_if(facts.grids > 0, "grids");
    let accesses: Vec<Access> = match filter.kind {
        ScreenSpaceFilter::Splat => vec![SCATTERED.written(), INJECTED.written()],
        ScreenSpaceFilter::Gather => vec![SCATTERED.written(), GATHERED.written()],
        ScreenSpaceFilter::Hierarchical => [SCATTERED.written()]
            .into_iter()
            .chain(filter.separated.then(|| BRIGHT.written()))
            .chain(filter.blurred.then(|| BLURRED_SPREADS.written()))
            .collect(),
    };
    plan.run(
        NewPass::new(PASS, Programs::One(permutation), filter)
            .constants(constants(settings).flag("ONCE_ELSEWHERE", once_elsewhere))
            .iterations(u64::from(facts.voxels_across) * facts.grids as u64)
            .values(SETTINGS, &values(settings))
            .keeps(KeptKind::of::<Levels>(|device| {
                Box::new(Levels::empty(device))
            }))
            .accesses([
                depth(facts).read(),
                LEAVING_RADIANCE.read(),
                ARRIVING.written_as("arriving_radiance_written"),
                ARRIVING.read(),
                EXTENT.written(),
                SURFACE_RADIANCE.written(),
            ])
            .accesses(accesses)
            .accesses(emissive.then(|| EMISSION.read()))
            .accesses(area.map(|(_, access)| access)),
        reason(settings),
    );
    if filter.kind == ScreenSpaceFilter::Hierarchical && !filter.separated {
        plan.skip(PASS, "separation", "off");
    }
}

fn reason(settings: &ScreenSpaceSettings) -> String {
    let spread = match settings.spread {
        SpreadModel::Premoze => "Premože's spread",
        SpreadModel::ExactMoments => "the exact moments' spread",
    };
    let how = match settings.filter {
        ScreenSpaceFilter::Splat => "each pixel's light to its levels of a pyramid",
        ScreenSpaceFilter::Hierarchical => "each pixel from its level of the picture",
        ScreenSpaceFilter::Gather => return format!("each pixel's exact kernel, {spread}: slow"),
    };
    let side = settings.kernel;
    format!("{how}, {side}×{side} taps, {spread}; no level beyond the widest")
}

fn constants(settings: &ScreenSpaceSettings) -> Constants {
    Constants::default()
        .number("KERNEL", settings.kernel)
        .flag(
            "EXACT_MOMENTS",
            settings.spread == SpreadModel::ExactMoments,
        )
        .flag("WEIGHTED", settings.luminance_weighting)
        .flag("MASKED", settings.masking)
        .flag("BICUBIC", settings.fetch != LevelFetch::LinearBilinear)
        .flag("CUBIC_LEVELS", settings.fetch == LevelFetch::CubicBicubic)
}

fn values(settings: &ScreenSpaceSettings) -> FilterSettings {
    FilterSettings {
        ambient: settings.ambient.map(|channel| channel as f32),
        glows: if settings.in_scatter { 0.0 } else { 1.0 },
        separation_luminance: settings.separation_luminance as f32,
        separation_depth: settings.separation_depth as f32,
        padding: [0; 2],
    }
}
