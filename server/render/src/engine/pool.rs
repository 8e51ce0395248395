//! Makes the textures and buffers that the passes of a plan declare, and knows their bytes before.
//!
//! Resources that live for a frame share memory: within a view where one pass is done with it before
//! another needs it, and between views of the same size whose frames are submitted as a whole: one is done
//! before the next begins. Resources that live longer are the view's own.

use std::sync::{Arc, Weak};

use super::device::Device;
use super::memory::{Kind, Memory, kind_of};
use super::resources::{Access, Life, ResourceSpec};
use crate::error::RenderError;

/// Memory that pictures may take on the device. Unit: byte.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct MemoryBudget {
    /// What the passes of one view may keep and exchange.
    pub per_view: u64,
    /// Everything that is allocated on the device, geometry and grids included.
    pub in_all: u64,
}

impl Default for MemoryBudget {
    /// 4 GiB a view, 16 GiB in all.
    fn default() -> Self {
        Self {
            per_view: 4 << 30,
            in_all: 16 << 30,
        }
    }
}

/// Memory that views share, and how much of it there may be.
#[derive(Debug, Default)]
pub(crate) struct Pool {
    pub budget: MemoryBudget,
    /// What lives for a frame: the first of a kind, the second, and so on.
    shared: Vec<(Kind, u32, Weak<Memory>)>,
}

/// What the passes of one view keep and exchange.
#[derive(Debug)]
pub(crate) struct ViewResources {
    pub size: [u32; 2],
    /// Whether what lives for a frame is shared with other views.
    shares: bool,
    entries: Vec<Entry>,
    bytes: u64,
}

#[derive(Debug)]
struct Entry {
    name: &'static str,
    previous: Option<&'static str>,
    life: Life,
    /// What `memory` is to be at the picture's size.
    kind: Kind,
    /// Which of the allocations of its kind, where it lives for a frame.
    slot: u32,
    memory: Allocation,
    /// Takes turns with `memory` where there is a previous state.
    other: Option<Allocation>,
}

/// Memory of a kind; what a picture of another size left is of another kind than its entry.
#[derive(Debug, Clone)]
struct Allocation {
    kind: Kind,
    memory: Arc<Memory>,
}

impl Allocation {
    fn new(device: &Device, kind: Kind, name: &'static str) -> Self {
        Self {
            kind,
            memory: Arc::new(kind.make(device, name)),
        }
    }
}

/// A resource of a plan: its kind, and the first and last pass that name it.
#[derive(Debug, Clone, Copy)]
struct Wanted {
    spec: ResourceSpec,
    kind: Kind,
    first: usize,
    last: usize,
    /// Which of the allocations of its kind, where it lives for a frame.
    slot: u32,
}

impl Pool {
    /// Makes what `passes` name, in the order in which they run, for a picture of a size that
    /// [`check_size`] let pass. What `before` holds of the same kind is kept with what is in it. `shares`
    /// memory with other views, for views whose frames are submitted as a whole.
    pub fn fit(
        &mut self,
        device: &Device,
        passes: &[&[Access]],
        size: [u32; 2],
        before: Option<&ViewResources>,
        shares: bool,
    ) -> Result<ViewResources, RenderError> {
        let mut wanted = wanted(passes, size);
        let bytes = share_slots(&mut wanted);
        if bytes > self.budget.per_view {
            return Err(RenderError::Memory {
                needed: bytes,
                allowed: self.budget.per_view,
            });
        }
        let limit = device.device.limits().max_storage_buffer_binding_size;
        for wanted in &wanted {
            if let Kind::Buffer { bytes, .. } = wanted.kind
                && bytes > limit
            {
                return Err(RenderError::TooLarge {
                    what: "bytes of one buffer of the picture",
                    needed: bytes,
                    allowed: limit,
                });
            }
        }
        self.shared
            .retain(|(_, _, memory)| memory.strong_count() > 0);
        self.check_all(device, &wanted, before, shares)?;
        let mut entries: Vec<Entry> = Vec::with_capacity(wanted.len());
        for wanted in wanted {
            let entry = self.entry(device, wanted, &entries, before, shares);
            entries.push(entry);
        }
        device.check()?;
        Ok(ViewResources {
            size,
            shares,
            entries,
            bytes,
        })
    }

    /// Refuses what would not fit beside all that is allocated.
    fn check_all(
        &self,
        device: &Device,
        wanted: &[Wanted],
        before: Option<&ViewResources>,
        shares: bool,
    ) -> Result<(), RenderError> {
        let mut counted: Vec<(Kind, u32)> = Vec::new();
        let mut new_bytes = 0;
        for wanted in wanted {
            let there = match wanted.spec.life {
                Life::View => before
                    .and_then(|before| before.kept(wanted))
                    .is_some_and(|entry| entry.kind == wanted.kind),
                Life::Frame => {
                    let slot = (wanted.kind, wanted.slot);
                    let known = counted.contains(&slot);
                    counted.push(slot);
                    known || self.for_a_frame(wanted, before, shares).is_some()
                }
            };
            if !there {
                new_bytes += wanted.bytes();
            }
        }
        if new_bytes == 0 {
            return Ok(());
        }
        let needed = device.allocated_bytes().unwrap_or(0) + new_bytes;
        if needed > self.budget.in_all {
            return Err(RenderError::Memory {
                needed,
                allowed: self.budget.in_all,
            });
        }
        Ok(())
    }

    /// Memory that is there for what lives for a frame: any view's, or the view's own before.
    fn for_a_frame(
        &self,
        wanted: &Wanted,
        before: Option<&ViewResources>,
        shares: bool,
    ) -> Option<Arc<Memory>> {
        if shares {
            let slot = |(kind, slot, _): &&(Kind, u32, Weak<Memory>)| {
                (*kind, *slot) == (wanted.kind, wanted.slot)
            };
            let (_, _, memory) = self.shared.iter().find(slot)?;
            return memory.upgrade();
        }
        let before = before.filter(|before| !before.shares)?;
        in_slot(&before.entries, wanted)
    }

    fn entry(
        &mut self,
        device: &Device,
        wanted: Wanted,
        made: &[Entry],
        before: Option<&ViewResources>,
        shares: bool,
    ) -> Entry {
        let Wanted { spec, kind, .. } = wanted;
        let make = || Allocation::new(device, kind, spec.name);
        let (memory, other) = match spec.life {
            Life::View => match before.and_then(|before| before.kept(&wanted)) {
                Some(entry) if entry.kind == kind => (entry.memory.clone(), entry.other.clone()),
                // The first frame turns to the other one, and finds the last picture in this.
                Some(entry) => (entry.memory.clone(), Some(make())),
                None => (make(), spec.previous.map(|_| make())),
            },
            Life::Frame => {
                let there =
                    in_slot(made, &wanted).or_else(|| self.for_a_frame(&wanted, before, shares));
                let memory = there.unwrap_or_else(|| {
                    let memory = make().memory;
                    if shares {
                        let slot = (kind, wanted.slot, Arc::downgrade(&memory));
                        self.shared.push(slot);
                    }
                    memory
                });
                (Allocation { kind, memory }, None)
            }
        };
        Entry {
            name: spec.name,
            previous: spec.previous,
            life: spec.life,
            kind,
            slot: wanted.slot,
            memory,
            other,
        }
    }
}

/// The memory of an entry that lives for a frame and has the same slot.
fn in_slot(entries: &[Entry], wanted: &Wanted) -> Option<Arc<Memory>> {
    let has_it = |entry: &&Entry| {
        entry.life == Life::Frame && (entry.kind, entry.slot) == (wanted.kind, wanted.slot)
    };
    let found = entries.iter().find(has_it)?;
    Some(Arc::clone(&found.memory.memory))
}

/// Refuses pictures that no pass could write.
pub(crate) fn check_size(device: &Device, [width, height]: [u32; 2]) -> Result<(), RenderError> {
    let limits = device.device.limits();
    let max_side = limits.max_texture_dimension_2d;
    // Every plan has a film of 16 bytes a pixel.
    let max_pixels = limits.max_storage_buffer_binding_size / 16;
    let pixels = u64::from(width) * u64::from(height);
    if pixels == 0 || pixels > max_pixels || width.max(height) > max_side {
        return Err(RenderError::Size {
            width,
            height,
            max_pixels,
            max_side,
        });
    }
    Ok(())
}

/// Every resource that some pass names, with all the uses that passes make of it.
fn wanted(passes: &[&[Access]], size: [u32; 2]) -> Vec<Wanted> {
    let mut found: Vec<Wanted> = Vec::new();
    for (index, accesses) in passes.iter().enumerate() {
        for access in *accesses {
            let spec = access.resource;
            let kind = kind_of(&spec, access.kind, size);
            match found.iter_mut().find(|w| w.spec.name == spec.name) {
                Some(known) => {
                    known.kind = known.kind.joined(kind);
                    known.last = index;
                }
                None => found.push(Wanted {
                    spec,
                    kind,
                    first: index,
                    last: index,
                    slot: 0,
                }),
            }
        }
    }
    found
}

/// Gives resources that live for a frame the first allocation of their kind that no other holds at the
/// same time; returns the bytes of all.
fn share_slots(wanted: &mut [Wanted]) -> u64 {
    let mut bytes = 0;
    // Kind, slot, last pass that needs it.
    let mut taken: Vec<(Kind, u32, usize)> = Vec::new();
    for wanted in wanted {
        if wanted.spec.life == Life::View {
            bytes += wanted.bytes();
            continue;
        }
        let mut count = 0;
        let mut free = None;
        for (_, slot, last) in taken.iter_mut().filter(|(kind, ..)| *kind == wanted.kind) {
            count += 1;
            if *last < wanted.first && free.is_none() {
                *last = wanted.last;
                free = Some(*slot);
            }
        }
        wanted.slot = free.unwrap_or_else(|| {
            taken.push((wanted.kind, count, wanted.last));
            bytes += wanted.kind.bytes();
            count
        });
    }
    bytes
}

impl Wanted {
    fn bytes(&self) -> u64 {
        let copies = if self.spec.previous.is_some() { 2 } else { 1 };
        copies * self.kind.bytes()
    }
}

impl ViewResources {
    /// Bytes that the view needs, those that it shares with others included.
    pub fn bytes(&self) -> u64 {
        self.bytes
    }

    /// The entry of a resource that lives from frame to frame and is of the same kind; of one with a
    /// previous state the last picture's counts at another size, too.
    fn kept(&self, wanted: &Wanted) -> Option<&Entry> {
        self.entries.iter().find(|entry| {
            entry.name == wanted.spec.name
                && entry.life == Life::View
                && entry.previous == wanted.spec.previous
                && (entry.kind == wanted.kind || entry.previous.is_some())
        })
    }

    fn memory(&self, name: &str) -> Option<&Memory> {
        self.entries.iter().find_map(|entry| {
            if entry.name == name {
                Some(entry.memory.memory.as_ref())
            } else if entry.previous == Some(name) {
                entry.other.as_ref().map(|other| other.memory.as_ref())
            } else {
                None
            }
        })
    }

    /// The buffer called `name`, or of which that is the previous state.
    pub fn buffer(&self, name: &str) -> Option<&wgpu::Buffer> {
        match self.memory(name)? {
            Memory::Buffer(buffer) => Some(buffer),
            Memory::Texture { .. } => None,
        }
    }

    /// All levels of the texture called `name`.
    pub fn texture(&self, name: &str) -> Option<&wgpu::TextureView> {
        match self.memory(name)? {
            Memory::Texture { whole, .. } => Some(whole),
            Memory::Buffer(_) => None,
        }
    }

    /// One level of the texture called `name`.
    pub fn level(&self, name: &str, level: usize) -> Option<&wgpu::TextureView> {
        match self.memory(name)? {
            Memory::Texture { levels, .. } => levels.get(level),
            Memory::Buffer(_) => None,
        }
    }

    /// Whether both have the same resources.
    pub fn same_as(&self, other: &Self) -> bool {
        let said = |entry: &Entry| (entry.name, entry.kind, entry.life, entry.previous);
        self.size == other.size
            && self
                .entries
                .iter()
                .map(said)
                .eq(other.entries.iter().map(said))
    }

    /// Whether anything of the last picture is kept.
    pub fn has_previous(&self) -> bool {
        self.entries.iter().any(|entry| entry.other.is_some())
    }

    /// Makes what every resource with a previous state holds that state.
    pub fn swap(&mut self, device: &Device) {
        for entry in &mut self.entries {
            if let Some(other) = &mut entry.other {
                std::mem::swap(&mut entry.memory, other);
                if entry.memory.kind != entry.kind {
                    entry.memory = Allocation::new(device, entry.kind, entry.name);
                }
            }
        }
    }

    /// Takes back a [`Self::swap`]: what counted as the previous state is the present one again.
    pub fn swap_back(&mut self) {
        for entry in &mut self.entries {
            if let Some(other) = &mut entry.other {
                std::mem::swap(&mut entry.memory, other);
            }
        }
    }
}
