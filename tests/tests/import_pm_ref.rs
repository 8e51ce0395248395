//! The reference scenes convert and build.

use std::path::PathBuf;

use tyndall_scene::{MediumShape, build, facts};
use tyndall_tests::{pm_ref, shared_folder};

fn reference() -> Option<PathBuf> {
    shared_folder::find("reference scenes").map(|shared| shared.join("reference"))
}

#[test]
fn every_reference_scene_converts_and_builds() {
    let Some(reference) = reference() else { return };
    for name in [
        "exp_fog",
        "fog_box",
        "furnace",
        "light_shafts",
        "smoke_plume",
    ] {
        let file = reference.join(format!("scenes/{name}.json"));
        let description = pm_ref::load(&file).unwrap();
        assert_eq!(description.name, name);
        let loaded = build(description, Some(&reference)).unwrap();
        assert!(loaded.warnings.is_empty(), "{name}: {:?}", loaded.warnings);
        let facts = facts(&loaded.scene);
        println!("{name}: {facts:?}");
        assert!(facts.scatters, "{name}");
    }
}

#[test]
fn the_numbers_of_exp_fog_arrive_unchanged() {
    let Some(reference) = reference() else { return };
    let description = pm_ref::load(&reference.join("scenes/exp_fog.json")).unwrap();
    let scene = build(description, Some(&reference)).unwrap().scene;
    assert_eq!(scene.camera.position.to_array(), [0.5, 1.7, 7.5]);
    assert_eq!((scene.render.width, scene.render.height), (160, 120));
    assert_eq!(scene.lights.len(), 3);
    assert!(matches!(
        scene.media[0].shape,
        MediumShape::HeightFog {
            bounds: Some(_),
            ..
        }
    ));
    let facts = facts(&scene);
    assert_eq!(facts.emissive_triangles, 4);
}

#[test]
fn a_scene_of_another_schema_is_refused() {
    let folder = std::env::temp_dir().join(format!("tyndall-pm-ref-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let file = folder.join("other.json");
    std::fs::write(&file, "{\"schema\":\"pm-ref/2\"}").unwrap();
    let error = pm_ref::load(&file).unwrap_err().to_string();
    std::fs::remove_dir_all(&folder).unwrap();
    assert!(error.contains("pm-ref/2"), "{error}");
}
