//! Built-in scenes, built at most once each and then shared: opening a preset again costs no
//! work, and no client can make the server build more than there are presets.

use std::collections::HashMap;
use std::sync::{Arc, Mutex};

use tokio::sync::Semaphore;
use tyndall_render::{PlanLimits, check_supported};
use tyndall_scene::{Loaded, SceneDescription, SceneError, build, facts, presets};
use tyndall_stream::protocol::{Facts, Plan};

use crate::backend;
use crate::bell::lock;

/// Why a scene could not be built.
#[derive(Debug, thiserror::Error)]
pub(crate) enum BuildError {
    #[error("there is no preset {name:?}")]
    NoSuchPreset { name: String },
    #[error(transparent)]
    Scene(#[from] SceneError),
    #[error(transparent)]
    NotRenderedYet(#[from] tyndall_render::NotRenderedYet),
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
}

impl Scenes {
    pub(crate) fn new(first: Loaded) -> Self {
        Self {
            first: Arc::new(first),
            presets: Mutex::default(),
            building: Semaphore::new(1),
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
    pub(crate) async fn plan_of_preset(&self, name: &str) -> Result<PlanReply, BuildError> {
        plan(&*self.preset(name).await?)
    }

    /// The plan of any scene that refers to no files.
    pub(crate) async fn plan_of(&self, text: String) -> Result<PlanReply, BuildError> {
        let _permit = self
            .building
            .acquire()
            .await
            .map_err(|_closed| BuildError::BrokenOff)?;
        let parsed = tokio::task::spawn_blocking(move || SceneDescription::from_json(&text));
        let description = parsed.await.map_err(|_join| BuildError::BrokenOff)??;
        plan(&on_blocking_thread(description).await?)
    }
}

async fn on_blocking_thread(description: SceneDescription) -> Result<Loaded, BuildError> {
    let built = tokio::task::spawn_blocking(move || build(description, None));
    Ok(built.await.map_err(|_join| BuildError::BrokenOff)??)
}

fn plan(loaded: &Loaded) -> Result<PlanReply, BuildError> {
    check_supported(&loaded.scene)?;
    let facts = facts(&loaded.scene);
    let plan = tyndall_render::plan(&facts, &loaded.scene.render, &PlanLimits::default())?;
    Ok(PlanReply {
        name: loaded.scene.name.clone(),
        plan: backend::plan(&plan),
        facts: Facts::from(&facts),
        warnings: loaded.warnings.clone(),
    })
}
