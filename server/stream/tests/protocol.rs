//! Messages as they stand on the wire.

use serde_json::json;
use tyndall_scene::SceneError;
use tyndall_stream::header::{Codec, MAX_SAFE_INTEGER};
use tyndall_stream::protocol::{
    CameraPose, CameraUpdate, ClientMessage, ErrorCode, ErrorMessage, ServerMessage,
};

fn parse(value: &serde_json::Value) -> Result<ClientMessage, SceneError> {
    ClientMessage::from_json(&value.to_string())
}

/// The path, found and allowed of a refused message.
fn refused(value: &serde_json::Value) -> (String, String, String) {
    match parse(value).expect_err("the message was taken") {
        SceneError::Invalid {
            path,
            found,
            allowed,
        } => (path, found, allowed),
        other => panic!("{other}"),
    }
}

#[test]
fn every_client_message_survives_its_own_json() {
    let camera = json!({"position": [0, 1, 2], "target": [0, 0, 0], "up": [0, 1, 0],
        "vertical_fov_degrees": 50});
    let messages = [
        json!({"type": "hello", "protocol": 1, "accept": ["jpeg", "avif", "png"], "width": 640,
            "height": 360, "resume": null}),
        json!({"type": "camera", "input": 3, "camera": camera}),
        json!({"type": "camera", "input": 3, "camera": camera, "stops_at_surfaces": true}),
        json!({"type": "edit", "input": 4, "edit": {"media": [
            {"kind": "homogeneous", "sigma_s": 0.1, "sigma_a": [0.0, 0.1, 0.2]}]}}),
        json!({"type": "open_preset", "input": 5, "name": "fogged_hall"}),
        json!({"type": "resize", "input": 6, "width": 1920, "height": 1080}),
        json!({"type": "ack", "frame": 7}),
        json!({"type": "visible", "visible": false}),
        json!({"type": "pick", "request": 1, "place": [0.25, 0.75]}),
        json!({"type": "explain_darkness", "request": 2}),
    ];
    for message in messages {
        let parsed = parse(&message).unwrap();
        let written = serde_json::to_string(&parsed).unwrap();
        assert_eq!(
            ClientMessage::from_json(&written).unwrap(),
            parsed,
            "{written}"
        );
        assert_eq!(parsed.input(), message["input"].as_u64());
    }
}

#[test]
fn unknown_codecs_of_a_hello_are_skipped() {
    let hello = json!({"type": "hello", "protocol": 1, "accept": ["h264", "png"], "width": 1,
        "height": 1});
    let ClientMessage::Hello(hello) = parse(&hello).unwrap() else {
        panic!("not a hello")
    };
    assert_eq!(hello.codecs(), [Codec::Png]);
    assert_eq!(hello.resume, None);
}

#[test]
fn errors_name_path_found_and_allowed() {
    let (path, found, allowed) = refused(&json!({"type": "dance"}));
    assert_eq!((path.as_str(), found.as_str()), ("type", "\"dance\""));
    assert!(allowed.contains("open_preset"));
    assert_eq!(refused(&json!({"frame": 1})).0, "type");
    assert_eq!(refused(&json!({"type": "ack", "frame": "one"})).0, "frame");
    assert_eq!(
        refused(&json!({"type": "ack", "frame": 1, "extra": 1})).0,
        "extra"
    );
    let light = json!({"kind": "point", "position": [0, "high", 0], "intensity": 1});
    let edit = json!({"type": "edit", "input": 1, "edit": {"lights": [light]}});
    assert_eq!(refused(&edit).0, "edit.lights[0].position[1]");
    let late = json!({"type": "resize", "input": MAX_SAFE_INTEGER + 1, "width": 1, "height": 1});
    assert_eq!(refused(&late).0, "input");
}

#[test]
fn text_that_is_no_json_object_is_refused() {
    assert!(matches!(
        ClientMessage::from_json("{"),
        Err(SceneError::Syntax { .. })
    ));
    assert!(matches!(
        ClientMessage::from_json(""),
        Err(SceneError::Syntax { .. })
    ));
    assert!(ClientMessage::from_json("[]").is_err());
    assert!(ClientMessage::from_json("3").is_err());
    let deep = "[".repeat(100_000);
    assert!(ClientMessage::from_json(&deep).is_err());
}

#[test]
fn server_messages_are_tagged_and_leave_out_what_is_not_there() {
    let error = ServerMessage::Error(ErrorMessage {
        code: ErrorCode::InvalidScene,
        path: None,
        message: "no".to_owned(),
        input: Some(3),
    });
    let written = serde_json::to_value(&error).unwrap();
    let expected = json!({"type": "error", "code": "invalid_scene", "message": "no", "input": 3});
    assert_eq!(written, expected);
}

#[test]
fn camera_numbers_survive_exactly() {
    let camera = CameraPose {
        position: [0.1, 1e-17, -123_456.789_012_345],
        target: [0.0; 3],
        up: [0.0, 1.0, 0.0],
        vertical_fov_degrees: 37.123_456_789,
    };
    let message = ClientMessage::Camera(CameraUpdate {
        input: 1,
        camera,
        stops_at_surfaces: true,
    });
    let written = serde_json::to_string(&message).unwrap();
    assert_eq!(ClientMessage::from_json(&written).unwrap(), message);
}
