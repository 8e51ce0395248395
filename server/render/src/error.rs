//! What can go wrong with a device or a frame.

/// Why no device could be opened.
#[derive(Debug, thiserror::Error)]
pub enum DeviceError {
    /// The Vulkan loader or every driver is missing.
    #[error(
        "no Vulkan driver found: install one (a GPU vendor's, or Mesa's software driver: apt install libvulkan1 mesa-vulkan-drivers)"
    )]
    NoAdapter,
    /// `--adapter` matched nothing.
    #[error("no adapter is called {wanted:?}; found: {found}")]
    NoSuchAdapter {
        /// What was asked for.
        wanted: String,
        /// Names of the adapters there are.
        found: String,
    },
    /// `--require-gpu` with software drivers only.
    #[error("a GPU is required but only software adapters were found: {found}")]
    NoGpu {
        /// Names of the adapters there are.
        found: String,
    },
    /// The driver refused to make a device.
    #[error("adapter {adapter:?} gave no device: {source}")]
    Refused {
        /// Name of the adapter.
        adapter: String,
        /// The driver's reason.
        source: wgpu::RequestDeviceError,
    },
    /// The start-up self-test found wrong results.
    #[error("adapter {adapter:?} computes wrong results: {what}")]
    SelfTest {
        /// Name of the adapter.
        adapter: String,
        /// What was wrong.
        what: String,
    },
}

/// Why a frame was not rendered.
#[derive(Debug, thiserror::Error)]
pub enum RenderError {
    /// The device is gone; make a new one.
    #[error("the device was lost: {0}")]
    DeviceLost(String),
    /// The driver or wgpu's validation refused a command.
    #[error("the device refused a command: {0}")]
    Refused(String),
    /// The picture is larger than the device allows.
    #[error(
        "picture of {width}×{height} pixels: allowed are 1×1 to {max_pixels} pixels and {max_side} a side"
    )]
    Size {
        /// Asked for.
        width: u32,
        /// Asked for.
        height: u32,
        /// Device limit.
        max_pixels: u64,
        /// Device limit.
        max_side: u32,
    },
    /// The scene needs more of something than the device has.
    #[error("scene needs {needed} {what}, the device allows {allowed}")]
    TooLarge {
        /// What there is too much of.
        what: &'static str,
        /// Needed amount.
        needed: u64,
        /// Allowed amount.
        allowed: u64,
    },
    /// The picture needs more memory than it may have.
    #[error("the picture needs {needed} bytes of device memory, allowed are {allowed}")]
    Memory {
        /// Unit: byte.
        needed: u64,
        /// Unit: byte.
        allowed: u64,
    },
    /// A frame was rendered and could not be read.
    #[error(transparent)]
    FailedFrame(#[from] FailedFrame),
    /// The scene uses something that is not rendered yet.
    #[error(transparent)]
    NotRenderedYet(#[from] NotRenderedYet),
    /// A shader or one of its bindings is missing: a mistake in the program.
    #[error("shader {shader}: {what}")]
    Shader {
        /// Name in its `permutations.txt`.
        shader: String,
        /// What is missing.
        what: String,
    },
    /// No result within the time allowed.
    #[error("the device did not answer within {seconds} s")]
    Timeout {
        /// How long was waited.
        seconds: u64,
    },
}

/// A frame that was rendered and whose picture could not be read.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("a frame could not be read back: {reason}")]
pub struct FailedFrame {
    /// What the caller passed to `render`.
    pub tag: u64,
    /// What went wrong.
    pub reason: String,
}

/// The fields of a scene that are valid but not rendered yet.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("not rendered yet: {}", fields.join("; "))]
pub struct NotRenderedYet {
    /// JSON paths with a remark each.
    pub fields: Vec<String>,
}

impl NotRenderedYet {
    /// A technique that is not rendered yet.
    pub(crate) fn technique(technique: tyndall_scene::Technique) -> Self {
        Self {
            fields: vec![format!("render.technique: {}", technique.name())],
        }
    }
}
