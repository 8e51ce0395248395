//! The light volume: optical depth of the density grids toward each light, at the samples of a box
//! around all grids. Built again only when a light or a grid moves, or a grid's extinction changes.

use std::cell::Cell;
use std::sync::Arc;

use glam::{DAffine3, DVec3, UVec3};
use tyndall_scene::{ChangeSet, Light, LightPlace, Medium, MediumShape, Scene, SharedGrid};
use tyndall_shaders::types;

use crate::engine::{Bindings, Device, Recording};
use crate::error::RenderError;
use crate::frame::{
    Filled, FramePlan, Kept, KeptKind, NewPass, Parts, Pass, PassId, PipelineList, PlanInput,
    PlannedPass, Preparation, Programs,
};

/// Optical depth of density grids toward the lights; filled again only when either changes.
pub(crate) const PASS: PassId = PassId("light_volume");

/// Samples along one axis of a light's field: more cost memory, fewer blur the shadow.
const MAX_SAMPLES: u32 = 128;
const MIN_SAMPLES: u32 = 4;
/// Of all fields together.
const MAX_BYTES: u64 = 256 << 20;
/// Four half floats.
const TEXEL_BYTES: u64 = 8;

/// Changes after which the depths may be others: no light's power, no phase function, no camera.
const DEPENDS_ON: ChangeSet = ChangeSet::LIGHT_SET
    .union(ChangeSet::LIGHT_POSE)
    .union(ChangeSet::MEDIUM_COEFFICIENTS)
    .union(ChangeSet::MEDIUM_SHAPE);

/// What the depths follow from. After a change of `DEPENDS_ON` this tells whether it was one: emission
/// and the extinction of media that are no grids are not in it.
#[derive(Debug, Clone, PartialEq)]
struct Key {
    lights: Vec<LightPlace>,
    grids: Vec<(SharedGrid, DAffine3, [f32; 3])>,
}

/// The light volume of one view; nothing before its first scene.
#[derive(Debug)]
pub(crate) struct LightVolume {
    contents: Option<Contents>,
}

/// The depths of one scene's lights and grids.
#[derive(Debug, Clone)]
struct Contents {
    key: Key,
    low: DVec3,
    high: DVec3,
    field: Arc<Field>,
    filled: Cell<Filled>,
}

/// Their place on the device, whatever they are.
#[derive(Debug)]
struct Field {
    /// Samples of one light's.
    size: UVec3,
    lights: u32,
    values: wgpu::Buffer,
    depths: wgpu::TextureView,
    sampler: wgpu::Sampler,
}

/// Plans the volume where there are grids.
pub(crate) fn plan(plan: &mut FramePlan, input: &PlanInput<'_>) {
    let (grids, lights) = (input.facts.grids, input.lights());
    if grids == 0 {
        plan.skip(
            PASS,
            "",
            "no density grids: optical depths have closed forms",
        );
        return;
    }
    plan.run(
        NewPass::new(PASS, Programs::None, Fill)
            // Each walks through all grids once.
            .iterations(grids as u64 * u64::from(input.facts.voxels_across))
            .keeps(KeptKind::of::<LightVolume>(|_| {
                Box::new(LightVolume { contents: None })
            })),
        format!("depth of {grids} grids toward {lights} lights, kept until either changes"),
    );
}

impl Kept for LightVolume {
    fn next(&self, preparation: &Preparation<'_>) -> Result<Box<dyn Kept>, RenderError> {
        let Preparation {
            device,
            scene,
            changed,
            ..
        } = *preparation;
        let before = self.contents.as_ref();
        if let Some(before) = before
            && !changed.intersects(DEPENDS_ON)
        {
            return Ok(Box::new(Self {
                contents: Some(before.clone()),
            }));
        }
        let contents = Contents::of(device, scene, before)?;
        Ok(Box::new(Self { contents }))
    }

    fn upload(&self, device: &Device, scene: &Scene) {
        let Some(contents) = &self.contents else {
            return;
        };
        let origin = scene.camera.position;
        let field = &contents.field;
        let value = types::LightVolume {
            low: (contents.low - origin).as_vec3().to_array(),
            lights: field.lights,
            high: (contents.high - origin).as_vec3().to_array(),
            size: field.size.to_array(),
            ..Default::default()
        };
        device
            .queue
            .write_buffer(&field.values, 0, bytemuck::bytes_of(&value));
    }

    fn bind<'a>(&'a self, bindings: &mut Bindings<'a>) {
        if let Some(Contents { field, .. }) = &self.contents {
            bindings
                .buffer("light_volume", &field.values)
                .texture("light_depths", &field.depths)
                .texture("light_depths_written", &field.depths)
                .sampler("light_depth_sampler", &field.sampler);
        }
    }

    fn settle(&mut self, submitted: bool) {
        if let Some(contents) = &self.contents {
            contents
                .filled
                .set(contents.filled.get().settled(submitted));
        }
    }
}

/// Fills the volume, unless it is filled.
#[derive(Debug)]
struct Fill;

impl Pass for Fill {
    fn pipelines(&self, _planned: &PlannedPass, list: &mut PipelineList) {
        list.compute(PASS.name());
    }

    fn record(
        &self,
        planned: &PlannedPass,
        recording: &mut Recording<'_>,
        parts: &Parts<'_>,
    ) -> Result<(), RenderError> {
        let volume = parts.kept.get::<LightVolume>();
        let Some(contents) = volume.and_then(|volume| volume.contents.as_ref()) else {
            return Ok(());
        };
        if contents.filled.get() != Filled::No {
            return Ok(());
        }
        let Field { size, lights, .. } = *contents.field.as_ref();
        recording.compute_in_parts(
            PASS.name(),
            PASS.name(),
            parts.constants,
            &planned.bindings(parts)?,
            ([size.x, size.y, size.z * lights], planned.iterations),
        )?;
        contents.filled.set(Filled::Recorded);
        Ok(())
    }
}

impl Contents {
    /// For the grids and lights of `scene`; `None` without a grid. Takes over from `before` what still
    /// holds.
    fn of(
        device: &Device,
        scene: &Scene,
        before: Option<&Self>,
    ) -> Result<Option<Self>, RenderError> {
        let key = key(scene);
        if let Some(before) = before
            && before.key == key
        {
            return Ok(Some(before.clone()));
        }
        let Some((low, high, spacing)) = bounds(&scene.media) else {
            return Ok(None);
        };
        // Without lights it is there to be bound.
        let lights = scene.lights.len().max(1) as u32;
        let side = device.device.limits().max_texture_dimension_3d;
        if lights > side / MIN_SAMPLES {
            return Err(RenderError::TooLarge {
                what: "lights beside density grids",
                needed: lights.into(),
                allowed: (side / MIN_SAMPLES).into(),
            });
        }
        let size = samples(high - low, spacing, lights, side);
        let same =
            before.filter(|before| (before.field.size, before.field.lights) == (size, lights));
        let filled = if scene.lights.is_empty() {
            Filled::Yes
        } else {
            Filled::No
        };
        Ok(Some(Self {
            key,
            low,
            high,
            field: same.map_or_else(
                || Arc::new(Field::new(device, size, lights)),
                |before| Arc::clone(&before.field),
            ),
            filled: Cell::new(filled),
        }))
    }
}

impl Field {
    fn new(device: &Device, size: UVec3, lights: u32) -> Self {
        let texture = device.device.create_texture(&wgpu::TextureDescriptor {
            label: Some("light_depths"),
            size: wgpu::Extent3d {
                width: size.x,
                height: size.y,
                depth_or_array_layers: size.z * lights,
            },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D3,
            format: wgpu::TextureFormat::Rgba16Float,
            usage: wgpu::TextureUsages::STORAGE_BINDING | wgpu::TextureUsages::TEXTURE_BINDING,
            view_formats: &[],
        });
        Self {
            size,
            lights,
            values: device.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("light_volume"),
                size: size_of::<types::LightVolume>() as u64,
                usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            }),
            depths: texture.create_view(&wgpu::TextureViewDescriptor::default()),
            sampler: device.device.create_sampler(&wgpu::SamplerDescriptor {
                label: Some("light_depth_sampler"),
                mag_filter: wgpu::FilterMode::Linear,
                min_filter: wgpu::FilterMode::Linear,
                ..Default::default()
            }),
        }
    }
}

fn key(scene: &Scene) -> Key {
    let grid = |medium: &Medium| match &medium.shape {
        MediumShape::Grid {
            grid,
            world_from_lattice,
        } => {
            let sigma_t = std::array::from_fn(|c| medium.sigma_s[c] + medium.sigma_a[c]);
            Some((grid.clone(), *world_from_lattice, sigma_t))
        }
        _ => None,
    };
    Key {
        lights: scene.lights.iter().map(Light::place).collect(),
        grids: scene.media.iter().filter_map(grid).collect(),
    }
}

/// Box around all grids and the smallest step of their lattices; `None` without a grid.
fn bounds(media: &[Medium]) -> Option<(DVec3, DVec3, f64)> {
    let (mut low, mut high, mut spacing) = (DVec3::MAX, DVec3::MIN, f64::MAX);
    for medium in media {
        let MediumShape::Grid {
            grid,
            world_from_lattice,
        } = &medium.shape
        else {
            continue;
        };
        for corner in 0..8 {
            let pick = |axis: usize| grid.clip[corner >> axis & 1][axis];
            let point = world_from_lattice.transform_point3(DVec3::new(pick(0), pick(1), pick(2)));
            low = low.min(point);
            high = high.max(point);
        }
        let axes = world_from_lattice.matrix3;
        for axis in [axes.x_axis, axes.y_axis, axes.z_axis] {
            spacing = spacing.min(axis.length());
        }
    }
    low.cmplt(high).all().then_some((low, high, spacing))
}

/// Samples a side of one light's field: as fine as the lattice where memory allows.
fn samples(extent: DVec3, spacing: f64, lights: u32, side: u32) -> UVec3 {
    let mut most = MAX_SAMPLES.min(side / lights);
    loop {
        let wanted = (extent / spacing.max(1e-12)).ceil();
        let size = wanted
            .clamp(
                DVec3::splat(f64::from(MIN_SAMPLES)),
                DVec3::splat(f64::from(most.max(MIN_SAMPLES))),
            )
            .as_uvec3();
        let texels = u64::from(size.x) * u64::from(size.y) * u64::from(size.z);
        let bytes = texels * u64::from(lights) * TEXEL_BYTES;
        if bytes <= MAX_BYTES || most <= MIN_SAMPLES {
            return size;
        }
        most = most * 3 / 4;
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;
    use tyndall_scene::PhaseFunction;

    use super::*;

    #[test]
    fn only_what_the_depths_depend_on_fills_it_anew() {
        let description = tyndall_scene::presets::description("smoke_plume").expect("a preset");
        let scene = tyndall_scene::build(description, None)
            .expect("valid")
            .scene;
        let mut brighter = scene.clone();
        let mut moved = scene.clone();
        let (Some(Light::Directional(sun)), Some(Light::Directional(turned))) =
            (brighter.lights.first_mut(), moved.lights.first_mut())
        else {
            panic!("the plume stands in the sun");
        };
        sun.irradiance = [7.0; 3];
        turned.direction = -Vec3::Y;
        brighter.media[0].phase = PhaseFunction::HenyeyGreenstein { g: 0.1 };
        brighter.media[0].emission = [1.0; 3];
        let mut thinner = scene.clone();
        thinner.media[0].sigma_a[2] += 0.1;
        assert_eq!(key(&scene), key(&brighter));
        assert_ne!(key(&scene), key(&moved));
        assert_ne!(key(&scene), key(&thinner));
    }

    #[test]
    fn a_field_is_as_fine_as_its_lattice_up_to_a_bound() {
        assert_eq!(
            samples(DVec3::splat(2.0), 1.0 / 32.0, 1, 2048),
            UVec3::splat(64)
        );
        assert_eq!(samples(DVec3::splat(2.0), 1e-3, 1, 2048), UVec3::splat(128));
        assert_eq!(
            samples(DVec3::new(8.0, 1.0, 0.01), 0.1, 1, 2048),
            UVec3::new(80, 10, 4)
        );
    }

    #[test]
    fn many_lights_make_fields_coarser_and_stay_within_memory() {
        for lights in [2, 17, 100, 512] {
            let size = samples(DVec3::splat(1.0), 1e-3, lights, 2048);
            assert!(size.z * lights <= 2048, "{lights}: {size}");
            let texels = u64::from(size.x) * u64::from(size.y) * u64::from(size.z);
            assert!(
                texels * u64::from(lights) * TEXEL_BYTES <= MAX_BYTES,
                "{lights}: {size}"
            );
        }
    }
}
