//! How large a grid may be before it is refused.

/// Upper bounds on what reading one grid may hold. Checked before anything is allocated.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct VolumeLimits {
    /// The file. Unit: byte.
    pub file_bytes: u64,
    /// Bricks and their table. Unit: byte.
    pub grid_bytes: u64,
}

impl Default for VolumeLimits {
    fn default() -> Self {
        Self {
            file_bytes: 4 << 30,
            grid_bytes: 4 << 30,
        }
    }
}
