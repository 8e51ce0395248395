//! Depth maps seen from the lights: one for a spot, six for a point, one for a directional light.
//!
//! All are layers of one array. A layer is rendered again only when the resolution or its light's pose
//! changed, or a caster in its frustum moved: a moving camera costs nothing here.
//! Bias: a texel's footprint; slope-scaled depth bias in the map, normal offset at receivers.

use glam::{DVec3, DVec4};
use tyndall_scene::{Aabb, Light};
use tyndall_shaders::types::ShadowView;

use crate::device::Device;
use crate::engine::{Attachments, RasterDraw, Recording};
use crate::error::RenderError;
use crate::gpu_scene::{DrawClass, GpuGeometry, Origin};
use crate::programs::{Bindings, RasterTargets};

/// Bytes of depth maps a view may use: 1 GiB.
const MAX_BYTES: u64 = 1 << 30;
/// Boxes of moved casters that are looked at one by one.
const MAX_BOXES: usize = 1024;
/// Storage buffer offsets are multiples of this.
const STRIDE: u64 = 256;

/// Where a depth map looks from, in the world. Equal poses give equal maps.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Pose {
    position: DVec3,
    right: DVec3,
    up: DVec3,
    forward: DVec3,
    lens: Lens,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Lens {
    /// Half the field of view's tangent; nearest depth.
    Perspective { tan: f64, near: f64 },
    /// Half extents along right, up and forward.
    Orthographic { half: DVec3 },
}

impl Pose {
    /// Whether a box may reach into the frustum: false only if all of it lies outside one of the
    /// planes, by more than the device rounds.
    fn sees(&self, bounds: &Aabb) -> bool {
        let corners = corners(*bounds).map(|corner| {
            let d = corner - self.position;
            DVec3::new(d.dot(self.right), d.dot(self.up), d.dot(self.forward))
        });
        let slack = |c: &DVec3| 1e-5 * c.abs().max_element();
        let reaches =
            |inside: &dyn Fn(&DVec3) -> f64| corners.iter().any(|c| inside(c) >= -slack(c));
        let (x, y, z) = match self.lens {
            Lens::Perspective { tan, near } => {
                return reaches(&|c| c.z - near)
                    && reaches(&|c| tan * c.z - c.x)
                    && reaches(&|c| tan * c.z + c.x)
                    && reaches(&|c| tan * c.z - c.y)
                    && reaches(&|c| tan * c.z + c.y);
            }
            Lens::Orthographic { half } => (half.x, half.y, half.z),
        };
        reaches(&|c| x - c.x)
            && reaches(&|c| x + c.x)
            && reaches(&|c| y - c.y)
            && reaches(&|c| y + c.y)
            && reaches(&|c| z - c.z)
            && reaches(&|c| z + c.z)
    }
}

/// The depth maps of one view.
#[derive(Debug)]
pub(crate) struct ShadowMaps {
    resolution: u32,
    poses: Vec<Pose>,
    /// Whether a layer holds the depths of its pose.
    current: Vec<bool>,
    /// Layers rendered since they were counted last.
    rendered: u32,
    /// First layer of each light.
    first: Vec<Option<u32>>,
    maps: Option<Maps>,
    sampler: wgpu::Sampler,
}

#[derive(Debug)]
struct Maps {
    array: wgpu::TextureView,
    layers: Vec<wgpu::TextureView>,
    /// What the shading passes index: tightly packed.
    views: wgpu::Buffer,
    /// The same for the depth passes, one a binding.
    pass_views: wgpu::Buffer,
}

impl ShadowMaps {
    pub fn new(device: &Device) -> Self {
        Self {
            resolution: 0,
            poses: Vec::new(),
            current: Vec::new(),
            rendered: 0,
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

    /// Fits the maps to the lights; keeps every layer whose pose is unchanged. On an error nothing
    /// changes.
    pub fn update(
        &mut self,
        device: &Device,
        lights: &[Light],
        casters: Option<Aabb>,
        resolution: u32,
    ) -> Result<(), RenderError> {
        let mut poses = Vec::new();
        let first = lights
            .iter()
            .map(|light| {
                let bounds = casters.filter(|_| light.casts_shadows() && light.is_lit())?;
                let first = poses.len() as u32;
                poses.extend(poses_of(light, bounds, resolution));
                Some(first)
            })
            .collect();
        if poses.len() != self.poses.len() || resolution != self.resolution {
            self.maps = if poses.is_empty() {
                None
            } else {
                Some(Maps::new(device, resolution, poses.len() as u32)?)
            };
            self.current = vec![false; poses.len()];
        } else {
            for (i, pose) in poses.iter().enumerate() {
                self.current[i] &= *pose == self.poses[i];
            }
        }
        self.first = first;
        self.resolution = resolution;
        self.poses = poses;
        Ok(())
    }

    /// Forgets every depth: the casters changed.
    pub fn invalidate(&mut self) {
        self.current.fill(false);
    }

    /// Forgets the depths of layers that see a caster which moved; `boxes` are around each where it was
    /// and where it is. Unit: m.
    pub fn casters_moved(&mut self, boxes: &[Aabb]) {
        let joined = boxes.iter().copied().reduce(|a, b| Aabb {
            min: a.min.min(b.min),
            max: a.max.max(b.max),
        });
        let Some(joined) = joined else { return };
        for (pose, current) in self.poses.iter().zip(&mut self.current) {
            // So many boxes are not told apart: that would cost more than the depths.
            let seen = || boxes.len() > MAX_BOXES || boxes.iter().any(|b| pose.sees(b));
            *current &= !(pose.sees(&joined) && seen());
        }
    }

    /// How many layers were rendered since the last call.
    pub fn take_rendered(&mut self) -> u32 {
        std::mem::take(&mut self.rendered)
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

    /// Uploads the maps' transforms relative to `origin`.
    pub fn upload(&self, device: &Device, origin: Origin) {
        let Some(maps) = &self.maps else { return };
        let views: Vec<ShadowView> = self
            .poses
            .iter()
            .map(|pose| ShadowView {
                clip_from_relative: clip_from_relative(pose, origin.0),
            })
            .collect();
        device
            .queue
            .write_buffer(&maps.views, 0, bytemuck::cast_slice(&views));
        for (i, view) in views.iter().enumerate() {
            device.queue.write_buffer(
                &maps.pass_views,
                i as u64 * STRIDE,
                bytemuck::bytes_of(view),
            );
        }
    }

    /// Adds what the shading passes read.
    pub fn bind<'a>(&'a self, bindings: &mut Bindings<'a>) {
        if let Some(maps) = &self.maps {
            bindings
                .buffer("shadow_views", &maps.views)
                .texture("shadow_maps", &maps.array)
                .sampler("shadow_sampler", &self.sampler);
        }
    }

    /// Renders the layers that are not current.
    pub fn record(
        &mut self,
        recording: &mut Recording<'_>,
        geometry: &GpuGeometry,
        instances: &wgpu::Buffer,
    ) -> Result<(), RenderError> {
        let Some(maps) = &self.maps else {
            return Ok(());
        };
        let draws: Vec<_> = geometry
            .draws
            .iter()
            .map(|draw| RasterDraw {
                variant: match draw.class {
                    DrawClass::Masked if geometry.textures.is_some() => {
                        "shadow_map+masked".to_owned()
                    }
                    _ => "shadow_map".to_owned(),
                },
                draw,
            })
            .collect();
        let size = std::num::NonZeroU64::new(size_of::<ShadowView>() as u64)
            .unwrap_or(std::num::NonZeroU64::MIN);
        for (i, layer) in maps.layers.iter().enumerate() {
            if self.current[i] {
                continue;
            }
            let mut bindings = Bindings::default();
            bindings.buffer("instances", instances).slice(
                "shadow_view",
                &maps.pass_views,
                i as u64 * STRIDE,
                size,
            );
            geometry.bind(&mut bindings);
            recording.raster(
                "shadow_maps",
                &Attachments {
                    colors: &[],
                    depth: layer,
                },
                &RasterTargets {
                    colors: &[],
                    // Reversed depth: away from the light is down.
                    depth_bias: wgpu::DepthBiasState {
                        constant: -4,
                        slope_scale: -1.5,
                        clamp: 0.0,
                    },
                },
                geometry,
                &bindings,
                &draws,
            )?;
            self.current[i] = true;
            self.rendered += 1;
        }
        Ok(())
    }
}

impl Maps {
    fn new(device: &Device, resolution: u32, layers: u32) -> Result<Self, RenderError> {
        let limits = device.device.limits();
        let bytes = u64::from(layers) * u64::from(resolution) * u64::from(resolution) * 4;
        for (what, needed, allowed) in [
            (
                "shadow map layers",
                u64::from(layers),
                u64::from(limits.max_texture_array_layers),
            ),
            (
                "shadow map texels a side",
                resolution.into(),
                limits.max_texture_dimension_2d.into(),
            ),
            ("bytes of shadow maps", bytes, MAX_BYTES),
        ] {
            if needed > allowed {
                return Err(RenderError::TooLarge {
                    what,
                    needed,
                    allowed,
                });
            }
        }
        let texture = device.device.create_texture(&wgpu::TextureDescriptor {
            label: Some("shadow_maps"),
            size: wgpu::Extent3d {
                width: resolution,
                height: resolution,
                depth_or_array_layers: layers,
            },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: wgpu::TextureFormat::Depth32Float,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING,
            view_formats: &[],
        });
        let buffer = |label: &str, size: u64| {
            device.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(label),
                size,
                usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            })
        };
        Ok(Self {
            array: texture.create_view(&wgpu::TextureViewDescriptor {
                dimension: Some(wgpu::TextureViewDimension::D2Array),
                ..Default::default()
            }),
            layers: (0..layers)
                .map(|layer| {
                    texture.create_view(&wgpu::TextureViewDescriptor {
                        dimension: Some(wgpu::TextureViewDimension::D2),
                        base_array_layer: layer,
                        array_layer_count: Some(1),
                        ..Default::default()
                    })
                })
                .collect(),
            views: buffer(
                "shadow_views",
                u64::from(layers) * size_of::<ShadowView>() as u64,
            ),
            pass_views: buffer("shadow_views.passes", u64::from(layers) * STRIDE),
        })
    }
}

fn poses_of(light: &Light, casters: Aabb, resolution: u32) -> Vec<Pose> {
    // Half a texel of border on either side, for the filter's footprint.
    let border = 1.0 + 2.0 / f64::from(resolution);
    match light {
        Light::Point(light) => {
            let faces = [
                DVec3::X,
                DVec3::NEG_X,
                DVec3::Y,
                DVec3::NEG_Y,
                DVec3::Z,
                DVec3::NEG_Z,
            ];
            let lens = Lens::Perspective {
                tan: border,
                near: nearest(light.radius),
            };
            faces
                .map(|forward| pose(light.position, forward, lens))
                .to_vec()
        }
        Light::Spot(light) => {
            let lens = Lens::Perspective {
                // Beyond 85° a perspective map degenerates; such spots are lit to the map's edge.
                tan: f64::from(light.outer_angle).min(85_f64.to_radians()).tan() * border,
                near: nearest(light.radius),
            };
            vec![pose(light.position, light.direction.as_dvec3(), lens)]
        }
        Light::Directional(light) => {
            let placeholder = Lens::Orthographic { half: DVec3::ONE };
            let mut fitted = pose(DVec3::ZERO, light.direction.as_dvec3(), placeholder);
            let (mut low, mut high) = (DVec3::MAX, DVec3::MIN);
            for corner in corners(casters) {
                let p = DVec3::new(
                    corner.dot(fitted.right),
                    corner.dot(fitted.up),
                    corner.dot(fitted.forward),
                );
                low = low.min(p);
                high = high.max(p);
            }
            let middle = 0.5 * (low + high);
            fitted.position =
                fitted.right * middle.x + fitted.up * middle.y + fitted.forward * middle.z;
            let half = (0.5 * (high - low)).max(DVec3::splat(1e-6));
            fitted.lens = Lens::Orthographic {
                half: DVec3::new(half.x * border, half.y * border, half.z * 1.01),
            };
            vec![fitted]
        }
    }
}

/// Casters nearer than this to a light are inside its source.
fn nearest(radius: f32) -> f64 {
    f64::from(radius).clamp(1e-3, 0.05)
}

fn pose(position: DVec3, forward: DVec3, lens: Lens) -> Pose {
    let helper = if forward.y.abs() < 0.9 {
        DVec3::Y
    } else {
        DVec3::X
    };
    let right = forward.cross(helper).normalize_or(DVec3::X);
    Pose {
        position,
        right,
        up: right.cross(forward),
        forward,
        lens,
    }
}

fn corners(bounds: Aabb) -> [DVec3; 8] {
    std::array::from_fn(|i| {
        DVec3::new(
            if i & 1 == 0 {
                bounds.min.x
            } else {
                bounds.max.x
            },
            if i & 2 == 0 {
                bounds.min.y
            } else {
                bounds.max.y
            },
            if i & 4 == 0 {
                bounds.min.z
            } else {
                bounds.max.z
            },
        )
    })
}

/// Clip transform of camera-relative points, composed in f64.
fn clip_from_relative(pose: &Pose, origin: DVec3) -> [[f32; 4]; 4] {
    let offset = origin - pose.position;
    let axis = |direction: DVec3, scale: f64, shift: f64| {
        let d = direction * scale;
        DVec4::new(d.x, d.y, d.z, d.dot(offset) + shift)
    };
    let rows = match pose.lens {
        Lens::Perspective { tan, near } => [
            axis(pose.right, 1.0 / tan, 0.0),
            axis(pose.up, 1.0 / tan, 0.0),
            DVec4::new(0.0, 0.0, 0.0, near),
            axis(pose.forward, 1.0, 0.0),
        ],
        Lens::Orthographic { half } => [
            axis(pose.right, 1.0 / half.x, 0.0),
            axis(pose.up, 1.0 / half.y, 0.0),
            axis(pose.forward, -0.5 / half.z, 0.5),
            DVec4::W,
        ],
    };
    columns(rows)
}

/// Column-major f32 matrix of four rows.
pub(crate) fn columns(rows: [DVec4; 4]) -> [[f32; 4]; 4] {
    std::array::from_fn(|column| std::array::from_fn(|row| rows[row][column] as f32))
}
