//! What the correction keeps of one view from frame to frame.

use std::sync::Arc;

use tyndall_scene::{Camera, Scene};

use super::history::{History, Seen};
use super::pyramid::{self, Level};
use crate::engine::{Bindings, Device};
use crate::error::RenderError;
use crate::frame::{Kept, Preparation};

/// What the correction keeps of one view at one size.
#[derive(Debug)]
pub(crate) struct Correction {
    size: [u32; 2],
    /// One a level of residuals, the finest first.
    pub(super) levels: Arc<Vec<Level>>,
    pub(super) history: History,
}

impl Correction {
    /// For a picture of this size.
    pub(super) fn new(device: &Device, size: [u32; 2]) -> Self {
        Self {
            size,
            levels: Arc::new(pyramid::levels(device, size)),
            history: History::new(device, size),
        }
    }

    /// Sets the picture whose residuals count beside the `samples` of the one at present, traced ones
    /// and the technique's, if any do.
    pub fn look_back(
        &self,
        device: &Device,
        last: Option<&Seen>,
        camera: &Camera,
        samples: (u32, u32),
    ) {
        self.history.look_back(device, last, camera, samples);
    }
}

impl Kept for Correction {
    fn next(&self, preparation: &Preparation<'_>) -> Result<Box<dyn Kept>, RenderError> {
        if self.size == preparation.size {
            return Ok(Box::new(Self {
                size: self.size,
                levels: Arc::clone(&self.levels),
                history: self.history.clone(),
            }));
        }
        Ok(Box::new(Self::new(preparation.device, preparation.size)))
    }

    fn upload(&self, _device: &Device, _scene: &Scene) {}

    fn bind<'a>(&'a self, bindings: &mut Bindings<'a>) {
        self.history.bind(bindings);
    }

    fn settle(&mut self, _submitted: bool) {}
}
