//! Resources by the name of the shader's variable.

/// What may be bound to a shader; each takes those it declares.
#[derive(Debug, Clone, Default)]
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

    /// What is bound to `name`.
    pub fn find(&self, name: &str) -> Option<wgpu::BindingResource<'a>> {
        self.entries
            .iter()
            .find(|(known, _)| *known == name)
            .map(|(_, resource)| resource.clone())
    }
}
