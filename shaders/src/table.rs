//! The linked shaders with what was reflected from them.

/// One linked, validated shader.
#[derive(Debug, Clone, Copy)]
pub struct Shader {
    /// Name in its `permutations.txt`.
    pub name: &'static str,
    /// Plain WGSL.
    pub wgsl: &'static str,
    /// Its entry points.
    pub entry_points: &'static [EntryPoint],
    /// Its bindings, by group and number.
    pub bindings: &'static [Binding],
    /// Its pipeline-overridable constants.
    pub overrides: &'static [Override],
}

/// A constant that is given when a pipeline is built.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Override {
    /// Name in WESL.
    pub name: &'static str,
    /// `@id`, as WebGPU takes it.
    pub key: &'static str,
}

/// An entry point of a shader.
#[derive(Debug, Clone, Copy)]
pub struct EntryPoint {
    /// Function name.
    pub name: &'static str,
    /// Pipeline stage.
    pub stage: Stage,
    /// Invocations along x, y, z; zeros outside compute.
    pub workgroup_size: [u32; 3],
}

/// Pipeline stage of an entry point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[allow(missing_docs, reason = "the names are WebGPU's")]
#[allow(dead_code, reason = "the generated table names only the stages in use")]
pub enum Stage {
    Vertex,
    Fragment,
    Compute,
}

/// A resource binding of a shader.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Binding {
    /// Bind group.
    pub group: u32,
    /// Number in the group.
    pub binding: u32,
    /// Name of the variable in WESL.
    pub name: &'static str,
}

impl Shader {
    /// Workgroup size of the compute entry point `main`; ones where there is none.
    pub fn workgroup_size(&self) -> [u32; 3] {
        self.entry_points
            .iter()
            .find(|entry| entry.stage == Stage::Compute)
            .map_or([1; 3], |entry| entry.workgroup_size)
    }

    /// Whether the shader has an entry point for `stage`.
    pub fn has(&self, stage: Stage) -> bool {
        self.entry_points.iter().any(|entry| entry.stage == stage)
    }
}

static SHADERS: &[Shader] = include!(concat!(env!("OUT_DIR"), "/table.rs"));

/// Every shader, in the order of the lists.
pub fn all() -> &'static [Shader] {
    SHADERS
}

/// The shader that its list calls `name`.
pub fn shader(name: &str) -> Option<&'static Shader> {
    SHADERS.iter().find(|shader| shader.name == name)
}
