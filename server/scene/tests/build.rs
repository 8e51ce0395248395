//! What a description turns into: placements, materials, lights, facts.

#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "helpers of tests, too, fail by unwrapping and say what they skip"
)]

use crate::support::shared;
use glam::{DVec3, Vec3};
use serde_json::{Value, json};
use tyndall_scene::{
    Light, Loaded, MediumShape, Mesh, SceneDescription, StopRule, build, facts, load,
};

fn scene(parts: &Value) -> Loaded {
    let mut scene = json!({
        "version": 1,
        "camera": {"position": [0, 1, 4], "target": [0, 1, 0]},
    });
    let members = scene.as_object_mut().unwrap();
    members.extend(parts.as_object().unwrap().clone());
    build(
        SceneDescription::from_json(&scene.to_string()).unwrap(),
        None,
    )
    .unwrap()
}

/// Corners of every triangle in the world.
fn triangles(loaded: &Loaded) -> Vec<[DVec3; 3]> {
    let geometry = &loaded.scene.geometry;
    let mut triangles = Vec::new();
    for instance in &geometry.instances {
        let mesh: &Mesh = &geometry.meshes[instance.mesh];
        for triangle in mesh.indices.chunks(3) {
            let corner = |i: usize| {
                let position = Vec3::from_array(mesh.positions[triangle[i] as usize]);
                instance
                    .world_from_object
                    .transform_point3(position.as_dvec3())
            };
            triangles.push([corner(0), corner(1), corner(2)]);
        }
    }
    triangles
}

/// Six times the signed volume inside a closed surface: positive if it faces outward.
fn volume(triangles: &[[DVec3; 3]]) -> f64 {
    triangles
        .iter()
        .map(|[a, b, c]| a.dot(b.cross(*c)))
        .sum::<f64>()
        / 6.0
}

#[test]
fn boxes_and_spheres_face_outward_mirrored_or_not() {
    for scale in [
        json!(1),
        json!([-1, 1, 1]),
        json!([-1, -1, -1]),
        json!([2, -1, 0.5]),
    ] {
        let loaded = scene(&json!({"geometry": [
            {"kind": "box", "min": [1, 1, 1], "max": [2, 3, 4], "transform": {"scale": scale}},
        ]}));
        let found = volume(&triangles(&loaded));
        assert!((found - 6.0).abs() < 1e-5, "{scale}: {found}");
        let loaded = scene(&json!({"geometry": [
            {"kind": "sphere", "center": [5, 0, 0], "radius": 1, "transform": {"scale": scale}},
        ]}));
        let found = volume(&triangles(&loaded)) / (4.0 / 3.0 * std::f64::consts::PI);
        assert!((0.97..1.0).contains(&found), "{scale}: {found}");
        assert_eq!(triangles(&loaded).len(), 960);
    }
}

#[test]
fn normals_agree_with_the_winding() {
    let tetrahedron = json!({
        "kind": "mesh",
        "positions": [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]],
        "indices": [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]],
        "transform": {"scale": [-1, 2, 1]},
    });
    let turned = json!({"rotation_degrees": [20, 30, 40], "scale": [1, -2, 3]});
    let loaded = scene(&json!({"geometry": [
        tetrahedron,
        {"kind": "box", "min": [1, 1, 1], "max": [2, 3, 4], "transform": turned},
        {"kind": "sphere", "center": [0, 0, 0], "radius": 1, "transform": turned},
        {"kind": "quad", "corner": [0, 0, 0], "edge_u": [1, 0, 0], "edge_v": [0, 0, -1]},
    ]}));
    for mesh in &loaded.scene.geometry.meshes {
        for triangle in mesh.indices.chunks(3) {
            let [a, b, c] =
                [0, 1, 2].map(|i| Vec3::from_array(mesh.positions[triangle[i] as usize]));
            let face = (b - a).cross(c - a);
            for vertex in triangle {
                let normal = Vec3::from_array(mesh.normals[*vertex as usize]);
                assert!(normal.dot(face) > 0.0, "{}: {normal} {face}", mesh.name);
            }
        }
    }
    for instance in &loaded.scene.geometry.instances {
        assert!(instance.world_from_object.matrix3.determinant() > 0.0);
    }
}

#[test]
fn rotations_turn_about_fixed_x_then_y_then_z() {
    let loaded = scene(&json!({"geometry": [{
        "kind": "mesh", "positions": [[0, 1, 0], [1, 0, 0], [0, 0, 1]], "indices": [[0, 1, 2]],
        "transform": {"rotation_degrees": [90, 90, 0], "translation": [10, 0, 0]},
    }]}));
    let [[a, b, c]] = triangles(&loaded)[..] else {
        panic!()
    };
    // +Y turns to +Z about x, then to +X about y.
    assert!((a - DVec3::new(11.0, 0.0, 0.0)).length() < 1e-6, "{a}");
    assert!((b - DVec3::new(10.0, 0.0, -1.0)).length() < 1e-6, "{b}");
    assert!((c - DVec3::new(10.0, -1.0, 0.0)).length() < 1e-6, "{c}");
}

#[test]
fn primitives_of_one_material_share_a_mesh_unless_far_apart() {
    let boxes = |at: f64| json!({"kind": "box", "min": [at, 0, 0], "max": [at + 1.0, 1, 1]});
    let loaded = scene(&json!({"geometry": [boxes(0.0), boxes(5.0), boxes(9e6)]}));
    let geometry = &loaded.scene.geometry;
    assert_eq!((geometry.meshes.len(), geometry.materials.len()), (2, 1));
    // Far from the origin the vertices stay exact, as they are relative to an anchor.
    let far = triangles(&loaded).last().unwrap().map(|corner| corner.x);
    assert!(far.iter().all(|x| *x == 9e6 || *x == 9e6 + 1.0), "{far:?}");
}

#[test]
fn lights_and_media_keep_their_meaning() {
    let loaded = scene(&json!({
        "lights": [
            {"kind": "spot", "position": [0, 3, 0], "direction": [0, -2, 0], "intensity": 5,
             "inner_angle_degrees": 45, "outer_angle_degrees": 60},
        ],
        "media": [
            {"kind": "height_fog", "sigma_t": [1, 2, 4], "albedo": 0.75, "falloff": 0.5,
             "up": [0, 0, 3], "density_scale": 2, "emission": 1},
        ],
        "render": {"relative_error": 0.01},
    }));
    let Light::Spot(spot) = &loaded.scene.lights[0] else {
        panic!()
    };
    assert_eq!(spot.direction, Vec3::NEG_Y);
    assert_eq!(spot.intensity, [5.0; 3]);
    assert!((spot.outer_angle - std::f32::consts::FRAC_PI_3).abs() < 1e-6);
    let fog = &loaded.scene.media[0];
    assert_eq!(fog.sigma_s, [1.5, 3.0, 6.0]);
    assert_eq!(fog.sigma_a, [0.5, 1.0, 2.0]);
    assert_eq!(fog.emission, [2.0; 3]);
    assert!(matches!(
        fog.shape,
        MediumShape::HeightFog { up: Vec3::Z, .. }
    ));
    assert_eq!(loaded.scene.render.stop, StopRule::RelativeError(0.01));
}

#[test]
fn facts_know_the_narrowest_lobe_of_a_phase_function_and_whether_there_is_one() {
    for (phase, anisotropic, largest) in [
        (json!({"kind": "henyey_greenstein", "g": -0.25}), true, 0.25),
        (json!({"kind": "henyey_greenstein", "g": 0}), false, 0.0),
        (
            json!({"kind": "two_lobes", "g_forward": 0.75, "g_backward": -0.25, "forward_share": 0.5}),
            true,
            0.75,
        ),
        (
            json!({"kind": "two_lobes", "g_forward": 0.75, "g_backward": -0.25, "forward_share": 0}),
            true,
            0.25,
        ),
        (
            json!({"kind": "two_lobes", "g_forward": 0, "g_backward": 0.5, "forward_share": 1}),
            false,
            0.0,
        ),
    ] {
        let loaded = scene(&json!({
            "media": [{"kind": "homogeneous", "sigma_s": 1, "sigma_a": 0, "phase": phase}],
        }));
        let facts = facts(&loaded.scene);
        assert_eq!(
            (facts.anisotropic, facts.max_abs_g),
            (anisotropic, largest),
            "{phase}"
        );
    }
}

#[test]
fn facts_of_a_homogeneous_box_are_those_of_its_diagonal() {
    let loaded = scene(&json!({
        "geometry": [{"kind": "box", "min": [0, 0, 0], "max": [1, 1, 1]}],
        "lights": [{"kind": "point", "position": [2, 0, 0], "intensity": 0}],
        "media": [
            {"kind": "homogeneous", "sigma_s": 0.3, "sigma_a": 0.1, "g": -0.5,
             "bounds": {"min": [0, 0, 0], "max": [2, 3, 6]}},
            {"kind": "homogeneous", "sigma_s": 0, "sigma_a": 0},
            {"kind": "sphere", "sigma_t": 0.3, "albedo": 0, "center": [1, 1, 1], "radius": 1},
        ],
    }));
    let facts = facts(&loaded.scene);
    assert_eq!(
        (facts.triangles, facts.instances, facts.point_lights),
        (12, 1, 0)
    );
    assert_eq!(
        (facts.media, facts.scatters, facts.anisotropic),
        (2, true, true)
    );
    assert!((facts.max_abs_g - 0.5).abs() < 1e-7 && (facts.max_albedo - 0.75).abs() < 1e-6);
    let expected = 0.4 * 7.0 + 0.3 * 4.0 / 3.0;
    assert!(
        (facts.optical_thickness - expected).abs() < 1e-5,
        "{}",
        facts.optical_thickness
    );
    assert_eq!(facts.bounds.max, DVec3::new(2.0, 3.0, 6.0));
}

#[test]
fn height_fog_thickness_is_the_integral_along_the_climbing_diagonal() {
    let loaded = scene(&json!({"media": [
        {"kind": "height_fog", "sigma_t": 0.2, "albedo": 1, "falloff": 0.5, "origin": [0, 1, 0],
         "bounds": {"min": [0, 0, 0], "max": [3, 4, 12]}},
    ]}));
    let steps = 100_000;
    let mean = (0..steps)
        .map(|i| 4.0 * (f64::from(i) + 0.5) / f64::from(steps))
        .map(|y| (-0.5 * (y - 1.0)).exp())
        .sum::<f64>()
        / f64::from(steps);
    let found = facts(&loaded.scene).optical_thickness;
    assert!((found - 0.2 * 13.0 * mean).abs() < 1e-6, "{found}");
}

#[test]
fn an_empty_scene_has_bounds_around_the_camera() {
    let facts = facts(&scene(&json!({})).scene);
    assert_eq!(facts.surface_bounds, None);
    assert_eq!(facts.bounds.min, DVec3::new(-1.0, 0.0, -1.0));
    assert_eq!(facts.optical_thickness, 0.0);
}

#[test]
fn lights_of_a_gltf_file_move_into_the_description_once() {
    let Some(shared) = shared() else { return };
    let folder = shared.join("data/meshes/bevy");
    let loaded = load(&folder.join("VolumetricFogExample.glb")).unwrap();
    assert!(!loaded.scene.lights.is_empty());
    assert_eq!(loaded.scene.lights.len(), loaded.description.lights.len());
    println!("{:?}", loaded.description.lights);
    let again = build(loaded.description.clone(), Some(&folder)).unwrap();
    assert_eq!(again.description, loaded.description);
    assert_eq!(again.scene.lights, loaded.scene.lights);
}

#[test]
fn candela_become_watts_by_the_luminous_efficacy() {
    let folder = tempfile::tempdir().unwrap();
    let file = json!({
        "asset": {"version": "2.0"},
        "scenes": [{"nodes": [0, 1]}],
        "nodes": [
            {"translation": [1, 2, 3], "scale": [2, 2, 2],
             "extensions": {"KHR_lights_punctual": {"light": 0}}},
            {"rotation": [-std::f64::consts::FRAC_1_SQRT_2, 0, 0, std::f64::consts::FRAC_1_SQRT_2],
             "extensions": {"KHR_lights_punctual": {"light": 1}}},
        ],
        "extensionsRequired": ["KHR_lights_punctual"],
        "extensions": {"KHR_lights_punctual": {"lights": [
            {"type": "point", "intensity": 683, "color": [1, 0.5, 0], "extras": {"a": 1}},
            {"type": "spot", "intensity": 1366, "spot": {"outerConeAngle": 0.5}},
        ]}},
    });
    std::fs::write(folder.path().join("a.gltf"), file.to_string()).unwrap();
    let loaded = load(&folder.path().join("a.gltf")).unwrap();
    let Light::Point(point) = &loaded.scene.lights[0] else {
        panic!()
    };
    assert_eq!(point.intensity, [1.0, 0.5, 0.0]);
    assert_eq!(point.position, DVec3::new(1.0, 2.0, 3.0));
    let Light::Spot(spot) = &loaded.scene.lights[1] else {
        panic!()
    };
    assert_eq!(spot.intensity, [2.0; 3]);
    assert!(
        (spot.direction - Vec3::NEG_Y).length() < 1e-6,
        "{}",
        spot.direction
    );
    assert!((spot.outer_angle - 0.5).abs() < 1e-6);
}

#[test]
fn a_bare_model_is_framed_lit_and_fogged() {
    let Some(shared) = shared() else { return };
    let loaded = load(&shared.join("data/meshes/gltf-samples/Box/Box.gltf")).unwrap();
    let facts = facts(&loaded.scene);
    assert_eq!((facts.directional_lights, facts.media), (1, 1));
    assert!(
        (0.5..1.5).contains(&facts.optical_thickness),
        "{}",
        facts.optical_thickness
    );
    let camera = loaded.scene.camera;
    let bounds = facts.surface_bounds.unwrap();
    let radius = 0.5 * (bounds.max - bounds.min).length();
    let distance = camera.position.distance(0.5 * (bounds.min + bounds.max));
    let half_view = (radius / distance).asin();
    assert!(half_view <= 0.51 * f64::from(camera.vertical_fov));
}
