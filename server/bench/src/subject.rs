//! A scene to be measured, from a preset, a scene file or a `pm-ref/1` reference scene.

use std::path::{Path, PathBuf};

use tyndall_quality::Image;
use tyndall_scene::{Loaded, SceneDescription};

use crate::claim::Claim;
use crate::error::BenchError;
use crate::pm_ref;

/// A scene to be measured.
#[derive(Debug, Clone)]
pub struct Subject {
    /// Preset, or the file's stem.
    pub name: String,
    /// What it was built from.
    pub description: SceneDescription,
    /// Description and scene.
    pub loaded: Loaded,
    /// Where its files lie.
    pub folder: Option<PathBuf>,
    /// Folder of published reference images, `ref_NAME_full.npz` and `ref_NAME_single.npz`.
    pub published: Option<PathBuf>,
}

impl Subject {
    /// A scene that is loaded already.
    pub fn new(name: &str, loaded: Loaded, folder: Option<&Path>) -> Self {
        let stem = Path::new(name).file_stem().and_then(|stem| stem.to_str());
        Self {
            name: stem.unwrap_or(name).to_owned(),
            description: loaded.description.clone(),
            loaded,
            folder: folder.map(Path::to_owned),
            published: None,
        }
    }

    /// A `pm-ref/1` scene; `None` if the file is not of that schema.
    ///
    /// # Errors
    /// [`BenchError`] if it is, but can't be converted or built.
    pub fn pm_ref(path: &Path) -> Result<Option<Self>, BenchError> {
        let is_json = path.extension().is_some_and(|ending| ending == "json");
        let text = pm_ref::text(path).unwrap_or_default();
        let is_pm_ref = serde_json::from_str::<serde_json::Value>(&text)
            .is_ok_and(|value| value["schema"] == "pm-ref/1");
        if !is_json || !is_pm_ref {
            return Ok(None);
        }
        let description = pm_ref::load(path)?;
        let folder = path.parent().and_then(Path::parent).map(|folder| {
            if folder.as_os_str().is_empty() {
                PathBuf::from(".")
            } else {
                folder.to_owned()
            }
        });
        let loaded = tyndall_scene::build(description, folder.as_deref())?;
        Ok(Some(Self {
            name: loaded.scene.name.clone(),
            description: loaded.description.clone(),
            loaded,
            published: folder.as_ref().map(|folder| folder.join("data")),
            folder,
        }))
    }

    /// The published image of these paths, if there is one.
    ///
    /// # Errors
    /// [`BenchError`] if there is one that can't be read.
    pub fn published(&self, claim: Claim) -> Result<Option<Image>, BenchError> {
        let Some(folder) = &self.published else {
            return Ok(None);
        };
        let kind = match claim {
            Claim::Whole => "full",
            Claim::OneScattering => "single",
        };
        let file = folder.join(format!("ref_{}_{kind}.npz", self.name));
        if !file.exists() {
            return Ok(None);
        }
        Ok(Some(tyndall_picture::read(&file)?.image))
    }
}
