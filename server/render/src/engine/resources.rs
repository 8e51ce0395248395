//! Textures and buffers as passes declare them, before any is made.

/// A texture or buffer of a view that some pass writes.
///
/// Declared once, by whoever writes it; passes name it in their [`Access`]es, and the
/// [`Pool`](super::Pool) makes what the passes of a plan name.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ResourceSpec {
    /// Unique; also the variable that reads it, where an access names no other.
    pub name: &'static str,
    pub shape: Shape,
    pub life: Life,
    /// Name of what it held before the last swap: two allocations then take turns.
    pub previous: Option<&'static str>,
}

/// What kind of memory a resource is.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Shape {
    Texture {
        format: wgpu::TextureFormat,
        extent: Extent,
        /// Levels; 0 stands for all down to one texel.
        mips: u32,
    },
    Buffer(Bytes),
}

/// Size of a texture.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Extent {
    /// The picture's sides over a divisor, rounded up.
    Picture { divisor: u32 },
    /// Texels along x, y and z, whatever the picture's size.
    Volume([u32; 3]),
}

/// Size of a buffer. Unit: byte.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Bytes {
    /// For each pixel.
    PerPixel(u64),
    /// For each tile of pixels of this side; tiles at the edges are whole.
    PerTile { side: u32, bytes: u64 },
    /// By the picture's width and height.
    OfPicture(fn([u32; 2]) -> u64),
    /// Whatever the picture's size.
    Fixed(u64),
}

/// How long what a resource holds counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Life {
    /// Until the frame ends: every frame that reads it writes it first. Passes and views share its
    /// memory with others.
    Frame,
    /// From frame to frame.
    View,
}

impl ResourceSpec {
    /// A texture of the picture's size that lives for a frame.
    pub const fn texture(name: &'static str, format: wgpu::TextureFormat) -> Self {
        Self {
            name,
            shape: Shape::Texture {
                format,
                extent: Extent::Picture { divisor: 1 },
                mips: 1,
            },
            life: Life::Frame,
            previous: None,
        }
    }

    /// A buffer that lives for a frame.
    pub const fn buffer(name: &'static str, bytes: Bytes) -> Self {
        Self {
            name,
            shape: Shape::Buffer(bytes),
            life: Life::Frame,
            previous: None,
        }
    }

    /// The same, kept from frame to frame.
    pub const fn kept(mut self) -> Self {
        self.life = Life::View;
        self
    }

    /// The same, whose last state but one is `previous`.
    pub const fn with_previous(mut self, previous: &'static str) -> Self {
        self.life = Life::View;
        self.previous = Some(previous);
        self
    }

    /// The same texture at another size.
    pub const fn sized(mut self, extent: Extent) -> Self {
        if let Shape::Texture { format, mips, .. } = self.shape {
            self.shape = Shape::Texture {
                format,
                extent,
                mips,
            };
        }
        self
    }

    /// The same texture with so many levels.
    #[cfg(feature = "probe")]
    pub const fn with_mips(mut self, mips: u32) -> Self {
        if let Shape::Texture { format, extent, .. } = self.shape {
            self.shape = Shape::Texture {
                format,
                extent,
                mips,
            };
        }
        self
    }

    /// A pass reads it, by its name.
    pub const fn read(self) -> Access {
        self.access(self.name, AccessKind::Read)
    }

    /// A pass reads it as `variable`.
    pub const fn read_as(self, variable: &'static str) -> Access {
        self.access(variable, AccessKind::Read)
    }

    /// A pass reads it, by its name, but only in frames that also write it.
    pub const fn read_when_written(self) -> Access {
        self.access(self.name, AccessKind::ReadWhenWritten)
    }

    /// A pass writes it, by its name.
    pub const fn written(self) -> Access {
        self.access(self.name, AccessKind::Write)
    }

    /// A pass writes it as `variable`.
    pub const fn written_as(self, variable: &'static str) -> Access {
        self.access(variable, AccessKind::Write)
    }

    /// A pass draws into it.
    pub const fn drawn(self) -> Access {
        self.access(self.name, AccessKind::Attachment)
    }

    /// A dispatch takes its number of groups from it, and reads it by its name.
    pub const fn counted(self) -> Access {
        self.access(self.name, AccessKind::Counts)
    }

    const fn access(self, variable: &'static str, kind: AccessKind) -> Access {
        Access {
            resource: self,
            variable,
            kind,
        }
    }
}

/// What a pass does with a resource.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Access {
    pub resource: ResourceSpec,
    /// Name of the shader's variable.
    pub variable: &'static str,
    pub kind: AccessKind,
}

/// How a resource is accessed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum AccessKind {
    Read,
    /// In frames in which another pass writes it; others leave it alone.
    ReadWhenWritten,
    /// As storage, whether or not it is also read.
    Write,
    Attachment,
    /// As the arguments of an indirect dispatch, and read.
    Counts,
}

impl AccessKind {
    /// Whether the resource holds something new afterwards.
    pub fn writes(self) -> bool {
        matches!(self, Self::Write | Self::Attachment)
    }
}

impl Bytes {
    /// For a picture of this size. Rounded up to 16, since a binding of vectors must hold whole ones.
    pub fn of(self, [width, height]: [u32; 2]) -> u64 {
        let bytes = match self {
            Self::PerPixel(bytes) => u64::from(width) * u64::from(height) * bytes,
            Self::PerTile { side, bytes } => {
                u64::from(width.div_ceil(side)) * u64::from(height.div_ceil(side)) * bytes
            }
            Self::OfPicture(bytes) => bytes([width, height]),
            Self::Fixed(bytes) => bytes,
        };
        bytes.max(16).next_multiple_of(16)
    }
}

impl Extent {
    /// Texels for a picture of this size.
    pub fn of(self, [width, height]: [u32; 2]) -> wgpu::Extent3d {
        match self {
            Self::Picture { divisor } => wgpu::Extent3d {
                width: width.div_ceil(divisor),
                height: height.div_ceil(divisor),
                depth_or_array_layers: 1,
            },
            Self::Volume([width, height, depth_or_array_layers]) => wgpu::Extent3d {
                width,
                height,
                depth_or_array_layers,
            },
        }
    }
}
