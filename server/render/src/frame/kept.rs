//! What stages and techniques keep from frame to frame, and when it counts.

use std::any::{Any, TypeId};
use std::fmt::Debug;

use tyndall_scene::{ChangeSet, Scene, SceneFacts};

use crate::engine::{Bindings, Device};
use crate::error::RenderError;

/// Something that a stage or a technique keeps on the device from frame to frame, for one view.
///
/// Views hold what the passes of their plan name ([`KeptKind`]) and drop the rest.
pub(crate) trait Kept: Debug + Any {
    /// What serves the scene's new state: this, without what [`Preparation::changed`] made worthless.
    /// On an error the old one stays in use.
    fn next(&self, preparation: &Preparation<'_>) -> Result<Box<dyn Kept>, RenderError>;

    /// Uploads what is relative to the camera, after every change of the scene.
    fn upload(&self, device: &Device, scene: &Scene);

    /// Adds what passes read of it.
    fn bind<'a>(&'a self, bindings: &mut Bindings<'a>);

    /// Hears that the frame in which it was recorded was submitted, or dropped.
    fn settle(&mut self, submitted: bool);
}

/// A scene's new state, as what is kept must follow it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Preparation<'a> {
    pub device: &'a Device,
    pub scene: &'a Scene,
    pub facts: &'a SceneFacts,
    /// Width and height of the picture. Unit: pixel.
    pub size: [u32; 2],
    /// The state before, unless it is the view's first.
    pub before: Option<&'a Scene>,
    /// What differs between the two; everything in a new view.
    pub changed: ChangeSet,
}

/// A kind of kept thing: a pass of a plan names those it uses.
#[derive(Debug, Clone, Copy)]
pub(crate) struct KeptKind {
    id: TypeId,
    new: fn(&Device) -> Box<dyn Kept>,
}

impl KeptKind {
    /// The kind of `T`; `new` makes an empty one.
    pub fn of<T: Kept>(new: fn(&Device) -> Box<dyn Kept>) -> Self {
        Self {
            id: TypeId::of::<T>(),
            new,
        }
    }
}

/// Everything that one view keeps.
#[derive(Debug, Default)]
pub(crate) struct KeptStates {
    states: Vec<Box<dyn Kept>>,
}

impl KeptStates {
    /// Those of `kinds`, for the scene's new state.
    pub fn next(
        &self,
        kinds: &[KeptKind],
        preparation: &Preparation<'_>,
    ) -> Result<Self, RenderError> {
        let mut states: Vec<Box<dyn Kept>> = Vec::new();
        for kind in kinds {
            let is_it = |state: &dyn Kept| state.type_id() == kind.id;
            if states.iter().any(|state| is_it(state.as_ref())) {
                continue;
            }
            let known = self.states.iter().find(|state| is_it(state.as_ref()));
            states.push(match known {
                Some(state) => state.next(preparation)?,
                None => (kind.new)(preparation.device).next(&Preparation {
                    before: None,
                    changed: ChangeSet::all(),
                    ..*preparation
                })?,
            });
        }
        Ok(Self { states })
    }

    /// The one of type `T`, if the plan names it.
    pub fn get<T: Kept>(&self) -> Option<&T> {
        self.states
            .iter()
            .find_map(|state| (state.as_ref() as &dyn Any).downcast_ref())
    }

    pub fn upload(&self, device: &Device, scene: &Scene) {
        for state in &self.states {
            state.upload(device, scene);
        }
    }

    pub fn bind<'a>(&'a self, bindings: &mut Bindings<'a>) {
        for state in &self.states {
            state.bind(bindings);
        }
    }

    pub fn settle(&mut self, submitted: bool) {
        for state in &mut self.states {
            state.settle(submitted);
        }
    }
}

/// Whether something kept holds what it should: that counts only once the frame that filled it was
/// submitted.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(crate) enum Filled {
    #[default]
    No,
    /// By the frame that is being recorded.
    Recorded,
    Yes,
}

impl Filled {
    /// What it is once that frame was submitted, or dropped.
    pub fn settled(self, submitted: bool) -> Self {
        match (self, submitted) {
            (Self::Recorded, true) => Self::Yes,
            (Self::Recorded, false) => Self::No,
            (other, _) => other,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_dropped_frame_filled_does_not_count() {
        assert_eq!(Filled::Recorded.settled(false), Filled::No);
        assert_eq!(Filled::Recorded.settled(true), Filled::Yes);
        assert_eq!(Filled::Yes.settled(false), Filled::Yes);
        assert_eq!(Filled::No.settled(true), Filled::No);
    }
}
