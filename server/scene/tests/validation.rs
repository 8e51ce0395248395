//! Each rule refuses what breaks it and names path, found and allowed.

#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "helpers of tests, too, fail by unwrapping and say what they skip"
)]

use serde_json::{Value, json};
use tyndall_scene::{SceneDescription, SceneEdit, SceneError, apply_edit, build};

fn base() -> Value {
    json!({
        "version": 1,
        "camera": {"position": [0, 1, 4], "target": [0, 1, 0]},
        "geometry": [
            {"kind": "box", "min": [-1, 0, -1], "max": [1, 1, 1], "material": {"base_color": 0.5}},
            {"kind": "sphere", "center": [0, 2, 0], "radius": 0.5},
            {"kind": "quad", "corner": [0, 0, 0], "edge_u": [1, 0, 0], "edge_v": [0, 0, -1]},
            {"kind": "mesh", "positions": [[0, 0, 0], [1, 0, 0], [0, 1, 0]], "indices": [[0, 1, 2]]},
        ],
        "lights": [
            {"kind": "point", "position": [0, 3, 0], "intensity": 10},
            {"kind": "spot", "position": [0, 3, 0], "direction": [0, -2, 0],
             "intensity": [1, 2, 3], "outer_angle_degrees": 30},
            {"kind": "directional", "direction": [0, -1, 0], "irradiance": 1},
            {"kind": "environment", "radiance": 0.1},
        ],
        "media": [
            {"kind": "homogeneous", "sigma_s": 0.1, "sigma_a": 0.01,
             "bounds": {"min": [-5, 0, -5], "max": [5, 5, 5]}},
            {"kind": "height_fog", "sigma_t": 0.1, "albedo": 0.9, "falloff": 0.2},
            {"kind": "sphere", "sigma_t": 0.1, "albedo": [0.9, 0.8, 0.7],
             "center": [0, 0, 0], "radius": 1},
        ],
        "render": {"samples": 16},
    })
}

/// Sets the value at a JSON path such as `media[0].g`; `null` removes it.
fn set(scene: &mut Value, path: &str, value: Value) {
    let pointer = format!(
        "/{}",
        path.replace('[', "/").replace(']', "").replace('.', "/")
    );
    let (parent, name) = pointer.rsplit_once('/').unwrap();
    let parent = scene.pointer_mut(parent).unwrap();
    match parent {
        Value::Array(elements) => {
            let index: usize = name.parse().unwrap();
            if index == elements.len() {
                elements.push(value);
            } else {
                elements[index] = value;
            }
        }
        Value::Object(members) if value.is_null() => {
            members.remove(name);
        }
        Value::Object(members) => {
            members.insert(name.to_owned(), value);
        }
        _ => panic!("{path}"),
    }
}

fn parse(scene: &Value) -> Result<SceneDescription, SceneError> {
    SceneDescription::from_json(&scene.to_string())
}

/// Rows of `where | value | path | found | allowed`: what is set where, and the error's path
/// (`=` for the same), found and allowed (parts of them).
fn check(table: &str) {
    for row in table.lines().map(str::trim).filter(|row| !row.is_empty()) {
        let columns: Vec<&str> = row.split(" | ").collect();
        let [at, value, path, found, allowed] = columns[..] else {
            panic!("{row}");
        };
        let path = if path == "=" { at } else { path };
        let mut scene = base();
        set(&mut scene, at, serde_json::from_str(value).unwrap());
        let error = parse(&scene).expect_err(row);
        let SceneError::Invalid {
            path: error_path,
            found: error_found,
            allowed: error_allowed,
        } = &error
        else {
            panic!("{row}: {error}");
        };
        assert_eq!(error_path, path, "{row}: {error}");
        assert!(error_found.contains(found), "{row}: {error}");
        assert!(error_allowed.contains(allowed), "{row}: {error}");
        assert_eq!(error.path(), Some(path));
    }
}

#[test]
fn the_base_scene_is_valid_and_builds() {
    let description = parse(&base()).unwrap();
    let loaded = build(description, None).unwrap();
    assert_eq!(loaded.scene.lights.len(), 3);
    assert!(loaded.scene.environment.is_some());
    assert_eq!(loaded.scene.media.len(), 3);
    assert!(loaded.warnings.is_empty(), "{:?}", loaded.warnings);
}

#[test]
fn wrong_types_and_names_are_refused_at_their_exact_path() {
    check(
        r#"
        version | 2 | = | 2 | 1
        version | null | = | nothing | 1
        version | "1" | = | "1" | 1
        sky | 1 | = | unknown member `sky` | camera
        camera.fov | 50 | = | unknown member | vertical_fov_degrees
        camera.position | null | = | nothing | required
        camera.position | [0, 1] | = | length 2 | three numbers
        camera.position[1] | "up" | = | "up" | a number
        geometry | 5 | = | 5 | an array
        geometry[0].kind | "cone" | = | cone | gltf, obj, mesh
        geometry[0].kind | null | = | nothing | one of gltf
        geometry[0].kind | 7 | = | 7 | one of gltf
        geometry[0].size | 1 | = | unknown member | min
        geometry[0].min[2] | true | = | true | a number
        geometry[0].material.base_color | [1, 0, "red"] | geometry[0].material.base_color[2] | "red" | a number
        geometry[0].material.colour | 1 | = | unknown member | base_color
        geometry[3].indices[0][1] | -1 | = | -1 | whole number
        media[0].sigma_s | [1, 2] | = | length 2 | three numbers
        media[0].sigma_s | [1, 2, 3, 4] | = | 4 | three numbers
        media[0].sigma_s | {} | = | map | three numbers
        media[2].radius | null | = | nothing | required
        render.technique | "magic" | = | "magic" | instant_vpl
        render.width | -3 | = | -3 | whole number
        render.width | 1.5 | = | 1.5 | whole number
        name | "a\nb" | = | control character | printable
        "#,
    );
}

#[test]
fn camera_rules() {
    check(
        r#"
        camera.position[0] | 1e8 | = | 100000000 | −1e7 to 1e7
        camera.target | [0, 1, 4] | = | [0.0, 1.0, 4.0] | position
        camera.up | [0, 0, 0] | = | [0.0, 0.0, 0.0] | longer than
        camera.up | [0, 0, 2] | = | parallel | not parallel
        camera.vertical_fov_degrees | 180 | = | 180 | 0.1 to 170
        camera.vertical_fov_degrees | 0 | = | 0 | 0.1
        camera.exposure_ev | 25 | = | 25 | −24 to 24
        camera.keyframes | [{"time_seconds": 1, "position": [0, 0, 0], "target": [0, 0, 1]}, {"time_seconds": 1, "position": [0, 0, 0], "target": [0, 0, 1]}] | camera.keyframes[1].time_seconds | 1 | more than the keyframe before
        camera.keyframes | [{"time_seconds": 0, "position": [0, 0, 0], "target": [0, 1, 0]}] | camera.keyframes[0].up | parallel | not parallel
        camera.keyframes | [{"time_seconds": 0, "position": [0, 0, 0], "target": [0, 5, 1]}, {"time_seconds": 1, "position": [0, 0, 0], "target": [0, 5, -1]}] | camera.keyframes[1] | passes along up | never looks along up
        camera.keyframes | [{"time_seconds": 0, "position": [0, 0, 1], "target": [0, 0, 0]}, {"time_seconds": 1, "position": [0, 0, -1], "target": [0, 0, 0]}] | camera.keyframes[1] | passes along up | or at itself
        "#,
    );
}

#[test]
fn light_rules() {
    check(
        r#"
        lights[0].intensity | -1 | = | -1 | 0 to 1e12
        lights[0].intensity | [1, -1, 1] | lights[0].intensity[1] | -1 | 0 to
        lights[0].radius | 0 | = | 0 | 0.0001 to 1000
        lights[1].direction | [0, 0, 0] | = | [0.0 | longer
        lights[1].outer_angle_degrees | 90 | = | 90 | 0.1 to 89.9
        lights[1].inner_angle_degrees | 30 | = | 30 | 0 to 29.99
        lights[2].irradiance | 1e10 | = | 1 | 0 to 1e9
        lights[3].rotation_degrees | 400 | = | 400 | 360
        lights[3].map | "../sky.hdr" | = | .. | inside the scene
        lights[3].map | "sky.png" | = | sky.png | .hdr, .exr
        lights[4] | {"kind": "environment"} | = | a second environment, after lights[3] | at most one
        "#,
    );
}

#[test]
fn medium_rules() {
    check(
        r#"
        media[0].g | 1.2 | = | 1.2 | −0.999 to 0.999
        media[0].g | -1 | = | -1 | −0.999 to 0.999
        media[0].phase | {"kind": "henyey_greenstein", "g": 1.2} | media[0].phase.g | 1.2 | −0.999 to 0.999
        media[0].phase | {"kind": "henyey_greenstein", "gg": 0.5} | media[0].phase.gg | unknown member | g
        media[0].phase | {"kind": "two_lobes", "g_forward": 1, "g_backward": 0, "forward_share": 0.5} | media[0].phase.g_forward | 1 | −0.999 to 0.999
        media[0].phase | {"kind": "two_lobes", "g_forward": 0.8, "g_backward": -1, "forward_share": 0.5} | media[0].phase.g_backward | -1 | −0.999 to 0.999
        media[0].phase | {"kind": "two_lobes", "g_forward": 0.8, "g_backward": 0, "forward_share": 1.5} | media[0].phase.forward_share | 1.5 | 0 to 1
        media[0].phase | {"kind": "two_lobes", "g_forward": 0.8, "g_backward": 0} | media[0].phase.forward_share | nothing | required
        media[0].phase | {"kind": "mie"} | media[0].phase.kind | mie | henyey_greenstein
        media[0] | {"kind": "homogeneous", "sigma_s": 0.1, "sigma_a": 0, "g": 0.5, "phase": {"kind": "henyey_greenstein", "g": 0.5}} | media[0].g | 0.5 beside phase | g or phase
        media[0].sigma_s | -0.1 | = | -0.1 | 0 to 1e6
        media[1].albedo | [1, 1.1, 1] | media[1].albedo[1] | 1.1 | 0 to 1
        media[0].sigma_a | null | media[0] | sigma_s | sigma_s and sigma_a, or sigma_t and albedo
        media[0].sigma_t | 1 | media[0] | sigma_s and sigma_a and sigma_t | sigma_s and sigma_a, or sigma_t and albedo
        media[1].sigma_t | null | media[1] | albedo | sigma_s and sigma_a, or sigma_t and albedo
        media[0].emission | -1 | = | -1 | 0 to
        media[0].density_scale | -1 | = | -1 | 0 to 1e6
        media[1].falloff | -0.1 | = | -0.1 | 0 to 1000
        media[1].up | [0, 0, 0] | = | [0.0 | longer than
        media[2].radius | 0 | = | 0 | 1e−6 to
        media[0].bounds.max[1] | 0 | = | 0 | more than media[0].bounds.min[1]
        media[1] | {"kind": "height_fog", "sigma_t": 1, "albedo": 1, "falloff": 10, "bounds": {"min": [0, -100, 0], "max": [1, 1, 1]}} | media[1].falloff | e^1000 | at most 0.6
        media[3] | {"kind": "grid", "sigma_t": 1, "albedo": 1, "path": "/etc/x.vdb"} | media[3].path | absolute | inside the scene
        media[3] | {"kind": "grid", "sigma_t": 1, "albedo": 1, "path": "x.txt"} | media[3].path | x.txt | .vdb, .nvdb, .vol, .npy, .npz, .raw
        "#,
    );
}

#[test]
fn light_from_infinity_needs_finite_optical_depth() {
    check(
        r"
        media[0].bounds | null | lights[2] | optical depth is infinite, since media[0] fills all of space | bounds at media[0].bounds
        lights[2].direction | [1, 0, 0] | lights[2] | media[1] gets no thinner | from above
        media[1].falloff | 0 | lights[2] | media[1] | media[1].bounds
        media[1].up | [0, -1, 0] | lights[2] | media[1] | media[1].bounds
        ",
    );
    for harmless in [
        ("lights[2].irradiance", json!(0)),
        ("media[0].density_scale", json!(0)),
    ] {
        let mut scene = base();
        set(&mut scene, "media[0].bounds", json!(null));
        set(&mut scene, harmless.0, harmless.1);
        parse(&scene).unwrap();
    }
}

#[test]
fn geometry_rules() {
    check(
        r#"
        geometry[0].max[0] | -1 | = | -1 | geometry[0].min[0]
        geometry[1].radius | -1 | = | -1 | 1e−6 to 1e6
        geometry[2].edge_v | [2, 0, 0] | = | parallel | area
        geometry[2].edge_u | [0, 0, 0] | = | [0.0 | longer
        geometry[3].indices[0][2] | 3 | = | 3 | less than the number of positions, 3
        geometry[3].normals | [[0, 0, 1]] | = | 1 entries | one a position, 3
        geometry[3].texcoords | [[0, 0], [1, 0], [1e7, 0]] | geometry[3].texcoords[2][0] | 10000000 | −1e6 to 1e6
        geometry[3].material | {"base_color_texture": "x.png"} | geometry[3].texcoords | nothing | texture
        geometry[0].material | {"base_color": 1.5} | geometry[0].material.base_color | 1.5 | 0 to 1
        geometry[0].material | {"metallic": 2} | geometry[0].material.metallic | 2 | 0 to 1
        geometry[0].material | {"roughness": -1} | geometry[0].material.roughness | -1 | 0 to 1
        geometry[0].material | {"emission": -1} | geometry[0].material.emission | -1 | 0 to 1e9
        geometry[0].material | {"alpha_cutoff": 2} | geometry[0].material.alpha_cutoff | 2 | 0 to 1
        geometry[0].transform | {"scale": [1, 0, 1]} | geometry[0].transform.scale[1] | 0 | magnitude
        geometry[0].transform | {"rotation_degrees": [1e6, 0, 0]} | geometry[0].transform.rotation_degrees[0] | 1000000 | −36000 to 36000
        geometry[0].keyframes | [{"time_seconds": -1, "transform": {}}] | geometry[0].keyframes[0].time_seconds | -1 | 0 to 1e6
        geometry[0].keyframes | [{"time_seconds": 0, "transform": {}}, {"time_seconds": 1, "transform": {"scale": [1, -1, 1]}}] | geometry[0].keyframes[1].transform.scale[1] | -1 | sign
        lights[0].keyframes | [{"time_seconds": 2, "position": [0, 0, 0]}, {"time_seconds": 1, "position": [0, 0, 0]}] | lights[0].keyframes[1].time_seconds | 1 | more than the keyframe before
        lights[0].keyframes | [{"time_seconds": 0, "position": [0, 1e8, 0]}] | lights[0].keyframes[0].position[1] | 100000000 | 1e7
        lights[1].keyframes | [{"time_seconds": 0, "position": [0, 0, 0], "direction": [0, 0, 0]}] | lights[1].keyframes[0].direction | [0.0, 0.0, 0.0] | longer than
        lights[2].keyframes | [{"time_seconds": 0, "direction": [0, -1, 0]}, {"time_seconds": 1, "direction": [0, 3, 0]}] | lights[2].keyframes[1].direction | 3.0 | not opposite
        animation | {"period_seconds": 0} | animation.period_seconds | 0 | 0.001 to 1e6
        animation | {"period_seconds": 1e30} | animation.period_seconds | 1e+30 | 0.001 to 1e6
        geometry[4] | {"kind": "gltf", "path": "a.obj"} | geometry[4].path | a.obj | .gltf, .glb
        geometry[4] | {"kind": "gltf", "path": "a.glb", "luminous_efficacy": 0} | geometry[4].luminous_efficacy | 0 | 0.001 to 1e6
        "#,
    );
}

#[test]
fn paths_that_could_leave_the_folder_are_refused() {
    let bad = [
        ("", "empty"),
        ("/a.glb", "absolute"),
        ("\\a.glb", "absolute"),
        ("../a.glb", ".."),
        ("b/../../a.glb", ".."),
        ("file:///a.glb", "scheme"),
        ("http://host/a.glb", "scheme"),
        ("C:a.glb", "scheme or a drive"),
        ("b\\a.glb", "backslash"),
        ("a\u{0}.glb", "control character"),
    ];
    for (path, why) in bad {
        let mut scene = base();
        set(
            &mut scene,
            "geometry[4]",
            json!({"kind": "gltf", "path": path}),
        );
        let error = parse(&scene).unwrap_err().to_string();
        assert!(error.contains(why), "{error}");
        assert!(error.starts_with("geometry[4].path: found "), "{error}");
        assert!(error.contains("inside the scene's folder"), "{error}");
    }
}

#[test]
fn render_rules() {
    check(
        r#"
        render.width | 0 | = | 0 | 1 to 16384
        render.height | 16385 | = | 16385 | 1 to 16384
        render.samples | 0 | = | 0 | 1 to 65536
        render.time_seconds | 1 | = | time_seconds together with samples | at most one
        render.seed | 9007199254740992 | = | 9007199254740992 | 0 to 9007
        render.single_scattering | {"interleave": 3} | render.single_scattering.interleave | 3 | 0, 1, 2, 4 or 8
        render.single_scattering | {"steps": 5000} | render.single_scattering.steps | 5000 | 1 to 4096
        render.shadows | {"resolution": 8} | render.shadows.resolution | 8 | 16 to 8192
        render.shadows | {"mode": "soft"} | render.shadows.mode | soft | traced
        "#,
    );
    for (member, value, allowed) in [
        ("time_seconds", json!(0), "0.001 to 1e6"),
        ("relative_error", json!(2), "0.00001"),
    ] {
        let mut scene = base();
        set(&mut scene, "render", json!({member: value}));
        let error = parse(&scene).unwrap_err();
        assert!(error.to_string().contains("to "), "{error} {allowed}");
        assert_eq!(error.path(), Some(format!("render.{member}").as_str()));
    }
}

#[test]
fn text_that_is_not_json_names_line_and_column() {
    let error = SceneDescription::from_json("{\n  \"version\": }").unwrap_err();
    let SceneError::Syntax { line, column, .. } = error else {
        panic!("{error}");
    };
    assert_eq!((line, column), (2, 14));
    for bad in ["", "[", "{} {}", "nul", "{\"version\":1e999}", "\u{feff}{}"] {
        SceneDescription::from_json(bad).unwrap_err();
    }
    let deep = "[".repeat(100_000);
    SceneDescription::from_json(&deep).unwrap_err();
}

#[test]
fn duplicate_members_are_refused() {
    for (text, path) in [
        ("{\"version\":1,\"version\":1}", "version"),
        (
            "{\"version\":1,\"camera\":{\"position\":[0,0,1],\"target\":[0,0,0]},\
              \"media\":[{\"kind\":\"sphere\",\"g\":0,\"g\":0.5}]}",
            "media[0].g",
        ),
    ] {
        let error = SceneDescription::from_json(text).unwrap_err();
        assert_eq!(error.path(), Some(path), "{error}");
        assert!(error.to_string().contains("twice"), "{error}");
    }
}

#[test]
fn a_scene_without_a_folder_may_not_name_files() {
    let mut scene = base();
    set(
        &mut scene,
        "geometry[4]",
        json!({"kind": "gltf", "path": "a.glb"}),
    );
    let error = build(parse(&scene).unwrap(), None).unwrap_err();
    assert_eq!(error.path(), Some("geometry[4].path"));
    assert!(error.to_string().contains("without a folder"), "{error}");
}

#[test]
fn missing_files_of_later_versions_are_found_now() {
    let folder = tempfile::tempdir().unwrap();
    for (at, value, path) in [
        ("lights[3].map", json!("sky.hdr"), "lights[3].map"),
        (
            "media[3]",
            json!({"kind": "grid", "sigma_t": 1, "albedo": 1, "path": "smoke.vdb"}),
            "media[3].path",
        ),
    ] {
        let mut scene = base();
        set(&mut scene, at, value);
        let error = build(parse(&scene).unwrap(), Some(folder.path())).unwrap_err();
        assert!(matches!(error, SceneError::Io { .. }), "{error}");
        assert_eq!(error.path(), Some(path));
    }
}

#[cfg(unix)]
#[test]
fn links_that_leave_the_folder_are_refused() {
    let outside = tempfile::tempdir().unwrap();
    std::fs::write(outside.path().join("secret.glb"), b"x").unwrap();
    let folder = tempfile::tempdir().unwrap();
    let link = folder.path().join("a.glb");
    std::os::unix::fs::symlink(outside.path().join("secret.glb"), link).unwrap();
    let mut scene = base();
    set(
        &mut scene,
        "geometry[4]",
        json!({"kind": "gltf", "path": "a.glb"}),
    );
    let error = build(parse(&scene).unwrap(), Some(folder.path())).unwrap_err();
    assert!(error.to_string().contains("link that leaves"), "{error}");
}

#[test]
fn edits_keep_the_geometry_and_the_rules() {
    let loaded = build(parse(&base()).unwrap(), None).unwrap();
    let edit: SceneEdit = serde_json::from_value(json!({
        "exposure_ev": 2,
        "media": [{"kind": "homogeneous", "sigma_t": 1, "albedo": 0.5,
                   "bounds": {"min": [0, 0, 0], "max": [1, 1, 1]}}],
    }))
    .unwrap();
    let (description, scene) = apply_edit(&loaded.description, &loaded.scene, &edit).unwrap();
    assert_eq!(scene.geometry, loaded.scene.geometry);
    assert_eq!(scene.camera.exposure_ev, 2.0);
    assert_eq!(scene.media.len(), 1);
    assert_eq!(scene.media[0].sigma_s, [0.5; 3]);
    assert_eq!(scene.lights, loaded.scene.lights);
    assert_eq!(description.media.len(), 1);

    for (edit, path) in [
        (json!({"exposure_ev": 99}), "camera.exposure_ev"),
        (
            json!({"media": [{"kind": "homogeneous", "sigma_t": 1, "albedo": 0.5}]}),
            "lights[2]",
        ),
        (
            json!({"lights": [{"kind": "environment", "map": "sky.hdr"}]}),
            "lights[0].map",
        ),
    ] {
        let edit: SceneEdit = serde_json::from_value(edit).unwrap();
        let error = apply_edit(&loaded.description, &loaded.scene, &edit).unwrap_err();
        assert_eq!(error.path(), Some(path), "{error}");
    }
}

#[test]
fn an_edit_parses_with_exact_paths() {
    let error = tyndall_scene::parse_json::<SceneEdit>(
        r#"{"media":[{"kind":"sphere","sigma_t":1,"albedo":1,"center":[0,0,"z"],"radius":1}]}"#,
    )
    .unwrap_err();
    assert_eq!(error.path(), Some("media[0].center[2]"), "{error}");
}

#[test]
fn names_have_at_most_200_characters() {
    let mut scene = base();
    set(&mut scene, "name", json!("ü".repeat(200)));
    parse(&scene).unwrap();
    set(&mut scene, "name", json!("ü".repeat(201)));
    let error = parse(&scene).unwrap_err().to_string();
    assert_eq!(
        error,
        "name: found 201 characters, allowed at most 200 characters"
    );
}

#[test]
fn too_much_is_refused_with_the_limit() {
    let mut scene = base();
    let light = json!({"kind": "point", "position": [0, 0, 0], "intensity": 1});
    set(&mut scene, "lights", Value::Array(vec![light; 5000]));
    let error = parse(&scene).unwrap_err();
    assert!(
        matches!(error, SceneError::Limit { limit: 4096, .. }),
        "{error}"
    );
    let text = format!("{{\"name\":\"{}\"}}", "x".repeat(17 << 20));
    let error = SceneDescription::from_json(&text).unwrap_err();
    assert!(matches!(error, SceneError::Limit { .. }), "{error}");
}
