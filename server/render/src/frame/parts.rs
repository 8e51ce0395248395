//! What the passes of a frame use of their view.

use super::kept::KeptStates;
use crate::engine::{Access, AccessKind, Bindings, Constants, ResourceSpec, ViewResources};
use crate::error::RenderError;
use crate::gpu_scene::{GpuAssets, Inputs};
use crate::picture::Share;

/// What the passes of a frame use of their view.
#[derive(Debug)]
pub(crate) struct Parts<'a> {
    pub assets: &'a GpuAssets,
    pub inputs: &'a Inputs,
    pub resources: &'a ViewResources,
    pub kept: &'a KeptStates,
    /// That follow from the scene; a pass adds its own.
    pub constants: &'a Constants,
    pub share: Share,
}

impl<'a> Parts<'a> {
    /// Width and height of the picture. Unit: pixel.
    pub fn size(&self) -> [u32; 2] {
        self.resources.size
    }

    /// A buffer that a pass declares, for what is not a binding.
    pub fn buffer(&self, spec: &ResourceSpec) -> Result<&'a wgpu::Buffer, RenderError> {
        let found = self.resources.buffer(spec.name);
        found.ok_or_else(|| RenderError::Shader {
            shader: spec.name.to_owned(),
            what: "no pass of the plan declares it".into(),
        })
    }

    /// Everything that the shaders of a pass may name: the scene, what is kept, and the resources that it
    /// declares.
    pub fn bind(&self, accesses: &[Access]) -> Result<Bindings<'a>, RenderError> {
        let mut bindings = Bindings::default();
        for access in accesses {
            let name = access.resource.name;
            let level = (access.kind == AccessKind::Write)
                .then(|| self.resources.level(name, 0))
                .flatten();
            if let Some(buffer) = self.resources.buffer(name) {
                bindings.buffer(access.variable, buffer);
                if let Some(previous) = access.resource.previous
                    && let Some(buffer) = self.resources.buffer(previous)
                {
                    bindings.buffer(previous, buffer);
                }
            } else if let Some(view) = level.or_else(|| self.resources.texture(name)) {
                bindings.texture(access.variable, view);
            } else {
                return Err(RenderError::Shader {
                    shader: access.variable.to_owned(),
                    what: format!("no resource is called {name}"),
                });
            }
        }
        self.inputs.bind(&mut bindings);
        self.kept.bind(&mut bindings);
        self.assets.bind(&mut bindings);
        Ok(bindings)
    }
}
