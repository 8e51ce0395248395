//! What a raster pass draws, with which state, into what.

use tyndall_shaders::Shader;

/// State that a raster pipeline is built for, beside its shader.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct RasterState {
    /// Vertices that are fetched; `None` where the shader makes them from their numbers.
    pub vertices: Option<&'static wgpu::VertexBufferLayout<'static>>,
    pub topology: wgpu::PrimitiveTopology,
    pub colors: Vec<ColorTarget>,
    pub depth: Option<DepthTarget>,
}

/// A colour attachment's format, and how what is drawn joins what is there.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) struct ColorTarget {
    pub format: wgpu::TextureFormat,
    /// `None` replaces what is there.
    pub blend: Option<wgpu::BlendState>,
}

impl ColorTarget {
    /// What is drawn replaces what is there.
    pub fn replaced(format: wgpu::TextureFormat) -> Self {
        Self {
            format,
            blend: None,
        }
    }

    /// What is drawn is added to what is there.
    pub fn added(format: wgpu::TextureFormat) -> Self {
        let sum = wgpu::BlendComponent {
            src_factor: wgpu::BlendFactor::One,
            dst_factor: wgpu::BlendFactor::One,
            operation: wgpu::BlendOperation::Add,
        };
        Self {
            format,
            blend: Some(wgpu::BlendState {
                color: sum,
                alpha: sum,
            }),
        }
    }
}

/// A depth attachment of 32-bit floats in reversed depth: 1 is near, 0 is nothing there.
#[derive(Debug, Clone, Copy)]
pub(crate) struct DepthTarget {
    pub bias: wgpu::DepthBiasState,
}

impl PartialEq for DepthTarget {
    fn eq(&self, other: &Self) -> bool {
        let bits = |bias: wgpu::DepthBiasState| {
            (
                bias.constant,
                bias.slope_scale.to_bits(),
                bias.clamp.to_bits(),
            )
        };
        bits(self.bias) == bits(other.bias)
    }
}

/// An attachment, and what it holds when the pass begins.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Attachment<'a> {
    pub view: &'a wgpu::TextureView,
    /// Whether what it held before stays; otherwise it begins with zeros.
    pub kept: bool,
}

/// An attachment that begins with zeros.
pub(crate) fn cleared(view: &wgpu::TextureView) -> Attachment<'_> {
    Attachment { view, kept: false }
}

/// An attachment that keeps what it held.
pub(crate) fn kept(view: &wgpu::TextureView) -> Attachment<'_> {
    Attachment { view, kept: true }
}

/// A raster pass.
#[derive(Debug)]
pub(crate) struct RasterPass<'a> {
    pub state: &'a RasterState,
    /// As many as the state's colours.
    pub colors: &'a [Attachment<'a>],
    /// Present where the state has a depth.
    pub depth: Option<Attachment<'a>>,
    /// Vertices and indices of the draws that fetch them.
    pub geometry: Option<(&'a wgpu::Buffer, &'a wgpu::Buffer)>,
    pub draws: &'a [RasterDraw<'a>],
}

/// One draw.
#[derive(Debug)]
pub(crate) struct RasterDraw<'a> {
    pub shader: &'static Shader,
    pub call: DrawCall<'a>,
}

/// What a draw draws.
#[derive(Debug, Clone)]
pub(crate) enum DrawCall<'a> {
    /// Triangles of the pass's geometry.
    Indexed {
        indices: std::ops::Range<u32>,
        base_vertex: i32,
        instances: std::ops::Range<u32>,
    },
    /// Vertices by their numbers alone.
    Vertices {
        vertices: std::ops::Range<u32>,
        instances: std::ops::Range<u32>,
    },
    /// As the four words at the buffer's start say: vertices, instances, first of each.
    Indirect(&'a wgpu::Buffer),
}
