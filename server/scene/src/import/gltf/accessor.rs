//! Typed elements of buffer views: strided, integer or float, normalized, sparse. All ranges are
//! checked when an accessor is opened, so that reading an element can't fail.

use gltf::json::accessor::{ComponentType, Type};
use gltf::json::validation::Checked;

use super::document::Document;
use crate::error::SceneError;

/// An accessor whose ranges have been checked.
#[derive(Debug)]
pub(super) struct Accessor<'a> {
    /// `None` stands for zeros.
    bytes: Option<&'a [u8]>,
    stride: usize,
    count: usize,
    component: ComponentType,
    components: usize,
    normalized: bool,
    sparse: Option<Replaced<'a>>,
}

/// Replaced elements of a sparse accessor: their indices in order, and their packed values.
type Replaced<'a> = (Vec<u32>, &'a [u8]);

impl<'a> Document<'a> {
    /// Opens the accessor at `index`; at most `most` elements.
    pub(super) fn accessor(
        &self,
        index: usize,
        location: &str,
        most: u64,
    ) -> Result<Accessor<'a>, SceneError> {
        let file = self.file;
        let root = self.root;
        let accessor = file.element(&root.accessors, "accessors", index, location)?;
        let place = format!("accessors[{index}]");
        let (Checked::Valid(component), Checked::Valid(kind)) =
            (accessor.component_type, accessor.type_)
        else {
            return Err(file.refused(&place, "unknown componentType or type"));
        };
        let component = component.0;
        let components = match kind {
            Type::Scalar => 1,
            Type::Vec2 => 2,
            Type::Vec3 => 3,
            Type::Vec4 => 4,
            Type::Mat2 | Type::Mat3 | Type::Mat4 => {
                return Err(file.refused(&place, "a matrix, allowed are scalars and vectors"));
            }
        };
        let count = accessor.count.0;
        if count > most {
            let message = format!("{count} elements, the limit is {most}");
            return Err(file.refused(format!("{place}.count"), message));
        }
        let count = count as usize;
        let size = components * component.size();
        let (bytes, stride) = match accessor.buffer_view {
            None => (None, size),
            Some(view) => {
                let view = self.view(view.value(), &place)?;
                let stride = view.stride.unwrap_or(size);
                if stride < size {
                    let message = format!("elements of {size} bytes at a stride of {stride}");
                    return Err(file.refused(&place, message));
                }
                let offset = accessor.byte_offset.map_or(0, |offset| offset.0);
                let bytes = usize::try_from(offset)
                    .ok()
                    .and_then(|offset| view.bytes.get(offset..))
                    .filter(|bytes| fits(bytes.len(), count, stride, size));
                let bytes = bytes.ok_or_else(|| {
                    let message = format!(
                        "{count} elements of {size} bytes at a stride of {stride} from byte \
                         {offset} leave their buffer view, which has {} bytes",
                        view.bytes.len()
                    );
                    file.refused(&place, message)
                })?;
                (Some(bytes), stride)
            }
        };
        let sparse = self.sparse(accessor, &place, count, size)?;
        Ok(Accessor {
            bytes,
            stride,
            count,
            component,
            components,
            normalized: accessor.normalized,
            sparse,
        })
    }

    /// Opens the replaced elements of a sparse accessor.
    fn sparse(
        &self,
        accessor: &gltf::json::Accessor,
        place: &str,
        count: usize,
        size: usize,
    ) -> Result<Option<Replaced<'a>>, SceneError> {
        let Some(sparse) = &accessor.sparse else {
            return Ok(None);
        };
        let file = self.file;
        let refused =
            |part: &str, message: &str| Err(file.refused(format!("{place}.sparse{part}"), message));
        let replaced = usize::try_from(sparse.count.0).unwrap_or(usize::MAX);
        if replaced > count {
            return refused(".count", "more than the accessor has elements");
        }
        let Checked::Valid(component) = sparse.indices.component_type else {
            return refused(".indices", "unknown componentType");
        };
        let component = component.0;
        let part = |view: usize, offset: u64, size: usize, name: &str| {
            let location = format!("{place}.sparse{name}");
            let view = self.view(view, &location)?;
            usize::try_from(offset)
                .ok()
                .and_then(|offset| view.bytes.get(offset..))
                .filter(|bytes| fits(bytes.len(), replaced, size, size))
                .ok_or_else(|| file.refused(location, "leaves its buffer view"))
        };
        let indices = part(
            sparse.indices.buffer_view.value(),
            sparse.indices.byte_offset.0,
            component.size(),
            ".indices",
        )?;
        let values = part(
            sparse.values.buffer_view.value(),
            sparse.values.byte_offset.0,
            size,
            ".values",
        )?;
        let indices: Vec<u32> = indices
            .chunks_exact(component.size())
            .take(replaced)
            .map(|bytes| unsigned(component, bytes))
            .collect();
        if !indices.is_sorted_by(|a, b| a < b) {
            return refused(".indices", "not in increasing order");
        }
        if indices.last().is_some_and(|last| *last as usize >= count) {
            return refused(".indices", "an index is out of range");
        }
        Ok(Some((indices, values)))
    }
}

/// Whether `count` elements of `size` bytes fit at a stride.
fn fits(bytes: usize, count: usize, stride: usize, size: usize) -> bool {
    let Some(last) = count.checked_sub(1) else {
        return true;
    };
    last.checked_mul(stride)
        .and_then(|start| start.checked_add(size))
        .is_some_and(|end| end <= bytes)
}

impl Accessor<'_> {
    /// Number of elements.
    pub(super) fn count(&self) -> usize {
        self.count
    }

    /// Components an element: 1 to 4.
    pub(super) fn components(&self) -> usize {
        self.components
    }

    /// Whether the elements are unsigned integers.
    pub(super) fn is_unsigned(&self) -> bool {
        use ComponentType::{U8, U16, U32};
        matches!(self.component, U8 | U16 | U32)
    }

    /// Whether the elements are 32-bit integers, which no attribute may be.
    pub(super) fn is_u32(&self) -> bool {
        self.component == ComponentType::U32
    }

    /// The bytes of an element; `None` stands for zeros. `index` is less than `count`.
    fn element(&self, index: usize) -> Option<&[u8]> {
        let size = self.components * self.component.size();
        if let Some((indices, values)) = &self.sparse
            && let Ok(at) = indices.binary_search(&(index as u32))
        {
            return values.get(at * size..(at + 1) * size);
        }
        let start = index * self.stride;
        self.bytes?.get(start..start + size)
    }

    /// A scalar as an unsigned integer.
    pub(super) fn unsigned(&self, index: usize) -> u32 {
        self.element(index)
            .map_or(0, |bytes| unsigned(self.component, bytes))
    }

    /// An element as floats, missing components 0.
    pub(super) fn floats<const N: usize>(&self, index: usize) -> [f32; N] {
        let mut floats = [0.0; N];
        if let Some(bytes) = self.element(index) {
            let parts = bytes.chunks_exact(self.component.size());
            for (float, part) in floats.iter_mut().zip(parts) {
                *float = self.float(part);
            }
        }
        floats
    }

    /// One component as a float, by the rules of normalized integers.
    fn float(&self, bytes: &[u8]) -> f32 {
        let normalized = |value: f32, most: f32| {
            if self.normalized {
                (value / most).max(-1.0)
            } else {
                value
            }
        };
        match (self.component, bytes) {
            (ComponentType::I8, [a]) => normalized(f32::from(a.cast_signed()), 127.0),
            (ComponentType::U8, [a]) => normalized(f32::from(*a), 255.0),
            (ComponentType::I16, [a, b]) => {
                normalized(f32::from(i16::from_le_bytes([*a, *b])), 32_767.0)
            }
            (ComponentType::U16, [a, b]) => {
                normalized(f32::from(u16::from_le_bytes([*a, *b])), 65_535.0)
            }
            (ComponentType::U32, [a, b, c, d]) => u32::from_le_bytes([*a, *b, *c, *d]) as f32,
            (ComponentType::F32, [a, b, c, d]) => f32::from_le_bytes([*a, *b, *c, *d]),
            _ => 0.0,
        }
    }
}

/// Little-endian bytes as an unsigned integer; 0 for other types.
fn unsigned(component: ComponentType, bytes: &[u8]) -> u32 {
    match (component, bytes) {
        (ComponentType::U8, [a]) => u32::from(*a),
        (ComponentType::U16, [a, b]) => u32::from(u16::from_le_bytes([*a, *b])),
        (ComponentType::U32, [a, b, c, d]) => u32::from_le_bytes([*a, *b, *c, *d]),
        _ => 0,
    }
}
