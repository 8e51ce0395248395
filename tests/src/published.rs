//! The reference scenes and images of `../shared/reference`.

use std::path::PathBuf;

use tyndall_quality::Image;
use tyndall_scene::{CorrectionMode, Scene};

use crate::{pm_ref, shared_folder};

/// A published scene and one of its images.
#[derive(Debug)]
pub struct Published {
    /// As it was published: no technique chosen, not corrected, its own size.
    pub scene: Scene,
    /// The mean of two programs' samples with its variance. Unit: W·m⁻²·sr⁻¹.
    pub image: Image,
}

/// Scene `name` and its image `kind`, `full` or `single`; says aloud that it is skipped where the
/// shared folder is absent.
pub fn find(name: &str, kind: &str) -> Option<Published> {
    let folder: PathBuf = shared_folder::find(name)?.join("reference");
    let description =
        pm_ref::load(&folder.join(format!("scenes/{name}.json"))).expect("a published scene");
    let mut scene = tyndall_scene::build(description, Some(&folder))
        .expect("a published scene is valid")
        .scene;
    scene.render.correction = CorrectionMode::Off;
    scene.render.single_scattering.interleave = 1;
    let file = folder.join(format!("data/ref_{name}_{kind}.npz"));
    let image = tyndall_picture::read(&file)
        .expect("a published image")
        .image;
    assert_eq!(
        (image.width(), image.height()),
        (scene.render.width, scene.render.height),
        "a published image has its scene's size"
    );
    assert!(
        image.variance().is_some(),
        "a published image has its error"
    );
    Some(Published { scene, image })
}
