//! Depth maps seen from the lights: one for a spot, six for a point, one for a directional light.
//!
//! All are layers of one array. A layer is rendered again only when the resolution or its light's pose
//! changed, or a caster in its frustum moved: a moving camera costs nothing here.
//! Bias: a texel's footprint; slope-scaled depth bias in the map, normal offset at receivers.

mod maps;
mod poses;

use std::cell::Cell;
use std::sync::Arc;

use tyndall_scene::{Aabb, ChangeSet, Geometry, Scene};
use tyndall_shaders::types::ShadowView;

use crate::engine::{
    Bindings, DepthTarget, Device, RasterDraw, RasterPass, RasterState, Recording, cleared, find,
};
use crate::error::RenderError;
use crate::frame::{
    Filled, FramePlan, Kept, KeptKind, NewPass, Parts, Pass, PassId, PipelineList, PlanInput,
    PlannedPass, Preparation, Programs,
};
use crate::gpu_scene::{DrawClass, Origin, VERTEX_LAYOUT};
use maps::Maps;
use poses::{Lens, Pose, clip_from_relative, poses_of};

/// Depth maps seen from the lights; rendered again only for what moved.
pub(crate) const PASS: PassId = PassId("shadow_maps");

/// Boxes of moved casters that are looked at one by one.
const MAX_BOXES: usize = 1024;

/// The depth maps of one view.
#[derive(Debug)]
pub(crate) struct ShadowMaps {
    resolution: u32,
    poses: Vec<Pose>,
    /// Whether a layer holds the depths of its pose.
    current: Vec<Cell<Filled>>,
    /// Layers rendered since they were counted last.
    rendered: Cell<u32>,
    /// First layer of each light.
    first: Vec<Option<u32>>,
    maps: Option<Arc<Maps>>,
    sampler: wgpu::Sampler,
}

/// Plans the maps where visibility is looked up in them.
pub(super) fn plan(plan: &mut FramePlan, input: &PlanInput<'_>) {
    let facts = input.facts;
    let views = facts.shadow_views();
    let side = input.settings.shadows.resolution;
    plan.run(
        NewPass::new(PASS, Programs::None, RenderMaps).keeps(KeptKind::of::<ShadowMaps>(
            |device| Box::new(ShadowMaps::new(device)),
        )),
        format!("up to {views} views of {side}×{side}, kept until a light or a caster moves"),
    );
}

impl ShadowMaps {
    fn new(device: &Device) -> Self {
        Self {
            resolution: 0,
            poses: Vec::new(),
            current: Vec::new(),
            rendered: Cell::new(0),
            first: Vec::new(),
            maps: None,
            sampler: device.device.create_sampler(&wgpu::SamplerDescriptor {
                label: Some("shadow_sampler"),
                mag_filter: wgpu::FilterMode::Linear,
                min_filter: wgpu::FilterMode::Linear,
                // Reversed depth: lit where the receiver is at least as near as the nearest caster.
                compare: Some(wgpu::CompareFunction::GreaterEqual),
                ..Default::default()
            }),
        }
    }

    /// Forgets the depths of layers that see a caster which moved; `boxes` are around each where it was
    /// and where it is. Unit: m.
    fn forget_moved(&self, boxes: &[Aabb]) {
        let joined = boxes.iter().copied().reduce(|a, b| Aabb {
            min: a.min.min(b.min),
            max: a.max.max(b.max),
        });
        let Some(joined) = joined else { return };
        for (pose, current) in self.poses.iter().zip(&self.current) {
            // So many boxes are not told apart: that would cost more than the depths.
            let seen = || boxes.len() > MAX_BOXES || boxes.iter().any(|b| pose.sees(b));
            if pose.sees(&joined) && seen() {
                current.set(Filled::No);
            }
        }
    }

    /// How many layers were rendered since the last call.
    pub fn take_rendered(&self) -> u32 {
        self.rendered.take()
    }

    /// First layer of light `index` and the side of its texels, if it has a map: in metres, or at
    /// distance 1 for a light with a position.
    pub fn of_light(&self, index: usize) -> Option<(u32, f32)> {
        let first = (*self.first.get(index)?)?;
        let side = match self.poses[first as usize].lens {
            Lens::Perspective { tan, .. } => tan,
            Lens::Orthographic { half } => half.x.max(half.y),
        };
        Some((first, (2.0 * side / f64::from(self.resolution)) as f32))
    }
}

impl Kept for ShadowMaps {
    /// Keeps every layer whose pose is unchanged and which sees nothing that moved.
    fn next(&self, preparation: &Preparation<'_>) -> Result<Box<dyn Kept>, RenderError> {
        let Preparation {
            device,
            scene,
            facts,
            before,
            changed,
            ..
        } = *preparation;
        let resolution = scene.render.shadows.resolution;
        let mut poses = Vec::new();
        let first = scene
            .lights
            .iter()
            .map(|light| {
                let casts = light.casts_shadows() && light.is_lit();
                let bounds = facts.swept_bounds.filter(|_| casts)?;
                let first = poses.len() as u32;
                poses.extend(poses_of(light, bounds, resolution));
                Some(first)
            })
            .collect();
        let fits = poses.len() == self.poses.len() && resolution == self.resolution;
        let maps = if fits {
            self.maps.clone()
        } else if poses.is_empty() {
            None
        } else {
            let layers = poses.len() as u32;
            Some(Arc::new(Maps::new(device, resolution, layers)?))
        };
        let current = |(i, pose): (usize, &Pose)| {
            let stays = fits && !changed.contains(ChangeSet::SURFACES) && *pose == self.poses[i];
            Cell::new(if stays {
                self.current[i].get()
            } else {
                Filled::No
            })
        };
        let next = Self {
            resolution,
            current: poses.iter().enumerate().map(current).collect(),
            poses,
            rendered: Cell::new(self.rendered.get()),
            first,
            maps,
            sampler: self.sampler.clone(),
        };
        if let Some(before) = before
            && changed.contains(ChangeSet::PLACEMENT)
            && !changed.contains(ChangeSet::SURFACES)
        {
            next.forget_moved(&moved_bounds(&before.geometry, &scene.geometry));
        }
        Ok(Box::new(next))
    }

    fn upload(&self, device: &Device, scene: &Scene) {
        let Some(maps) = &self.maps else { return };
        let origin = Origin(scene.camera.position);
        let views: Vec<ShadowView> = self
            .poses
            .iter()
            .map(|pose| ShadowView {
                clip_from_relative: clip_from_relative(pose, origin.0),
            })
            .collect();
        maps.upload(device, &views);
    }

    fn bind<'a>(&'a self, bindings: &mut Bindings<'a>) {
        if let Some(maps) = &self.maps {
            bindings
                .buffer("shadow_views", &maps.views)
                .texture("shadow_maps", &maps.array)
                .sampler("shadow_sampler", &self.sampler);
        }
    }

    fn settle(&mut self, submitted: bool) {
        for current in &self.current {
            current.set(current.get().settled(submitted));
        }
    }
}

/// Renders the layers that are not current.
#[derive(Debug)]
struct RenderMaps;

impl Pass for RenderMaps {
    fn pipelines(&self, _planned: &PlannedPass, list: &mut PipelineList) {
        list.raster(OPAQUE, &depth_state());
    }

    fn record(
        &self,
        _planned: &PlannedPass,
        recording: &mut Recording<'_>,
        parts: &Parts<'_>,
    ) -> Result<(), RenderError> {
        let Some(shadows) = parts.kept.get::<ShadowMaps>() else {
            return Ok(());
        };
        let Some(maps) = &shadows.maps else {
            return Ok(());
        };
        let geometry = &parts.assets.geometry;
        let (opaque, masked) = (find(OPAQUE)?, find(MASKED)?);
        let draws: Vec<_> = geometry
            .draws
            .iter()
            .map(|draw| RasterDraw {
                shader: match draw.class {
                    DrawClass::Masked if geometry.textures.is_some() => masked,
                    _ => opaque,
                },
                call: draw.call(),
            })
            .collect();
        let state = depth_state();
        for (i, layer) in maps.layers.iter().enumerate() {
            if shadows.current[i].get() != Filled::No {
                continue;
            }
            let mut bindings = Bindings::default();
            bindings.buffer("instances", &parts.inputs.instances);
            maps.bind_pass(i, &mut bindings);
            geometry.bind(&mut bindings);
            recording.raster(
                PASS.name(),
                &RasterPass {
                    state: &state,
                    colors: &[],
                    depth: Some(cleared(layer)),
                    geometry: Some((&geometry.vertices, &geometry.indices)),
                    draws: &draws,
                },
                &bindings,
            )?;
            shadows.current[i].set(Filled::Recorded);
            shadows.rendered.set(shadows.rendered.get() + 1);
        }
        Ok(())
    }
}

/// Permutations of what hides all behind it, and of what has holes.
const OPAQUE: &str = "shadow_map";
const MASKED: &str = "shadow_map+masked";

/// State of the pipelines that draw depths.
pub(crate) fn depth_state() -> RasterState {
    RasterState {
        vertices: Some(&VERTEX_LAYOUT),
        topology: wgpu::PrimitiveTopology::TriangleList,
        colors: Vec::new(),
        depth: Some(DepthTarget {
            // Reversed depth: away from the light is down.
            bias: wgpu::DepthBiasState {
                constant: -4,
                slope_scale: -1.5,
                clamp: 0.0,
            },
        }),
    }
}

/// Boxes around every instance that stands elsewhere, where it was and where it is. Unit: m.
fn moved_bounds(old: &Geometry, new: &Geometry) -> Vec<Aabb> {
    old.instances
        .iter()
        .zip(&new.instances)
        .filter(|(old, new)| old.world_from_object != new.world_from_object)
        .flat_map(|(was, is)| [old.instance_bounds(was), new.instance_bounds(is)])
        .flatten()
        .collect()
}
