//! Keyframes against closed forms, and what an animated scene shares with itself.

#![allow(
    clippy::unwrap_used,
    reason = "helpers of tests, too, fail by unwrapping"
)]

use std::sync::Arc;

use glam::DVec3;
use serde_json::{Value, json};
use tyndall_scene::description::CameraDescription;
use tyndall_scene::{
    Direction, Interpolate as _, Light, Scene, SceneDescription, SceneEdit, Track, apply_edit,
    build, check_camera, facts, seen_through,
};

fn scene_of(json: &Value) -> Scene {
    let description = SceneDescription::from_json(&json.to_string()).unwrap();
    build(description, None).unwrap().scene
}

/// A mesh that moves and turns, a box that stands, a spot that turns, a camera that drives.
fn moving() -> Value {
    json!({
        "version": 1,
        "camera": {"position": [0, 1, 9], "target": [0, 1, 0], "keyframes": [
            {"time_seconds": 0, "position": [0, 1, 9], "target": [0, 1, 0]},
            {"time_seconds": 4, "position": [2, 1, 9], "target": [0, 1, 0], "vertical_fov_degrees": 30},
        ]},
        "geometry": [
            {"kind": "mesh", "positions": [[0, 0, 0], [1, 0, 0], [0, 1, 0]], "indices": [[0, 1, 2]],
             "keyframes": [
                {"time_seconds": 1, "transform": {"translation": [0, 2, 0]}},
                {"time_seconds": 3, "transform": {"translation": [4, 2, 0],
                    "rotation_degrees": [0, 90, 0], "scale": 3}},
            ]},
            {"kind": "box", "min": [-1, 0, -1], "max": [1, 1, 1]},
        ],
        "lights": [
            {"kind": "environment", "radiance": 0.1},
            {"kind": "spot", "position": [0, 3, 0], "direction": [0, -1, 0], "intensity": 10,
             "keyframes": [
                {"time_seconds": 0, "position": [0, 3, 0], "direction": [0, -1, 0]},
                {"time_seconds": 2, "position": [2, 3, 0], "direction": [5, 0, 0]},
            ]},
        ],
        "render": {"technique": "reference"},
    })
}

/// Where the mesh's object point stands.
fn placed(scene: &Scene, point: DVec3) -> DVec3 {
    let instance = scene.geometry.instances[0];
    instance.world_from_object.transform_point3(point)
}

fn spot(scene: &Scene) -> (DVec3, DVec3) {
    let Light::Spot(spot) = &scene.lights[0] else {
        panic!("{:?}", scene.lights);
    };
    (spot.position, spot.direction.as_dvec3())
}

fn near(a: DVec3, b: DVec3) -> bool {
    (a - b).length() < 1e-7
}

#[test]
fn a_scene_between_keyframes_follows_the_closed_forms() {
    let scene = scene_of(&moving());
    assert_eq!(scene.duration_seconds(), Some(4.0));
    // Before its first key the mesh stands where that says, the rest of the scene at time 0.
    assert_eq!(placed(&scene, DVec3::X), DVec3::new(1.0, 2.0, 0.0));
    for (seconds, turned, scale, x) in [
        (1.0, 0.0, 1.0, 0.0),
        (1.5, 22.5, 1.5, 1.0),
        (3.0, 90.0, 3.0, 4.0),
        (9.0, 90.0, 3.0, 4.0),
    ] {
        let at = scene.at(seconds).unwrap();
        let (sin, cos) = f64::to_radians(turned).sin_cos();
        let expected = DVec3::new(x, 2.0, 0.0) + scale * DVec3::new(cos, 0.0, -sin);
        let found = placed(&at, DVec3::X);
        assert!(near(found, expected), "{seconds} s: {found} for {expected}");
    }
    for (seconds, degrees) in [
        (0.0, 0.0),
        (0.5, 22.5),
        (1.0, 45.0),
        (2.0, 90.0),
        (8.0, 90.0),
    ] {
        let (position, direction) = spot(&scene.at(seconds).unwrap());
        let (sin, cos) = f64::to_radians(degrees).sin_cos();
        assert!(
            near(position, DVec3::new(seconds.min(2.0), 3.0, 0.0)),
            "{position}"
        );
        assert!(
            near(direction, DVec3::new(sin, -cos, 0.0)),
            "{seconds} s: {direction}"
        );
    }
    let camera = scene.at(1.0).unwrap().camera;
    assert_eq!(camera.position, DVec3::new(0.5, 1.0, 9.0));
    assert!((camera.vertical_fov.to_degrees() - 45.0).abs() < 1e-4);
}

#[test]
fn a_scene_with_a_period_starts_over() {
    let mut json = moving();
    json["animation"] = json!({"period_seconds": 2.5});
    let scene = scene_of(&json);
    assert_eq!(
        (scene.duration_seconds(), scene.repeats()),
        (Some(2.5), true)
    );
    for seconds in [0.0, 0.75, 2.0] {
        let (first, later) = (scene.at(seconds).unwrap(), scene.at(seconds + 7.5).unwrap());
        assert_eq!(spot(&first), spot(&later));
        assert_eq!(first.geometry.instances, later.geometry.instances);
    }
    // At the end of a period everything is where it began.
    assert_eq!(spot(&scene.at(2.5).unwrap()), spot(&scene));
}

#[test]
fn a_time_shares_surfaces_and_what_did_not_move() {
    let scene = scene_of(&moving());
    let at = scene.at(2.0).unwrap();
    assert!(Arc::ptr_eq(&scene.geometry.surfaces, &at.geometry.surfaces));
    assert!(scene.geometry.same_surfaces(&at.geometry));
    assert_ne!(scene.geometry, at.geometry);
    assert_eq!(scene.geometry.instances[1], at.geometry.instances[1]);
    // The mesh stands still until 1 s and after 3 s: not even its placement is another one.
    assert_eq!(scene.geometry, scene.at(0.9).unwrap().geometry);
    let end = scene.at(3.0).unwrap();
    assert_eq!(end.geometry, end.at(5.0).unwrap().geometry);
}

#[test]
fn bounds_over_all_times_hold_every_placement_and_stand_still() {
    let scene = scene_of(&moving());
    let swept = facts(&scene).swept_bounds.unwrap();
    for step in 0..=40 {
        let at = scene.at(0.1 * f64::from(step)).unwrap();
        assert_eq!(facts(&at).swept_bounds, Some(swept));
        let now = facts(&at).surface_bounds.unwrap();
        assert!(
            now.min.cmpge(swept.min - 1e-9).all(),
            "{now:?} in {swept:?}"
        );
        assert!(
            now.max.cmple(swept.max + 1e-9).all(),
            "{now:?} in {swept:?}"
        );
    }
    // Without a turn the box is exact: the mesh of a side of 1 m slides from y = 0 to 5.
    let mut json = moving();
    json["geometry"][0]["keyframes"] = json!([
        {"time_seconds": 0, "transform": {"translation": [0, 0, 0]}},
        {"time_seconds": 1, "transform": {"translation": [0, 5, 0]}},
    ]);
    let swept = facts(&scene_of(&json)).swept_bounds.unwrap();
    assert_eq!(
        (swept.min, swept.max),
        (DVec3::new(-1.0, 0.0, -1.0), DVec3::new(1.0, 6.0, 1.0))
    );
}

#[test]
fn an_animated_primitive_stands_like_a_still_one() {
    let transform =
        json!({"translation": [3, 1, -2], "rotation_degrees": [10, 20, 30], "scale": [-1, 2, 1]});
    let mut json = moving();
    json["geometry"] =
        json!([{"kind": "box", "min": [-1, 0, -1], "max": [1, 1, 1], "transform": transform}]);
    let still = scene_of(&json);
    json["geometry"][0] = json!({"kind": "box", "min": [-1, 0, -1], "max": [1, 1, 1], "keyframes": [
        {"time_seconds": 0, "transform": {"scale": [-2, 1, 1]}},
        {"time_seconds": 2, "transform": transform},
    ]});
    let moved = scene_of(&json).at(2.0).unwrap();
    let triangles = |scene: &Scene| -> Vec<DVec3> {
        let instance = scene.geometry.instances[0];
        assert!(instance.world_from_object.matrix3.determinant() > 0.0);
        let mesh = &scene.geometry.meshes[instance.mesh];
        let vertex = |i: &u32| DVec3::from_array(mesh.positions[*i as usize].map(f64::from));
        let world = |p| instance.world_from_object.transform_point3(p);
        mesh.indices.iter().map(vertex).map(world).collect()
    };
    let (a, b) = (triangles(&still), triangles(&moved));
    assert_eq!(a.len(), 36);
    // The winding may start at another corner: normals and middles tell.
    let faces = |corners: &[DVec3]| -> Vec<(DVec3, DVec3)> {
        let face = |t: &[DVec3]| ((t[1] - t[0]).cross(t[2] - t[0]), (t[0] + t[1] + t[2]) / 3.0);
        corners.chunks(3).map(face).collect()
    };
    for ((normal_a, middle_a), (normal_b, middle_b)) in faces(&a).iter().zip(faces(&b)) {
        assert!(
            (*normal_a - normal_b).length() < 1e-4,
            "{normal_a} {normal_b}"
        );
        assert!(
            (*middle_a - middle_b).length() < 1e-5,
            "{middle_a} {middle_b}"
        );
    }
}

#[test]
fn edits_keep_the_time_and_can_change_it() {
    let description = SceneDescription::from_json(&moving().to_string()).unwrap();
    let loaded = build(description, None).unwrap();
    let seek = SceneEdit {
        time_seconds: Some(1.0),
        ..SceneEdit::default()
    };
    let (description, scene) = apply_edit(&loaded.description, &loaded.scene, &seek).unwrap();
    assert_eq!(spot(&scene).0.x, 1.0);
    let expose = SceneEdit {
        exposure_ev: Some(2.0),
        ..SceneEdit::default()
    };
    let (_, scene) = apply_edit(&description, &scene, &expose).unwrap();
    assert_eq!((scene.time_seconds, spot(&scene).0.x), (1.0, 1.0));
}

#[test]
fn a_steered_camera_leaves_its_track_and_nothing_else() {
    let description = SceneDescription::from_json(&moving().to_string()).unwrap();
    let loaded = build(description, None).unwrap();
    for seconds in [0.0, 1.3] {
        let before = loaded.scene.at(seconds).unwrap();
        let camera = CameraDescription {
            position: [0.3, 1.7, 2.9],
            ..loaded.description.camera.clone()
        };
        let edit = SceneEdit {
            camera: Some(CameraDescription {
                keyframes: Vec::new(),
                ..camera.clone()
            }),
            ..SceneEdit::default()
        };
        let edited = apply_edit(&loaded.description, &before, &edit).unwrap();
        check_camera(&camera).unwrap();
        let scene = seen_through(&before, &camera);
        assert_eq!(scene, edited.1);
        assert_eq!(scene.at(3.0).unwrap().camera, scene.camera);
    }
}

#[test]
fn hostile_times_are_refused_by_name() {
    let scene = scene_of(&moving());
    for seconds in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, -1.0, 1e30] {
        let error = scene.at(seconds).unwrap_err();
        assert_eq!(error.path(), Some("time_seconds"), "{error}");
        assert!(error.to_string().contains("0 to 1e6"), "{error}");
    }
    assert_eq!(scene.at(1e6).unwrap().time_seconds, 1e6);
}

#[test]
fn a_track_refuses_no_keys_disorder_and_numbers_that_are_not_finite() {
    let key = DVec3::ZERO;
    for (keys, path) in [
        (vec![], "list"),
        (vec![(0.0, key), (0.0, key)], "list[1].time_seconds"),
        (vec![(1.0, key), (0.5, key)], "list[1].time_seconds"),
        (vec![(f64::NAN, key)], "list[0].time_seconds"),
        (vec![(0.0, key), (1.0, DVec3::splat(f64::NAN))], "list[1]"),
    ] {
        let error = Track::new("list", keys).unwrap_err();
        assert_eq!(error.path(), Some(path), "{error}");
    }
}

#[test]
fn directions_turn_at_a_constant_rate() {
    let (a, b) = (Direction(DVec3::X), Direction(DVec3::new(-0.8, 0.6, 0.0)));
    let whole = a.0.angle_between(b.0);
    for fraction in [0.1, 0.25, 0.5, 0.9] {
        let between = a.between(b, fraction).0;
        assert!((between.length() - 1.0).abs() < 1e-12);
        assert!((a.0.angle_between(between) - fraction * whole).abs() < 1e-9);
    }
    assert_eq!(a.between(a, 0.5), a);
}

#[test]
fn a_placement_that_flattens_is_refused_with_its_keyframe() {
    let mut json = moving();
    json["geometry"][0]["keyframes"][1]["transform"]["scale"] = json!([1e6, 1e-6, 1e-6]);
    let description = SceneDescription::from_json(&json.to_string()).unwrap();
    let error = build(description, None).unwrap_err();
    assert_eq!(
        error.path(),
        Some("geometry[0].keyframes[1].transform.scale"),
        "{error}"
    );
}
