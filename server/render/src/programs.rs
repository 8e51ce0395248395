//! Pipelines built on first use, and bind groups filled by the names in the shader.
//!
//! Layouts come from the shader itself and resources are found by the reflected variable names, so
//! no list of binding numbers exists that could drift from the WESL sources.

use std::cell::RefCell;
use std::collections::HashMap;
use std::sync::Arc;

use tyndall_shaders::{Shader, Stage};

use crate::device::Device;
use crate::error::RenderError;

/// Bind groups in the order of their indices.
pub(crate) type Groups = Vec<(u32, wgpu::BindGroup)>;

/// Numbers that pipelines are built for; each shader takes those it declares.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Hash)]
#[allow(
    clippy::struct_excessive_bools,
    reason = "independent facts, not the states of a machine"
)]
pub(crate) struct Constants {
    pub medium_count: u32,
    pub light_count: u32,
    pub emitter_count: u32,
    /// Whether coefficients differ between the channels, in any medium and in grids.
    pub chromatic: bool,
    pub chromatic_grids: bool,
    /// Whether a ray can run into light.
    pub finds_light: bool,
    /// Whether a medium glows.
    pub glows: bool,
    /// Whether every phase function is constant.
    pub isotropic: bool,
    /// Whether some phase function is more than one plain lobe.
    pub mixed_phases: bool,
    /// Side of the tile of pixels that share a ray's strata.
    pub interleave: u32,
    /// Side of the block of pixels of which one is marched.
    pub spacing: u32,
    /// Whether half of the strata are equiangular about the light.
    pub equiangular: bool,
    /// Whether a Gauss rule takes the place of strata.
    pub quadrature: bool,
    /// Whether a ray takes no more strata than it can cross voxels.
    pub by_voxels: bool,
    /// Whether lights that cannot add enough to a ray to be seen are left out of it.
    pub culls: bool,
    /// Whether surfaces stand in the way of area lights.
    pub shadowed: bool,
    /// Whether light arrives from infinity.
    pub sky: bool,
    /// Points of a ray, of each kind, at which area lights are looked at.
    pub area_strata: u32,
}

impl Constants {
    fn value(self, name: &str) -> Option<f64> {
        match name {
            "MEDIUM_COUNT" => Some(f64::from(self.medium_count)),
            "LIGHT_COUNT" => Some(f64::from(self.light_count)),
            "EMITTER_COUNT" => Some(f64::from(self.emitter_count)),
            "CHROMATIC" => Some(f64::from(self.chromatic)),
            "CHROMATIC_GRIDS" => Some(f64::from(self.chromatic_grids)),
            "FINDS_LIGHT" => Some(f64::from(self.finds_light)),
            "GLOWS" => Some(f64::from(self.glows)),
            "ISOTROPIC" => Some(f64::from(self.isotropic)),
            "MIXED_PHASES" => Some(f64::from(self.mixed_phases)),
            "INTERLEAVE" => Some(f64::from(self.interleave)),
            "SPACING" => Some(f64::from(self.spacing)),
            "EQUIANGULAR" => Some(f64::from(self.equiangular)),
            "QUADRATURE" => Some(f64::from(self.quadrature)),
            "BY_VOXELS" => Some(f64::from(self.by_voxels)),
            "CULLS" => Some(f64::from(self.culls)),
            "SHADOWED" => Some(f64::from(self.shadowed)),
            "SKY" => Some(f64::from(self.sky)),
            "AREA_STRATA" => Some(f64::from(self.area_strata)),
            _ => None,
        }
    }

    /// Those that `shader` declares, nothing elsewhere: other values share its pipeline.
    fn of(self, shader: &Shader) -> Self {
        let declares = |name: &str| shader.overrides.iter().any(|o| o.name == name);
        let kept = |value: u32, name: &str| if declares(name) { value } else { 0 };
        Self {
            medium_count: kept(self.medium_count, "MEDIUM_COUNT"),
            light_count: kept(self.light_count, "LIGHT_COUNT"),
            emitter_count: kept(self.emitter_count, "EMITTER_COUNT"),
            chromatic: self.chromatic && declares("CHROMATIC"),
            chromatic_grids: self.chromatic_grids && declares("CHROMATIC_GRIDS"),
            finds_light: self.finds_light && declares("FINDS_LIGHT"),
            glows: self.glows && declares("GLOWS"),
            isotropic: self.isotropic && declares("ISOTROPIC"),
            mixed_phases: self.mixed_phases && declares("MIXED_PHASES"),
            interleave: kept(self.interleave, "INTERLEAVE"),
            spacing: kept(self.spacing, "SPACING"),
            equiangular: self.equiangular && declares("EQUIANGULAR"),
            quadrature: self.quadrature && declares("QUADRATURE"),
            by_voxels: self.by_voxels && declares("BY_VOXELS"),
            culls: self.culls && declares("CULLS"),
            shadowed: self.shadowed && declares("SHADOWED"),
            sky: self.sky && declares("SKY"),
            area_strata: kept(self.area_strata, "AREA_STRATA"),
        }
    }
}

/// Cache of pipelines, by permutation and constants.
#[derive(Debug, Default)]
pub(crate) struct Programs {
    compute: RefCell<HashMap<(&'static str, Constants), Arc<ComputeProgram>>>,
    raster: RefCell<HashMap<String, Arc<RasterProgram>>>,
}

/// A compute pipeline with its shader.
#[derive(Debug)]
pub(crate) struct ComputeProgram {
    pub shader: &'static Shader,
    pipeline: wgpu::ComputePipeline,
}

/// A raster pipeline with its shader.
#[derive(Debug)]
pub(crate) struct RasterProgram {
    pub shader: &'static Shader,
    pipeline: wgpu::RenderPipeline,
}

/// What a raster pipeline draws into.
#[derive(Debug)]
pub(crate) struct RasterTargets<'a> {
    pub colors: &'a [wgpu::TextureFormat],
    pub depth_bias: wgpu::DepthBiasState,
}

/// Resources by the name of the shader's variable.
#[derive(Debug, Default)]
pub(crate) struct Bindings<'a> {
    entries: Vec<(&'static str, wgpu::BindingResource<'a>)>,
}

impl<'a> Bindings<'a> {
    pub fn buffer(&mut self, name: &'static str, buffer: &'a wgpu::Buffer) -> &mut Self {
        self.entries.push((name, buffer.as_entire_binding()));
        self
    }

    pub fn slice(
        &mut self,
        name: &'static str,
        buffer: &'a wgpu::Buffer,
        offset: u64,
        size: std::num::NonZeroU64,
    ) -> &mut Self {
        self.entries.push((
            name,
            wgpu::BindingResource::Buffer(wgpu::BufferBinding {
                buffer,
                offset,
                size: Some(size),
            }),
        ));
        self
    }

    pub fn texture(&mut self, name: &'static str, view: &'a wgpu::TextureView) -> &mut Self {
        self.entries
            .push((name, wgpu::BindingResource::TextureView(view)));
        self
    }

    pub fn sampler(&mut self, name: &'static str, sampler: &'a wgpu::Sampler) -> &mut Self {
        self.entries
            .push((name, wgpu::BindingResource::Sampler(sampler)));
        self
    }

    fn find(&self, name: &str) -> Option<wgpu::BindingResource<'a>> {
        self.entries
            .iter()
            .find(|(known, _)| *known == name)
            .map(|(_, resource)| resource.clone())
    }
}

impl Programs {
    /// The compute pipeline of permutation `name`, built if this is its first use.
    pub fn compute(
        &self,
        device: &Device,
        name: &str,
        constants: Constants,
    ) -> Result<Arc<ComputeProgram>, RenderError> {
        let shader = find(name)?;
        let key = (shader.name, constants.of(shader));
        if let Some(program) = self.compute.borrow().get(&key) {
            return Ok(Arc::clone(program));
        }
        let module = module(device, shader);
        let values: Vec<(&str, f64)> = shader
            .overrides
            .iter()
            .filter_map(|o| Some((o.key, constants.value(o.name)?)))
            .collect();
        let pipeline = device
            .device
            .create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                label: Some(name),
                layout: None,
                module: &module,
                entry_point: Some("main"),
                compilation_options: wgpu::PipelineCompilationOptions {
                    constants: &values,
                    ..Default::default()
                },
                cache: None,
            });
        device.check()?;
        let program = Arc::new(ComputeProgram { shader, pipeline });
        self.compute.borrow_mut().insert(key, Arc::clone(&program));
        Ok(program)
    }

    /// The raster pipeline of permutation `name`, built if this is its first use.
    pub fn raster(
        &self,
        device: &Device,
        name: &str,
        targets: &RasterTargets<'_>,
    ) -> Result<Arc<RasterProgram>, RenderError> {
        if let Some(program) = self.raster.borrow().get(name) {
            return Ok(Arc::clone(program));
        }
        let shader = find(name)?;
        let module = module(device, shader);
        let colors: Vec<_> = targets
            .colors
            .iter()
            .map(|format| Some((*format).into()))
            .collect();
        let has_fragment = shader.has(Stage::Fragment);
        let pipeline = device
            .device
            .create_render_pipeline(&wgpu::RenderPipelineDescriptor {
                label: Some(name),
                layout: None,
                vertex: wgpu::VertexState {
                    module: &module,
                    entry_point: Some("vertex"),
                    compilation_options: wgpu::PipelineCompilationOptions::default(),
                    buffers: &[Some(crate::gpu_scene::VERTEX_LAYOUT)],
                },
                primitive: wgpu::PrimitiveState::default(),
                depth_stencil: Some(wgpu::DepthStencilState {
                    format: wgpu::TextureFormat::Depth32Float,
                    depth_write_enabled: Some(true),
                    // Reversed depth: 1 is near.
                    depth_compare: Some(wgpu::CompareFunction::Greater),
                    stencil: wgpu::StencilState::default(),
                    bias: targets.depth_bias,
                }),
                multisample: wgpu::MultisampleState::default(),
                fragment: has_fragment.then(|| wgpu::FragmentState {
                    module: &module,
                    entry_point: Some("fragment"),
                    compilation_options: wgpu::PipelineCompilationOptions::default(),
                    targets: &colors,
                }),
                multiview_mask: None,
                cache: None,
            });
        device.check()?;
        let program = Arc::new(RasterProgram { shader, pipeline });
        self.raster
            .borrow_mut()
            .insert(name.to_owned(), Arc::clone(&program));
        Ok(program)
    }
}

impl ComputeProgram {
    /// Bind groups with the resources the shader names.
    pub fn bind(&self, device: &Device, bindings: &Bindings<'_>) -> Result<Groups, RenderError> {
        bind(device, self.shader, bindings, |group| {
            self.pipeline.get_bind_group_layout(group)
        })
    }

    /// Makes a pass use this pipeline with `groups`.
    pub fn set(&self, pass: &mut wgpu::ComputePass<'_>, groups: &Groups) {
        pass.set_pipeline(&self.pipeline);
        for (index, group) in groups {
            pass.set_bind_group(*index, group, &[]);
        }
    }

    /// Workgroups that cover `width` × `height` invocations.
    pub fn workgroups(&self, width: u32, height: u32) -> [u32; 2] {
        let [x, y, _] = self.groups([width, height, 1]);
        [x, y]
    }

    /// Workgroups that cover a volume of invocations.
    pub fn groups(&self, size: [u32; 3]) -> [u32; 3] {
        let side = self.shader.workgroup_size();
        std::array::from_fn(|axis| size[axis].div_ceil(side[axis]))
    }
}

impl RasterProgram {
    /// Bind groups with the resources the shader names.
    pub fn bind(&self, device: &Device, bindings: &Bindings<'_>) -> Result<Groups, RenderError> {
        bind(device, self.shader, bindings, |group| {
            self.pipeline.get_bind_group_layout(group)
        })
    }

    /// Makes a pass use this pipeline with `groups`.
    pub fn set(&self, pass: &mut wgpu::RenderPass<'_>, groups: &Groups) {
        pass.set_pipeline(&self.pipeline);
        for (index, group) in groups {
            pass.set_bind_group(*index, group, &[]);
        }
    }
}

fn find(name: &str) -> Result<&'static Shader, RenderError> {
    tyndall_shaders::shader(name).ok_or_else(|| RenderError::Shader {
        shader: name.to_owned(),
        what: "not listed in permutations.txt".into(),
    })
}

fn module(device: &Device, shader: &Shader) -> wgpu::ShaderModule {
    device
        .device
        .create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some(shader.name),
            source: wgpu::ShaderSource::Wgsl(shader.wgsl.into()),
        })
}

fn bind(
    device: &Device,
    shader: &Shader,
    bindings: &Bindings<'_>,
    layout: impl Fn(u32) -> wgpu::BindGroupLayout,
) -> Result<Groups, RenderError> {
    let mut groups = Groups::new();
    for binding in shader.bindings {
        if groups.iter().any(|(group, _)| *group == binding.group) {
            continue;
        }
        let mut entries = Vec::new();
        for member in shader.bindings.iter().filter(|b| b.group == binding.group) {
            let resource = bindings
                .find(member.name)
                .ok_or_else(|| RenderError::Shader {
                    shader: shader.name.to_owned(),
                    what: format!("nothing is bound to {}", member.name),
                })?;
            entries.push(wgpu::BindGroupEntry {
                binding: member.binding,
                resource,
            });
        }
        groups.push((
            binding.group,
            device.device.create_bind_group(&wgpu::BindGroupDescriptor {
                label: Some(shader.name),
                layout: &layout(binding.group),
                entries: &entries,
            }),
        ));
    }
    Ok(groups)
}
