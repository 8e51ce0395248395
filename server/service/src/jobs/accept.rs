//! From a request to a queued job: the scene is loaded and planned first, so what is accepted can be
//! rendered as far as anybody can tell.

use std::path::Path;
use std::sync::Arc;

use tyndall_jobs::upload::Upload;
use tyndall_jobs::{JobId, JobRequest, NewJob, QueueError, Spec, SpecError, Submitted};
use tyndall_picture::hash_json;
use tyndall_render::{PlanLimits, check_supported};
use tyndall_scene::{Limits, Loaded, SceneDescription, SceneError, facts, outline, presets};

use super::{Jobs, now};
use crate::backend;
use crate::options::ServiceLimits;
use crate::scenes::{BuildError, PlanReply};

/// Why a job was not accepted.
#[derive(Debug, thiserror::Error)]
pub(crate) enum AcceptError {
    #[error(transparent)]
    Build(#[from] BuildError),
    #[error(transparent)]
    Queue(#[from] QueueError),
    #[error(
        "the picture has {width}×{height} pixels, allowed are {max_pixels} and sides of {max_side}"
    )]
    Size {
        width: u32,
        height: u32,
        max_pixels: u64,
        max_side: u32,
    },
    #[error("this server has no ffmpeg, so it makes no videos; the frames alone can be had")]
    NoVideo,
    #[error("the description of the scene cannot be hashed: {0}")]
    Hash(String),
}

impl From<SceneError> for AcceptError {
    fn from(error: SceneError) -> Self {
        Self::Build(BuildError::Scene(error))
    }
}

impl From<SpecError> for AcceptError {
    fn from(error: SpecError) -> Self {
        match error {
            SpecError::Scene(error) => error.into(),
            SpecError::Hash(error) => Self::Hash(error.to_string()),
        }
    }
}

/// A request that can be rendered.
#[derive(Debug)]
pub(crate) struct Validated {
    pub(crate) plan: PlanReply,
    pub(crate) tasks: Vec<tyndall_jobs::TaskSpec>,
}

/// A job that is queued.
pub(crate) type Accepted = Submitted;

impl Jobs {
    /// Loads and plans the scene of a request on a blocking thread, one at a time.
    pub(crate) async fn validate(
        self: &Arc<Self>,
        request: &JobRequest,
        upload: Option<&Upload>,
        service: &ServiceLimits,
        plan_limits: PlanLimits,
    ) -> Result<Validated, AcceptError> {
        if request.video && !self.makes_videos() {
            return Err(AcceptError::NoVideo);
        }
        let broken = || AcceptError::Build(BuildError::BrokenOff);
        let _permit = self.loading.acquire().await.map_err(|_closed| broken())?;
        let folder = upload.map(|upload| upload.folder().to_owned());
        let content = upload.map(Upload::content).unwrap_or_default();
        let (request, service) = (request.clone(), *service);
        let validated = tokio::task::spawn_blocking(move || {
            let loaded = load(&request, folder.as_deref(), true)?;
            let spec = Spec {
                request: &request,
                loaded: &loaded,
            };
            let (_, scene) = spec.scene(0)?;
            check_size(&scene.render, &service)?;
            check_supported(&scene).map_err(BuildError::NotRenderedYet)?;
            let facts = facts(&scene);
            let plan = tyndall_render::plan(&facts, &scene.render, &plan_limits)
                .map_err(BuildError::NotRenderedYet)?;
            Ok(Validated {
                plan: PlanReply {
                    name: scene.name.clone(),
                    plan: backend::plan(&plan),
                    facts: (&facts).into(),
                    warnings: loaded.warnings.clone(),
                },
                tasks: spec.tasks(&content)?,
            })
        });
        validated.await.map_err(|_join| broken())?
    }

    /// Queues a request that was validated.
    pub(crate) async fn accept(
        &self,
        id: JobId,
        request: JobRequest,
        validated: Validated,
        idempotency_key: Option<String>,
    ) -> Result<Accepted, AcceptError> {
        let json =
            serde_json::to_value(&request).map_err(|error| AcceptError::Hash(error.to_string()))?;
        let specs: Vec<&str> = validated
            .tasks
            .iter()
            .map(|task| task.spec_hash.as_str())
            .collect();
        let request_hash = hash_json(&serde_json::json!({ "request": json, "tasks": specs }));
        let job = NewJob {
            id,
            request,
            request_hash,
            idempotency_key,
            tasks: validated.tasks,
        };
        Ok(self.queue.submit(job, now()).await?)
    }
}

fn check_size(
    render: &tyndall_scene::RenderSettings,
    limits: &ServiceLimits,
) -> Result<(), AcceptError> {
    let (width, height) = (render.width, render.height);
    let pixels = u64::from(width) * u64::from(height);
    let (max_pixels, max_side) = (limits.max_pixels, limits.max_side);
    if pixels > max_pixels || width.max(height) > max_side {
        return Err(AcceptError::Size {
            width,
            height,
            max_pixels,
            max_side,
        });
    }
    Ok(())
}

/// The scene of a request. Where only its plan is asked for, and it refers to no files, grids stand as
/// outlines.
pub(super) fn load(
    request: &JobRequest,
    folder: Option<&Path>,
    only_plan: bool,
) -> Result<Loaded, BuildError> {
    if let Some(file) = &request.scene_file {
        let found = || SceneError::Invalid {
            path: "scene_file".to_owned(),
            found: format!("{:?}", file.chars().take(80).collect::<String>()),
            allowed: "the name of an uploaded file".to_owned(),
        };
        let name = tyndall_files::relative::why_not_relative(file);
        let path = folder
            .filter(|_| name.is_none())
            .map(|folder| folder.join(file));
        let path = path.filter(|path| path.is_file()).ok_or_else(found)?;
        return Ok(tyndall_scene::load(&path)?);
    }
    let description: SceneDescription = match (&request.scene, &request.preset) {
        (Some(scene), _) => SceneDescription::clone(scene),
        (None, Some(name)) => {
            presets::description(name).ok_or_else(|| BuildError::NoSuchPreset {
                name: name.chars().take(80).collect(),
            })?
        }
        (None, None) => {
            return Err(BuildError::Scene(SceneError::Invalid {
                path: String::new(),
                found: "no scene".to_owned(),
                allowed: "exactly one of scene, preset and scene_file".to_owned(),
            }));
        }
    };
    if only_plan && folder.is_none() {
        return Ok(outline(description, &Limits::default())?);
    }
    Ok(tyndall_scene::build(description, folder)?)
}
