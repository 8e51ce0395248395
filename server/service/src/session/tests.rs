//! What camera messages and edits cost, and that neither loses the other.

use tyndall_scene::{build, presets};

use super::*;

fn hall() -> Session {
    let description = presets::description("fogged_hall").expect("a preset");
    let loaded = build(description, None).expect("the preset is valid");
    let accepts = Accepts {
        jpeg: true,
        png: true,
    };
    Session::new(1, "token".to_owned(), &loaded, accepts)
}

fn pose(x: f64) -> CameraPose {
    CameraPose {
        position: [x, 1.6, 3.0],
        target: [0.0, 1.5, -4.0],
        up: [0.0, 1.0, 0.0],
        vertical_fov_degrees: 60.0,
    }
}

fn edit(session: &Session, pose: CameraPose) -> SceneEdit {
    let camera = CameraDescription {
        position: pose.position,
        target: pose.target,
        up: pose.up,
        vertical_fov_degrees: pose.vertical_fov_degrees,
        keyframes: Vec::new(),
        ..session.scene_message().description.camera
    };
    SceneEdit {
        camera: Some(camera),
        ..SceneEdit::default()
    }
}

/// The least time of several calls: what else runs on the machine only adds. Unit: µs.
fn least_micros(mut call: impl FnMut(f64)) -> f64 {
    let times = (0..50).map(|i| {
        let start = Instant::now();
        call(f64::from(i) * 0.01);
        start.elapsed().as_secs_f64() * 1e6
    });
    times.fold(f64::INFINITY, f64::min)
}

#[test]
fn a_camera_message_looks_at_no_scene_and_does_what_an_edit_does() {
    let (steered, edited) = (hall(), hall());
    let now = Instant::now();
    let steering = least_micros(|x| {
        steered.set_camera(1, pose(x), now).expect("a valid pose");
    });
    let editing = least_micros(|x| {
        let edit = edit(&edited, pose(x));
        edited.edit(1, &edit, now).expect("a valid edit");
    });
    println!("a camera message takes {steering:.1} µs, as an edit {editing:.1} µs");
    assert!(steering < 50.0, "{steering} µs");
    // The scene is neither copied nor replaced until somebody looks.
    let scene = Arc::clone(&lock(&steered.state).wish.scene);
    let before = Arc::strong_count(&scene);
    steered
        .set_camera(1, pose(0.49), now)
        .expect("a valid pose");
    assert!(Arc::ptr_eq(&scene, &lock(&steered.state).wish.scene));
    assert_eq!(Arc::strong_count(&scene), before);
    assert_eq!(
        *steered.wish().scene,
        Scene {
            geometry: steered.wish().scene.geometry.clone(),
            ..Scene::clone(&edited.wish().scene)
        }
    );
    let (steered, edited) = (steered.scene_message(), edited.scene_message());
    assert_eq!(steered.description, edited.description);
}

#[test]
fn a_refused_camera_leaves_everything_as_it_was() {
    let session = hall();
    let before = (session.wish(), session.scene_message());
    let upright = CameraPose {
        target: [0.0, 5.0, 3.0],
        position: [0.0, 1.0, 3.0],
        ..pose(0.0)
    };
    let refusal = session.set_camera(7, upright, Instant::now());
    let message = refusal.expect_err("it looks along up").message(Some(7));
    assert_eq!(message.path.as_deref(), Some("camera.up"));
    let after = session.wish();
    assert!(Arc::ptr_eq(&before.0.scene, &after.scene));
    assert_eq!(after.input, 0);
    assert_eq!(before.1, session.scene_message());
}

#[test]
fn an_edit_on_another_thread_loses_no_camera() {
    let session = hall();
    std::thread::scope(|threads| {
        threads.spawn(|| {
            for i in 0..100 {
                let edit = SceneEdit {
                    exposure_ev: Some(f64::from(i) * 0.01),
                    ..SceneEdit::default()
                };
                let edited = session.edit(1, &edit, Instant::now());
                edited.expect("a valid edit");
            }
        });
        for i in 0..2000 {
            let steered = session.set_camera(1, pose(f64::from(i) * 1e-3), Instant::now());
            steered.expect("a valid pose");
            let at = session.wish().scene.camera.position.x;
            assert_eq!(
                at,
                f64::from(i) * 1e-3,
                "an edit brought an old camera back"
            );
        }
    });
    let exposure = session.scene_message().description.camera.exposure_ev;
    assert_eq!(exposure, 0.99, "a camera brought an old exposure back");
}
