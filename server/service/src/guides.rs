//! Guides through the scenes that can be opened, built at most once each on the blocking threads.

use std::sync::{Arc, Mutex};

use tokio::sync::Semaphore;
use tyndall_render::Guide;
use tyndall_scene::description::Navigation;
use tyndall_scene::{Scene, Surfaces};

use crate::bell::lock;

/// The guides that were built. Only presets and the first scene can be opened, so there are few.
#[derive(Debug)]
pub(crate) struct Guides {
    known: Mutex<Vec<(Arc<Surfaces>, Arc<Guide>)>>,
    /// One guide is built at a time, so that building never takes all cores.
    building: Semaphore,
}

impl Guides {
    pub(crate) fn new() -> Self {
        Self {
            known: Mutex::default(),
            building: Semaphore::new(1),
        }
    }

    /// The guide of a scene as it was opened; `None` where none can be built: then nothing stops the eye.
    pub(crate) async fn guide(
        &self,
        scene: Arc<Scene>,
        declared: Option<Navigation>,
    ) -> Option<Arc<Guide>> {
        let surfaces = Arc::clone(&scene.geometry.surfaces);
        if let Some(known) = self.find(&surfaces) {
            return Some(known);
        }
        let _permit = self.building.acquire().await.ok()?;
        if let Some(known) = self.find(&surfaces) {
            return Some(known);
        }
        let built = tokio::task::spawn_blocking(move || Guide::build(&scene, declared)).await;
        let guide = match built {
            Ok(Ok(guide)) => Arc::new(guide),
            Ok(Err(error)) => {
                tracing::warn!(%error, "no guide leads through this scene");
                return None;
            }
            Err(broken) => {
                tracing::error!(%broken, "building a guide broke off");
                return None;
            }
        };
        lock(&self.known).push((surfaces, Arc::clone(&guide)));
        Some(guide)
    }

    fn find(&self, surfaces: &Arc<Surfaces>) -> Option<Arc<Guide>> {
        let known = lock(&self.known);
        let of_these = known.iter().find(|(known, _)| Arc::ptr_eq(known, surfaces));
        of_these.map(|(_, guide)| Arc::clone(guide))
    }
}
