//! Pipelines built on first use, and bind groups filled by the names in the shader.
//!
//! Layouts come from the shader itself and resources are found by the reflected variable names, so
//! no list of binding numbers exists that could drift from the WESL sources. A pipeline is built
//! outside the lock, so any thread may build one while another records.

use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use tyndall_shaders::{Shader, Stage};

use super::bindings::Bindings;
use super::constants::Constants;
use super::device::Device;
use super::raster::RasterState;
use crate::error::RenderError;

/// Pipelines that are kept; beyond, the one that was used longest ago goes. A view needs about twenty.
const MOST_KEPT: usize = 256;

/// Bind groups in the order of their indices.
pub(crate) type Groups = Vec<(u32, wgpu::BindGroup)>;

/// Cache of pipelines: by permutation and the constants that its shader declares, or its raster state.
#[derive(Debug, Default)]
pub(crate) struct Pipelines {
    kept: Mutex<Vec<Kept>>,
    /// Counts the uses.
    clock: AtomicU64,
}

#[derive(Debug)]
struct Kept {
    key: Key,
    used: u64,
    program: Program,
}

#[derive(Debug, Clone, PartialEq)]
struct Key {
    shader: &'static str,
    constants: Vec<(&'static str, u32)>,
    raster: Option<RasterState>,
}

#[derive(Debug, Clone)]
enum Program {
    Compute(Arc<ComputeProgram>),
    Raster(Arc<RasterProgram>),
}

/// A compute pipeline with its shader.
#[derive(Debug)]
pub(crate) struct ComputeProgram {
    shader: &'static Shader,
    pipeline: wgpu::ComputePipeline,
}

/// A raster pipeline with its shader.
#[derive(Debug)]
pub(crate) struct RasterProgram {
    shader: &'static Shader,
    pipeline: wgpu::RenderPipeline,
}

impl Pipelines {
    /// The compute pipeline of permutation `name`, built if this is its first use.
    pub fn compute(
        &self,
        device: &Device,
        name: &str,
        constants: &Constants,
    ) -> Result<Arc<ComputeProgram>, RenderError> {
        self.compute_of(device, find(name)?, constants)
    }

    /// The compute pipeline of `shader`, built if this is its first use.
    pub fn compute_of(
        &self,
        device: &Device,
        shader: &'static Shader,
        constants: &Constants,
    ) -> Result<Arc<ComputeProgram>, RenderError> {
        let key = Key {
            shader: shader.name,
            constants: constants.of(shader),
            raster: None,
        };
        if let Some(Program::Compute(program)) = self.find(&key) {
            return Ok(program);
        }
        let values: Vec<(&str, f64)> = key
            .constants
            .iter()
            .map(|(name, value)| (*name, f64::from(*value)))
            .collect();
        let pipeline = device
            .device
            .create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                label: Some(shader.name),
                layout: None,
                module: &module(device, shader),
                entry_point: Some("main"),
                compilation_options: wgpu::PipelineCompilationOptions {
                    constants: &values,
                    ..Default::default()
                },
                cache: None,
            });
        device.check()?;
        let program = Arc::new(ComputeProgram { shader, pipeline });
        self.keep(key, Program::Compute(Arc::clone(&program)));
        Ok(program)
    }

    /// The raster pipeline of permutation `name` for `state`, built if this is its first use.
    pub fn raster(
        &self,
        device: &Device,
        name: &str,
        state: &RasterState,
    ) -> Result<Arc<RasterProgram>, RenderError> {
        self.raster_of(device, find(name)?, state)
    }

    /// The raster pipeline of `shader` for `state`, built if this is its first use.
    pub fn raster_of(
        &self,
        device: &Device,
        shader: &'static Shader,
        state: &RasterState,
    ) -> Result<Arc<RasterProgram>, RenderError> {
        let key = Key {
            shader: shader.name,
            constants: Vec::new(),
            raster: Some(state.clone()),
        };
        if let Some(Program::Raster(program)) = self.find(&key) {
            return Ok(program);
        }
        let program = Arc::new(RasterProgram {
            shader,
            pipeline: raster_pipeline(device, shader, state),
        });
        device.check()?;
        self.keep(key, Program::Raster(Arc::clone(&program)));
        Ok(program)
    }

    /// Whether the compute pipeline of permutation `name` is built.
    pub fn has_compute(&self, name: &str, constants: &Constants) -> bool {
        find(name).is_ok_and(|shader| self.has(shader, constants.of(shader), None))
    }

    /// Whether the raster pipeline of permutation `name` is built for `state`.
    pub fn has_raster(&self, name: &str, state: &RasterState) -> bool {
        find(name).is_ok_and(|shader| self.has(shader, Vec::new(), Some(state.clone())))
    }

    fn has(
        &self,
        shader: &'static Shader,
        constants: Vec<(&'static str, u32)>,
        raster: Option<RasterState>,
    ) -> bool {
        let key = Key {
            shader: shader.name,
            constants,
            raster,
        };
        self.find(&key).is_some()
    }

    fn lock(&self) -> MutexGuard<'_, Vec<Kept>> {
        // Whoever panicked left whole entries behind.
        self.kept.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn find(&self, key: &Key) -> Option<Program> {
        let now = self.clock.fetch_add(1, Ordering::Relaxed);
        let mut kept = self.lock();
        let found = kept.iter_mut().find(|kept| kept.key == *key)?;
        found.used = now;
        Some(found.program.clone())
    }

    fn keep(&self, key: Key, program: Program) {
        let used = self.clock.fetch_add(1, Ordering::Relaxed);
        let mut kept = self.lock();
        // Two threads may have built it at once: either serves.
        if !kept.iter().any(|known| known.key == key) {
            kept.push(Kept { key, used, program });
        }
        if kept.len() > MOST_KEPT
            && let Some(oldest) = (0..kept.len()).min_by_key(|i| kept[*i].used)
        {
            kept.swap_remove(oldest);
        }
    }
}

fn raster_pipeline(
    device: &Device,
    shader: &'static Shader,
    state: &RasterState,
) -> wgpu::RenderPipeline {
    let module = module(device, shader);
    let colors: Vec<_> = state
        .colors
        .iter()
        .map(|target| {
            Some(wgpu::ColorTargetState {
                format: target.format,
                blend: target.blend,
                write_mask: wgpu::ColorWrites::ALL,
            })
        })
        .collect();
    let buffers: Vec<_> = state
        .vertices
        .iter()
        .map(|layout| Some((*layout).clone()))
        .collect();
    device
        .device
        .create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some(shader.name),
            layout: None,
            vertex: wgpu::VertexState {
                module: &module,
                entry_point: Some("vertex"),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                buffers: &buffers,
            },
            primitive: wgpu::PrimitiveState {
                topology: state.topology,
                ..Default::default()
            },
            depth_stencil: state.depth.map(|depth| wgpu::DepthStencilState {
                format: wgpu::TextureFormat::Depth32Float,
                depth_write_enabled: Some(true),
                // Reversed depth: 1 is near.
                depth_compare: Some(wgpu::CompareFunction::Greater),
                stencil: wgpu::StencilState::default(),
                bias: depth.bias,
            }),
            multisample: wgpu::MultisampleState::default(),
            fragment: shader.has(Stage::Fragment).then(|| wgpu::FragmentState {
                module: &module,
                entry_point: Some("fragment"),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                targets: &colors,
            }),
            multiview_mask: None,
            cache: None,
        })
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

    /// Invocations of one workgroup.
    pub fn invocations(&self) -> u32 {
        self.shader.workgroup_size().iter().product()
    }

    /// Workgroups that cover so many invocations along each axis.
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

/// The product's shader that its list calls `name`.
pub(crate) fn find(name: &str) -> Result<&'static Shader, RenderError> {
    tyndall_shaders::shader(name).ok_or_else(|| RenderError::Shader {
        shader: name.to_owned(),
        what: "in no permutations.txt".into(),
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

#[cfg(all(test, feature = "noop"))]
mod tests {
    use super::*;

    #[test]
    fn pipelines_that_were_used_longest_ago_make_room() {
        let device = Device::noop().expect("a device that executes nothing");
        let pipelines = Pipelines::default();
        let constants = |i: u32| Constants::default().number("INTERLEAVE", i);
        let build = |i| pipelines.compute(&device, "gather+rows", &constants(i));
        for i in 0..MOST_KEPT as u32 + 20 {
            build(i).expect("built");
            // In use all the time.
            build(0).expect("kept");
        }
        assert_eq!(pipelines.lock().len(), MOST_KEPT);
        assert!(pipelines.has_compute("gather+rows", &constants(0)));
        assert!(!pipelines.has_compute("gather+rows", &constants(1)));
        assert!(pipelines.has_compute("gather+rows", &constants(MOST_KEPT as u32)));
    }
}
