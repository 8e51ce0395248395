//! Built-in scenes, built at most once each and then shared: opening a preset again costs no
//! work, and no client can make the server build more than there are presets.

use std::collections::HashMap;
use std::sync::{Arc, Mutex};
use std::time::Duration;

use tokio::sync::Semaphore;
use tyndall_render::{PlanLimits, check_supported};
use tyndall_scene::{Limits, Loaded, SceneDescription, SceneError, build, facts, outline, presets};
use tyndall_stream::protocol::{Facts, Plan};

use crate::backend;
use crate::bell::lock;

/// Triangles that a scene may have to be planned, which takes a fraction of a second.
const MOST_TRIANGLES: u64 = 1_000_000;

/// Why a scene could not be built.
#[derive(Debug, thiserror::Error)]
pub(crate) enum BuildError {
    #[error("there is no preset {name:?}")]
    NoSuchPreset { name: String },
    #[error(transparent)]
    Scene(#[from] SceneError),
    #[error(transparent)]
    NotRenderedYet(#[from] tyndall_render::NotRenderedYet),
    #[error("planning did not end within {seconds} s")]
    TookTooLong { seconds: f32 },
    #[error("building the scene broke off")]
    BrokenOff,
}

/// What a scene would make the renderer do.
#[derive(Debug, serde::Serialize)]
pub(crate) struct PlanReply {
    pub(crate) name: String,
    pub(crate) plan: Plan,
    pub(crate) facts: Facts,
    pub(crate) warnings: Vec<String>,
}

/// The scene of new sessions, and the presets.
#[derive(Debug)]
pub(crate) struct Scenes {
    /// What new sessions see.
    pub(crate) first: Arc<Loaded>,
    presets: Mutex<HashMap<String, Arc<Loaded>>>,
    /// One scene is built at a time, so that building never takes all cores.
    building: Semaphore,
    /// One scene is planned at a time.
    planning: Arc<Semaphore>,
    plan_within: Duration,
}

impl Scenes {
    pub(crate) fn new(first: Loaded, plan_within: Duration) -> Self {
        Self {
            first: Arc::new(first),
            presets: Mutex::default(),
            building: Semaphore::new(1),
            planning: Arc::new(Semaphore::new(1)),
            plan_within,
        }
    }

    /// A preset, built on the blocking threads if nobody asked for it before.
    pub(crate) async fn preset(&self, name: &str) -> Result<Arc<Loaded>, BuildError> {
        let known = presets::names().iter().any(|preset| preset.name == name);
        let missing = || BuildError::NoSuchPreset {
            name: name.chars().take(80).collect(),
        };
        if !known {
            return Err(missing());
        }
        if let Some(built) = lock(&self.presets).get(name) {
            return Ok(Arc::clone(built));
        }
        let _permit = self
            .building
            .acquire()
            .await
            .map_err(|_closed| BuildError::BrokenOff)?;
        if let Some(built) = lock(&self.presets).get(name) {
            return Ok(Arc::clone(built));
        }
        let description = presets::description(name).ok_or_else(missing)?;
        let built = Arc::new(on_blocking_thread(description).await?);
        lock(&self.presets).insert(name.to_owned(), Arc::clone(&built));
        Ok(built)
    }

    /// The plan of a preset.
    pub(crate) async fn plan_of_preset(
        &self,
        name: &str,
        limits: PlanLimits,
    ) -> Result<PlanReply, BuildError> {
        let description = presets::description(name).ok_or_else(|| BuildError::NoSuchPreset {
            name: name.chars().take(80).collect(),
        })?;
        self.planned(move || plan(description, limits)).await
    }

    /// The plan of any scene that refers to no files.
    pub(crate) async fn plan_of(
        &self,
        text: String,
        limits: PlanLimits,
    ) -> Result<PlanReply, BuildError> {
        self.planned(move || plan(SceneDescription::from_json(&text)?, limits))
            .await
    }

    /// Plans on a blocking thread, one at a time; sessions do not wait for it. Whoever asked may leave: the
    /// thread keeps the permit until it is done, so that no more of them run than there are permits.
    async fn planned(
        &self,
        plan: impl FnOnce() -> Result<PlanReply, BuildError> + Send + 'static,
    ) -> Result<PlanReply, BuildError> {
        let planning = Arc::clone(&self.planning);
        let planned = async {
            let permit = planning
                .acquire_owned()
                .await
                .map_err(|_closed| BuildError::BrokenOff)?;
            let planned = tokio::task::spawn_blocking(move || {
                let planned = plan();
                drop(permit);
                planned
            });
            planned.await.map_err(|_join| BuildError::BrokenOff)?
        };
        let seconds = self.plan_within.as_secs_f32();
        tokio::time::timeout(self.plan_within, planned)
            .await
            .map_err(|_elapsed| BuildError::TookTooLong { seconds })?
    }
}

async fn on_blocking_thread(description: SceneDescription) -> Result<Loaded, BuildError> {
    let built = tokio::task::spawn_blocking(move || build(description, None));
    Ok(built.await.map_err(|_join| BuildError::BrokenOff)??)
}

/// What a scene of this description would make the renderer do; grids stand as outlines.
fn plan(description: SceneDescription, limits: PlanLimits) -> Result<PlanReply, BuildError> {
    let most = Limits {
        triangles: MOST_TRIANGLES,
        vertices: MOST_TRIANGLES,
        ..Limits::default()
    };
    let outlined = outline(description, &most)?;
    check_supported(&outlined.scene)?;
    let facts = facts(&outlined.scene);
    let plan = tyndall_render::plan(&facts, &outlined.scene.render, &limits)?;
    Ok(PlanReply {
        name: outlined.scene.name.clone(),
        plan: backend::plan(&plan),
        facts: Facts::from(&facts),
        warnings: outlined.warnings,
    })
}
