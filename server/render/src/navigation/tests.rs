//! Steering through rooms, streets, boxes and clouds.

use serde_json::{Value, json};
use tyndall_scene::{SceneDescription, presets};

use glam::DVec3;
use tyndall_scene::Scene;
use tyndall_scene::description::Navigation;

use super::{Darkness, Guide, Picked};

fn scene_of(parts: &Value) -> Scene {
    let description = SceneDescription::from_json(&parts.to_string()).expect("a valid scene");
    tyndall_scene::build(description, None)
        .expect("valid")
        .scene
}

fn guide_of(parts: &Value) -> Guide {
    Guide::build(&scene_of(parts), None).expect("a guide")
}

/// Diagonal of what is framed. Unit: m.
fn extent(guide: &Guide) -> f64 {
    let bounds = guide.facts().bounds;
    (bounds.max - bounds.min).length()
}

fn scene(position: [f64; 3], target: [f64; 3], geometry: &Value, media: &Value) -> Value {
    json!({"version": 1, "camera": {"position": position, "target": target},
        "geometry": geometry, "media": media,
        "lights": [{"kind": "point", "position": [0, 2, 0], "intensity": 10}]})
}

fn block(min: [f64; 3], max: [f64; 3]) -> Value {
    json!({"kind": "box", "min": min, "max": max})
}

fn ground(half: f64) -> Value {
    json!({"kind": "quad", "corner": [-half, 0, half], "edge_u": [2.0 * half, 0, 0],
        "edge_v": [0, 0, -2.0 * half]})
}

/// A room of 6 by 3 by 8 metres, as walls.
fn room() -> Value {
    json!([
        block([-3.1, 0.0, -4.0], [-3.0, 3.0, 4.0]),
        block([3.0, 0.0, -4.0], [3.1, 3.0, 4.0]),
        block([-3.0, 0.0, -4.1], [3.0, 3.0, -4.0]),
        block([-3.0, 0.0, 4.0], [3.0, 3.0, 4.1]),
        block([-3.0, -0.1, -4.0], [3.0, 0.0, 4.0]),
        block([-3.0, 3.0, -4.0], [3.0, 3.1, 4.0]),
    ])
}

#[test]
fn presets_are_steered_as_what_they_are() {
    let expected = [
        ("fogged_hall", Navigation::Look),
        ("light_shafts", Navigation::Look),
        ("cornell_fog", Navigation::Orbit),
        ("street_night", Navigation::Look),
        ("swinging_lamp", Navigation::Look),
        ("smoke_plume", Navigation::Orbit),
        ("cloud", Navigation::Orbit),
    ];
    for (name, mode) in expected {
        let description = presets::description(name).expect("a preset");
        let scene = tyndall_scene::build(description, None)
            .expect("valid")
            .scene;
        let guide = Guide::build(&scene, None).expect("a guide");
        let facts = guide.facts();
        println!("{name}: {facts:?}");
        assert_eq!(facts.mode, mode, "{name}");
        assert_eq!(facts.overview.is_some(), mode == Navigation::Look, "{name}");
        let way = facts.pivot.distance(scene.camera.position);
        assert!(way < 2.0 * extent(&guide), "{name}: pivot {way} m away");
    }
}

#[test]
fn inside_a_room_and_between_houses_one_looks_around() {
    let inside = scene([0.0, 1.6, 3.0], [0.0, 1.5, 0.0], &room(), &json!([]));
    assert_eq!(guide_of(&inside).facts().mode, Navigation::Look);
    let mut houses = vec![ground(80.0)];
    for z in [-30.0, -15.0, 0.0, 15.0, 30.0] {
        houses.push(block([-12.0, 0.0, z - 6.0], [-6.0, 7.0, z + 6.0]));
        houses.push(block([6.0, 0.0, z - 6.0], [12.0, 7.0, z + 6.0]));
    }
    let street = scene(
        [0.0, 1.7, 8.0],
        [0.0, 2.0, -8.0],
        &json!(houses),
        &json!([]),
    );
    assert_eq!(guide_of(&street).facts().mode, Navigation::Look);
    // A pavilion: pillars, a roof and a floor.
    let mut pavilion = vec![
        block([-5.0, -0.2, -5.0], [5.0, 0.0, 5.0]),
        block([-5.0, 3.0, -5.0], [5.0, 3.2, 5.0]),
    ];
    for i in 0..5 {
        let at = -4.0 + 2.0 * f64::from(i);
        for (x, z) in [(at, -4.5), (at, 4.5), (-4.5, at), (4.5, at)] {
            pavilion.push(block([x - 0.25, 0.0, z - 0.25], [x + 0.25, 3.0, z + 0.25]));
        }
    }
    let pavilion = scene(
        [0.0, 1.6, 2.0],
        [0.0, 1.6, 0.0],
        &json!(pavilion),
        &json!([]),
    );
    assert_eq!(guide_of(&pavilion).facts().mode, Navigation::Look);
}

#[test]
fn things_seen_from_outside_and_media_alone_are_orbited() {
    let model = json!([ground(500.0), block([-1.0, 0.0, -1.0], [1.0, 2.0, 1.0])]);
    for eye in [[0.0, 1.0, 5.0], [4.0, 6.0, 4.0], [0.0, 0.5, 1.3]] {
        let guide = guide_of(&scene(eye, [0.0, 1.0, 0.0], &model, &json!([])));
        assert_eq!(guide.facts().mode, Navigation::Orbit, "{eye:?}");
        assert!(
            extent(&guide) < 4.0,
            "the ground is framed: {} m",
            extent(&guide)
        );
    }
    // A tessellated ground in the mesh of the model, as a file may hold it.
    let tiles: Vec<[f64; 3]> = (0..121)
        .map(|i| {
            [
                f64::from(i % 11 * 100 - 500),
                0.0,
                f64::from(i / 11 * 100 - 500),
            ]
        })
        .collect();
    let mut positions = tiles.clone();
    positions.extend([[0.0, 0.5, 0.0], [1.0, 0.5, 0.0], [0.0, 1.5, 0.0]]);
    let mut indices: Vec<[u32; 3]> = (0..110)
        .filter(|i| i % 11 < 10)
        .flat_map(|i| [[i, i + 11, i + 1], [i + 1, i + 11, i + 12]])
        .collect();
    indices.push([121, 122, 123]);
    let one_mesh = json!([{"kind": "mesh", "positions": positions, "indices": indices}]);
    let guide = guide_of(&scene(
        [0.0, 1.0, 5.0],
        [0.0, 1.0, 0.0],
        &one_mesh,
        &json!([]),
    ));
    assert!(
        extent(&guide) < 2.0,
        "the ground is framed: {} m",
        extent(&guide)
    );
    let room_from_outside = scene([0.0, 1.6, 12.0], [0.0, 1.5, 0.0], &room(), &json!([]));
    assert_eq!(guide_of(&room_from_outside).facts().mode, Navigation::Orbit);
    // Fog that fills space, around a light at (0, 2, 0).
    let fog = json!([{"kind": "homogeneous", "sigma_t": 0.01, "albedo": 0.5}]);
    let guide = guide_of(&scene([0.0, 2.0, 5.0], [0.0, 2.0, 4.0], &json!([]), &fog));
    assert_eq!(guide.facts().bounds.min, DVec3::new(-1.0, 1.0, -1.0));
    assert_eq!(guide.facts().pivot, DVec3::new(0.0, 2.0, 0.0));
    let smoke = json!([{"kind": "sphere", "center": [3, 0, 0], "radius": 1, "sigma_t": 2, "albedo": 0.5},
        {"kind": "homogeneous", "sigma_t": 0.01, "albedo": 0.5}]);
    let guide = guide_of(&scene([3.0, 0.0, 6.0], [3.0, 0.0, 5.0], &json!([]), &smoke));
    assert_eq!(guide.facts().mode, Navigation::Orbit);
    assert!(
        guide.facts().pivot.distance(DVec3::new(3.0, 0.0, 0.0)) < 0.4,
        "{:?}",
        guide.facts()
    );
    assert!(extent(&guide) < 4.0);
}

#[test]
fn a_glowing_sky_box_neither_surrounds_nor_is_framed() {
    let mut sky = block([-200.0, -200.0, -200.0], [200.0, 200.0, 200.0]);
    sky["material"] = json!({"base_color": 0, "emission": 1});
    let parts = json!([sky, block([-1.0, 0.0, -1.0], [1.0, 2.0, 1.0])]);
    let guide = guide_of(&scene([0.0, 1.0, 6.0], [0.0, 1.0, 0.0], &parts, &json!([])));
    assert_eq!(guide.facts().mode, Navigation::Orbit);
    assert!(extent(&guide) < 4.0);
}

#[test]
fn what_a_scene_declares_wins() {
    let scene = scene_of(&scene(
        [0.0, 1.6, 3.0],
        [0.0, 1.5, 0.0],
        &room(),
        &json!([]),
    ));
    let guide = Guide::build(&scene, Some(Navigation::Fly)).expect("a guide");
    assert_eq!(guide.facts().mode, Navigation::Fly);
}

#[test]
fn the_pivot_is_what_one_looks_at_and_never_behind_a_wall() {
    let behind = scene([0.0, 1.6, 3.0], [0.0, 1.6, -20.0], &room(), &json!([]));
    let pivot = guide_of(&behind).facts().pivot;
    assert!(pivot.distance(DVec3::new(0.0, 1.6, -4.0)) < 0.01, "{pivot}");
    let model = json!([block([-1.0, -1.0, -1.0], [1.0, 1.0, 1.0])]);
    let center = guide_of(&scene([0.0, 0.0, 6.0], [0.0, 0.0, 0.0], &model, &json!([])));
    assert_eq!(center.facts().pivot, DVec3::ZERO);
    // A camera of a file that looks 1 m ahead, at a thing 5 m away.
    let ahead = guide_of(&scene([0.0, 0.0, 6.0], [0.0, 0.0, 5.0], &model, &json!([])));
    assert!(ahead.facts().pivot.distance(DVec3::Z) < 1e-4);
}

#[test]
fn a_step_stops_before_a_wall_slides_along_it_and_may_leave_it() {
    let guide = guide_of(&scene(
        [0.0, 1.6, 3.0],
        [0.0, 1.5, 0.0],
        &room(),
        &json!([]),
    ));
    let margin = guide.margin();
    let stopped = guide.walk(DVec3::new(0.0, 1.5, 0.0), DVec3::new(10.0, 1.5, 0.0));
    assert!((stopped.x - (3.0 - margin)).abs() < 1e-4, "{stopped}");
    let slid = guide.walk(DVec3::new(0.0, 1.5, 0.0), DVec3::new(6.0, 1.5, 2.0));
    assert!((slid.x - (3.0 - margin)).abs() < 1e-4, "{slid}");
    assert!((slid.z - 2.0).abs() < 1e-4, "{slid}");
    let corner = guide.walk(DVec3::new(2.0, 1.5, -3.0), DVec3::new(9.0, 1.5, -9.0));
    assert!(corner.x < 3.0 && corner.z > -4.0, "{corner}");
    // Nearer than the margin already.
    let close = DVec3::new(2.999, 1.5, 0.0);
    assert_eq!(guide.walk(close, DVec3::new(3.5, 1.5, 0.0)).x, 2.999);
    let away = DVec3::new(0.0, 1.5, 0.0);
    assert!(guide.walk(close, away).distance(away) < 1e-9);
}

#[test]
fn an_orbit_that_comes_down_to_the_ground_goes_on_around() {
    let model = json!([ground(50.0), block([-1.0, 0.0, -1.0], [1.0, 2.0, 1.0])]);
    let guide = guide_of(&scene([0.0, 2.0, 8.0], [0.0, 1.0, 0.0], &model, &json!([])));
    let pivot = DVec3::new(0.0, 1.0, 0.0);
    let mut at = DVec3::new(0.0, 2.0, 8.0);
    let reach = at.distance(pivot);
    for _ in 0..200 {
        // Down and to the right, as a drag does.
        let way = at - pivot;
        let down = way.cross(DVec3::Y).normalize_or(DVec3::X);
        let turned =
            glam::DQuat::from_rotation_y(0.01) * glam::DQuat::from_axis_angle(down, -0.01) * way;
        at = guide.turn(
            at,
            pivot + turned.normalize_or(DVec3::X) * at.distance(pivot),
            pivot,
        );
        assert!(at.y > 0.9 * guide.margin(), "below the ground: {at}");
    }
    assert!(at.y < 0.1, "{at}");
    assert!((at.distance(pivot) - reach).abs() < 0.1 * reach, "{at}");
    assert!(at.x.abs() > 5.0, "it stood still: {at}");
}

#[test]
fn no_walk_leaves_a_closed_room() {
    let guide = guide_of(&scene(
        [0.0, 1.6, 3.0],
        [0.0, 1.5, 0.0],
        &room(),
        &json!([]),
    ));
    let mut at = DVec3::new(0.0, 1.6, 3.0);
    let mut state = 1_u64;
    let mut random = || {
        // A linear congruential generator (Knuth's MMIX constants).
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as f64 / f64::from(1_u32 << 31) - 0.5
    };
    for step in 0..20_000 {
        let way = 4.0 * DVec3::new(random(), random(), random());
        at = guide.walk(at, at + way);
        let inside = at.abs().cmple(DVec3::new(3.0, 3.0, 4.0)).all() && at.y > 0.0;
        assert!(inside, "step {step} ended at {at}");
    }
}

#[test]
fn numbers_that_are_no_places_are_left_to_the_rules_of_the_camera() {
    let guide = guide_of(&scene(
        [0.0, 1.6, 3.0],
        [0.0, 1.5, 0.0],
        &room(),
        &json!([]),
    ));
    let absurd = DVec3::new(1e300, 0.0, f64::NAN);
    assert!(guide.walk(DVec3::ZERO, absurd).y == 0.0);
}

#[test]
fn a_place_of_the_picture_is_a_surface_or_the_middle_of_a_medium() {
    let inside = scene_of(&scene(
        [0.0, 1.5, 3.0],
        [0.0, 1.5, 0.0],
        &room(),
        &json!([]),
    ));
    let guide = Guide::build(&inside, None).expect("a guide");
    let Some(Picked::Surface { point, normal }) = guide.pick(&inside, 1.5, [0.5, 0.5]) else {
        panic!("a wall")
    };
    assert!(point.distance(DVec3::new(0.0, 1.5, -4.0)) < 1e-3, "{point}");
    assert!(normal.distance(DVec3::Z) < 1e-6, "{normal}");
    let smoke = json!([{"kind": "sphere", "center": [0, 0, 0], "radius": 1, "sigma_t": 0.1, "albedo": 0.5}]);
    let smoke = scene_of(&scene([0.0, 0.0, 6.0], [0.0, 0.0, 0.0], &json!([]), &smoke));
    let guide = Guide::build(&smoke, None).expect("a guide");
    let Some(Picked::Medium { point }) = guide.pick(&smoke, 1.5, [0.5, 0.5]) else {
        panic!("smoke")
    };
    assert!(point.length() < 0.05, "{point}");
    assert_eq!(guide.pick(&smoke, 1.5, [0.0, 0.0]), None);
}

#[test]
fn a_thing_that_moves_is_picked_where_it_is() {
    let mut parts = scene([0.0, 0.0, 6.0], [0.0, 0.0, 0.0], &json!([]), &json!([]));
    let mut moving = block([-1.0, -1.0, -1.0], [1.0, 1.0, 1.0]);
    moving["keyframes"] = json!([
        {"time_seconds": 0, "transform": {"translation": [0, 0, 0]}},
        {"time_seconds": 1, "transform": {"translation": [0, 0, 2]}}]);
    parts["geometry"] = json!([moving]);
    let scene = scene_of(&parts);
    let guide = Guide::build(&scene, None).expect("a guide");
    let depth =
        |seconds: f64| match guide.pick(&scene.at(seconds).expect("a time"), 1.0, [0.5, 0.5]) {
            Some(Picked::Surface { point, .. }) => point.z,
            other => panic!("{other:?}"),
        };
    assert!((depth(0.0) - 1.0).abs() < 1e-4);
    assert!((depth(1.0) - 3.0).abs() < 1e-4);
}

#[test]
fn a_black_picture_is_explained() {
    let dark = |position: [f64; 3], target: [f64; 3], geometry: &Value, lit: bool| {
        let mut parts = scene(position, target, geometry, &json!([]));
        if !lit {
            parts["lights"] = json!([]);
        }
        let scene = scene_of(&parts);
        let guide = Guide::build(&scene, None).expect("a guide");
        guide.darkness(&scene, 1.5)
    };
    let center = [0.0, 1.5, 0.0];
    assert_eq!(
        dark([0.0, 1.5, 3.0], center, &room(), false),
        Darkness::NoLight
    );
    assert_eq!(
        dark([0.0, 1.5, 3.0], center, &room(), true),
        Darkness::Unlit
    );
    assert_eq!(
        dark([0.0, 1.5, -3.97], [0.0, 1.5, -5.0], &room(), true),
        Darkness::AtSurface
    );
    let solid = json!([block([-1.0, -1.0, -1.0], [1.0, 1.0, 1.0])]);
    assert_eq!(
        dark([0.0; 3], [0.0, 0.0, -1.0], &solid, true),
        Darkness::InsideSolid
    );
    assert_eq!(
        dark([0.0, 0.0, 5.0], [0.0, 0.0, 9.0], &solid, true),
        Darkness::LooksAway
    );
    // A sliver of it at the border of the picture is not what hides the light.
    assert_eq!(
        dark([0.0, 0.0, 7.0], [5.57, 0.0, 0.0], &solid, true),
        Darkness::LooksAway
    );
}
