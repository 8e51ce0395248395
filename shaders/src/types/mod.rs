//! Rust mirrors of the structs and constants that shaders share with Rust: same names, same order.
//! A technique has a file of its own.
//!
//! `tests/` compares every field's name and offset and every struct's size with what naga reflects, so
//! that the two cannot drift.

macro_rules! mirrors {
    ($($(#[$meta:meta])* struct $name:ident { $($field:ident: $kind:ty,)* })*) => {
        $(
            $(#[$meta])*
            #[repr(C)]
            #[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
            #[allow(missing_docs, reason = "the fields are documented in wesl/types.wesl")]
            pub struct $name { $(pub $field: $kind,)* }

            impl Default for $name {
                fn default() -> Self {
                    bytemuck::Zeroable::zeroed()
                }
            }
        )*

        /// Layouts of these.
        pub(super) fn layouts() -> Vec<super::Layout> {
            vec![$(super::Layout {
                name: stringify!($name),
                size: size_of::<$name>(),
                fields: vec![$((stringify!($field), std::mem::offset_of!($name, $field)),)*],
            },)*]
        }
    };
}

/// Layout of one mirror.
#[derive(Debug, Clone)]
pub struct Layout {
    /// Name of the struct.
    pub name: &'static str,
    /// Unit: byte.
    pub size: usize,
    /// Field names with offsets in bytes.
    pub fields: Vec<(&'static str, usize)>,
}

mod correction;
mod frame;
mod in_scatter;
mod reference;
mod scene;
mod screen_space;
mod stages;

pub use correction::*;
pub use frame::*;
pub use in_scatter::*;
pub use reference::*;
pub use scene::*;
pub use screen_space::*;
pub use stages::*;

/// Name, size and (field, offset) of every mirror, for the layout test.
pub fn layouts() -> Vec<Layout> {
    [
        correction::layouts(),
        frame::layouts(),
        reference::layouts(),
        scene::layouts(),
        screen_space::layouts(),
        in_scatter::layouts(),
        stages::layouts(),
    ]
    .concat()
}
