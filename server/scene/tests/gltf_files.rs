//! Every model of the shared data folder, good and bad, through the public loader.

#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "helpers of tests, too, fail by unwrapping and say what they skip"
)]

use std::path::{Path, PathBuf};

use crate::support::{shared, walk};
use tyndall_scene::{Loaded, SceneError, facts, load};

fn models(folder: &Path) -> Vec<PathBuf> {
    let is_model = |path: &PathBuf| {
        path.extension()
            .and_then(|ending| ending.to_str())
            .is_some_and(|ending| matches!(ending, "gltf" | "glb" | "obj"))
    };
    walk(folder).into_iter().filter(is_model).collect()
}

fn assert_sound(file: &Path, loaded: &Loaded) {
    let geometry = &loaded.scene.geometry;
    for mesh in &geometry.meshes {
        let vertices = mesh.positions.len();
        assert_eq!(mesh.normals.len(), vertices, "{}", file.display());
        for texcoords in &mesh.texcoords {
            assert!(texcoords.is_empty() || texcoords.len() == vertices);
        }
        assert!(mesh.colors.is_empty() || mesh.colors.len() == vertices);
        assert!(mesh.indices.len().is_multiple_of(3) && !mesh.indices.is_empty());
        assert!(mesh.indices.iter().all(|i| (*i as usize) < vertices));
        assert!(mesh.positions.iter().flatten().all(|c| c.is_finite()));
        assert!(mesh.material < geometry.materials.len());
        for normal in &mesh.normals {
            let length = normal.iter().map(|c| c * c).sum::<f32>().sqrt();
            assert!(
                (length - 1.0).abs() < 1e-4,
                "{}: {normal:?}",
                file.display()
            );
        }
    }
    for instance in &geometry.instances {
        assert!(instance.mesh < geometry.meshes.len());
        assert!(instance.world_from_object.matrix3.determinant() > 0.0);
    }
    for texture in &geometry.textures {
        let bytes = 4 * texture.width as usize * texture.height as usize;
        assert_eq!(texture.pixels.len(), bytes);
    }
}

#[test]
fn every_good_model_loads_or_is_refused_for_what_is_unsupported() {
    let Some(shared) = shared() else { return };
    let meshes = shared.join("data/meshes");
    let mut loaded_files = 0;
    for file in models(&meshes) {
        if file.starts_with(meshes.join("gltf-bad")) || file.starts_with(meshes.join("sponza")) {
            continue;
        }
        match load(&file) {
            Ok(loaded) => {
                assert_sound(&file, &loaded);
                loaded_files += 1;
            }
            Err(error) => {
                let text = error.to_string();
                println!("{}: {text}", file.display());
                let known = ["EXT_meshopt_compression", "KHR_draco_mesh_compression"];
                let is_known = known.iter().any(|name| text.contains(name))
                    || file.ends_with("minimal_accessor_invalid.gltf");
                assert!(is_known, "{}: {text}", file.display());
            }
        }
    }
    println!("{loaded_files} models loaded");
    assert!(loaded_files >= 50, "{loaded_files}");
}

#[test]
fn triangle_counts_are_those_of_the_files() {
    let Some(shared) = shared() else { return };
    let counts = [
        ("gltf-samples/Box/Box.gltf", 12),
        ("gltf-samples/BoxInterleaved/BoxInterleaved.gltf", 12),
        ("gltf-samples/BoxTextured/BoxTextured.gltf", 12),
        ("gltf-samples/BoxVertexColors/BoxVertexColors.gltf", 12),
        ("gltf-samples/Triangle/Triangle.gltf", 1),
        (
            "gltf-samples/TriangleWithoutIndices/TriangleWithoutIndices.gltf",
            1,
        ),
        ("gltf-samples/SimpleMeshes/SimpleMeshes.gltf", 2),
        (
            "gltf-samples/SimpleSparseAccessor/SimpleSparseAccessor.gltf",
            12,
        ),
        ("gltf-samples/CesiumMilkTruck/CesiumMilkTruck.gltf", 3624),
        ("gltf-samples/Suzanne/Suzanne.gltf", 3936),
        ("gltf-rs-tests/box_sparse.glb", 12),
        ("cornell/CornellBox-Original.obj", 36),
    ];
    for (file, triangles) in counts {
        let loaded = load(&shared.join("data/meshes").join(file)).unwrap();
        assert_eq!(facts(&loaded.scene).triangles, triangles, "{file}");
    }
}

#[test]
fn sponza_loads_whole_and_textured() {
    let Some(shared) = shared() else { return };
    let file = shared.join("data/meshes/sponza/Sponza-crytek-decoded.glb");
    let started = std::time::Instant::now();
    let loaded = load(&file).unwrap();
    let facts = facts(&loaded.scene);
    println!(
        "sponza: {:.2} s, {} triangles, {} instances, {} textures, bounds {:?}, {} warnings",
        started.elapsed().as_secs_f64(),
        facts.triangles,
        facts.instances,
        facts.textures,
        facts.surface_bounds,
        loaded.warnings.len()
    );
    for warning in &loaded.warnings {
        println!("  {warning}");
    }
    assert_sound(&file, &loaded);
    assert!(facts.textures > 10);
    let dropped: u64 = loaded
        .warnings
        .iter()
        .filter(|warning| warning.contains("without area dropped"))
        .filter_map(|warning| {
            let before = warning.split(" triangles without area").next()?;
            before.rsplit(' ').next()?.parse::<u64>().ok()
        })
        .sum();
    assert_eq!(facts.triangles + dropped, 262_267);
}

#[test]
fn every_bad_model_loads_or_names_its_cause() {
    let Some(shared) = shared() else { return };
    let files = models(&shared.join("data/meshes/gltf-bad"));
    assert!(files.len() > 20);
    for file in files {
        match load(&file) {
            Ok(loaded) => {
                println!("{}: loads, {:?}", file.display(), loaded.warnings);
                assert_sound(&file, &loaded);
            }
            Err(error) => {
                println!("{}: {error}", file.display());
                assert_names_a_cause(&error);
            }
        }
    }
}

fn assert_names_a_cause(error: &SceneError) {
    match error {
        SceneError::Model {
            location, message, ..
        } => assert!(!location.is_empty() && !message.is_empty(), "{error}"),
        SceneError::Limit { .. } | SceneError::Io { .. } | SceneError::Invalid { .. } => {}
        SceneError::Syntax { .. } => panic!("a model is no scene: {error}"),
    }
}
