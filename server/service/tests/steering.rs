//! Steering over the stream: what suits the scene, stops at surfaces, picks, reasons for a black picture.

#![allow(
    clippy::unwrap_used,
    reason = "a test that unwraps says where it failed"
)]

use serde_json::{Value, json};

use crate::support::{Client, hello, scene, start};

fn move_to(input: u64, z: f64, stops: bool) -> Value {
    let camera = json!({"position": [0, 0, z], "target": [0, 0, z - 5.0], "up": [0, 1, 0],
        "vertical_fov_degrees": 50});
    json!({"type": "camera", "input": input, "camera": camera, "stops_at_surfaces": stops})
}

/// A client that knows how to steer through the box in fog.
async fn enter(server: &crate::support::Server) -> (Client, Value) {
    let (mut client, _) = Client::enter(server, hello()).await;
    let navigation = client.json("navigation").await;
    (client, navigation)
}

#[tokio::test]
async fn the_page_learns_how_to_steer_through_every_scene_it_opens() {
    let server = start(scene(5)).await;
    let (mut client, navigation) = enter(&server).await;
    assert_eq!(navigation["mode"], "orbit");
    assert_eq!(navigation["epoch"], 1);
    assert_eq!(navigation["pivot"], json!([0.0, 0.0, 0.0]));
    assert_eq!(navigation["bounds"]["max"], json!([1.0, 1.0, 1.0]));
    assert_eq!(navigation.get("overview"), None);
    client
        .say(json!({"type": "open_preset", "input": 1, "name": "fogged_hall"}))
        .await;
    let navigation = client.json("navigation").await;
    assert_eq!(navigation["mode"], "look");
    assert_eq!(navigation["epoch"], 2);
    assert!(navigation["overview"]["position"].is_array());
    server.stop().await;
}

#[tokio::test]
async fn a_camera_that_stops_at_surfaces_stops_and_another_one_goes_through() {
    let server = start(scene(5)).await;
    let (mut client, _) = enter(&server).await;
    // The box's front is at z = 1.
    client.say(move_to(1, -3.0, true)).await;
    let stopped = client.json("camera").await;
    assert_eq!(stopped["input"], 1);
    let z = stopped["camera"]["position"][2].as_f64().unwrap();
    assert!(z > 1.0 && z < 1.1, "stopped at {z}");
    let ahead = stopped["camera"]["target"][2].as_f64().unwrap();
    assert!((z - ahead - 5.0).abs() < 1e-9, "still looks ahead: {ahead}");
    client.frame_where(|frame| frame.applied_input == 1).await;
    // Away from it nothing stops the eye, and nothing is said.
    client.say(move_to(2, 4.0, true)).await;
    client.frame_where(|frame| frame.applied_input == 2).await;
    // Flight goes through, and what follows begins behind.
    client.say(move_to(3, -3.0, false)).await;
    client.say(move_to(4, 3.0, true)).await;
    let stopped = client.json("camera").await;
    assert_eq!(stopped["input"], 4);
    let z = stopped["camera"]["position"][2].as_f64().unwrap();
    assert!(z < -1.0 && z > -1.1, "stopped at {z}");
    server.stop().await;
}

#[tokio::test]
async fn what_lies_under_the_pointer_is_told() {
    let server = start(scene(5)).await;
    let (mut client, _) = enter(&server).await;
    client
        .say(json!({"type": "pick", "request": 7, "place": [0.5, 0.5]}))
        .await;
    let picked = client.json("picked").await;
    assert_eq!(picked["request"], 7);
    assert_eq!(picked["hit"]["kind"], "surface");
    let z = picked["hit"]["point"][2].as_f64().unwrap();
    assert!((z - 1.0).abs() < 1e-3, "{picked}");
    // Past everything, and at no place at all.
    for place in [json!([0.0, 0.0]), json!([0.5, -1e300])] {
        client
            .say(json!({"type": "pick", "request": 8, "place": place}))
            .await;
        let picked = client.json("picked").await;
        assert_eq!(picked["request"], 8);
        assert_eq!(picked.get("hit"), None);
    }
    server.stop().await;
}

#[tokio::test]
async fn a_black_picture_is_explained_where_the_camera_is() {
    let server = start(scene(5)).await;
    let (mut client, _) = enter(&server).await;
    client.say(move_to(1, 0.0, false)).await;
    client
        .say(json!({"type": "explain_darkness", "request": 3}))
        .await;
    let answer = client.json("darkness").await;
    assert_eq!(answer["request"], 3);
    assert_eq!(answer["cause"], "inside_solid");
    server.stop().await;
}
