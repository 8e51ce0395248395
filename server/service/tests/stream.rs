//! Conversations over a real socket with a renderer that keeps time but draws nothing.

use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

use crate::support::{self, Client, Received, camera, frames, hello, scene, start, start_with};
use futures_util::SinkExt as _;
use serde_json::json;
use tokio_tungstenite::tungstenite::Message;
use tyndall_stream::header::Codec;

const ENDLESS: u32 = 60_000;
/// After which a frame that was not acknowledged no longer counts.
const UNWEDGE: Duration = Duration::from_secs(2);

#[tokio::test]
async fn hello_is_answered_by_welcome_scene_plan_and_frames_until_converged() {
    let server = start(scene(5)).await;
    let (mut client, welcome) = Client::enter(&server, hello()).await;
    assert_eq!(welcome["protocol"], 1);
    assert_eq!(welcome["resumed"], false);
    assert_eq!(welcome["adapter"]["kind"], "software");
    assert!(welcome["session"].as_str().unwrap().len() >= 32);
    assert!(welcome["limits"]["max_pixels"].as_u64().unwrap() > 1_000_000);
    let opened = client.json("scene").await;
    assert_eq!(opened["epoch"], 1);
    assert_eq!(
        opened["description"]["media"][0]["sigma_s"],
        json!([0.05, 0.05, 0.05])
    );
    assert_eq!(opened["facts"]["triangles"], 12);
    let plan = client.json("plan").await;
    assert_eq!(plan["plan"]["passes"][0]["pass"], "fake");
    let (first, payload) = client.frame().await;
    assert_eq!((first.codec, first.software), (Codec::Jpeg, true));
    assert_eq!(
        (first.width, first.height, first.session_epoch),
        (96, 64, 1)
    );
    assert_eq!(payload[..2], [0xff, 0xd8]);
    let stats = client.json("stats").await;
    assert_eq!(stats["frame"], first.frame_id);
    assert_eq!(stats["technique"], "single_scattering");
    let last = client.frame_where(|frame| frame.converged).await;
    assert_eq!((last.codec, last.samples), (Codec::Png, 5));
    server.stop().await;
}

/// Bounds hold however slowly this machine runs: no frame is given up before two seconds have passed
/// since the client's greeting, and what is sent later may come as late as the machine is busy.
#[tokio::test]
async fn silent_client_gets_two_frames_and_more_after_two_seconds() {
    let server = start(scene(ENDLESS)).await;
    let greeting = Instant::now();
    let (mut client, _) = Client::enter(&server, hello()).await;
    client.polite = false;
    client.frame().await;
    let (second, _) = client.frame().await;
    let (third, _) = client.frame().await;
    let waited = greeting.elapsed();
    assert!(waited >= UNWEDGE, "a third frame after {waited:?}");
    assert!(third.frame_id > second.frame_id);
    // Two for every time that two were given up; as many again may have been replaced before the
    // socket was ready.
    let rendered = server.script.frames.load(Ordering::SeqCst);
    let windows = 1 + greeting.elapsed().as_secs() / UNWEDGE.as_secs();
    assert!(
        rendered <= 4 * windows,
        "{rendered} frames in {:?} for a client that acknowledged none",
        greeting.elapsed()
    );
    client.ack(third.frame_id).await;
    client.frame().await;
    server.stop().await;
}

#[tokio::test]
async fn newest_of_a_burst_of_cameras_arrives() {
    let server = start(scene(3)).await;
    let (mut client, _) = Client::enter(&server, hello()).await;
    for input in 1..=500 {
        client.say(camera(input, input as f64 * 0.01)).await;
    }
    let last = client
        .frame_where(|frame| frame.applied_input == 500 && frame.converged)
        .await;
    assert_eq!(last.samples, 3);
    assert!(
        last.frame_id < 300,
        "{} frames for 500 cameras",
        last.frame_id
    );
    server.stop().await;
}

#[tokio::test]
async fn input_that_changes_nothing_is_answered() {
    let server = start(scene(2)).await;
    let (mut client, _) = Client::enter(&server, hello()).await;
    client.say(camera(1, 1.0)).await;
    client
        .frame_where(|frame| frame.applied_input == 1 && frame.converged)
        .await;
    client.say(camera(2, 1.0)).await;
    let again = client.frame_where(|frame| frame.applied_input == 2).await;
    assert!(again.converged);
    client
        .say(json!({"type": "resize", "input": 3, "width": 96, "height": 64}))
        .await;
    client.frame_where(|frame| frame.applied_input == 3).await;
    server.stop().await;
}

#[tokio::test]
async fn malformed_messages_are_answered_and_end_the_conversation_when_they_go_on() {
    let server = start(scene(2)).await;
    let (mut client, _) = Client::enter(&server, hello()).await;
    client.raw("{\"type\":").await;
    assert_eq!(client.json("error").await["code"], "malformed");
    client.say(json!({"type": "ack", "frame": -1})).await;
    assert_eq!(client.json("error").await["path"], "frame");
    client
        .socket
        .send(Message::Binary(vec![1, 2, 3].into()))
        .await
        .unwrap();
    assert_eq!(client.json("error").await["code"], "malformed");
    client.say(camera(1, 2.0)).await;
    client.frame_where(|frame| frame.applied_input == 1).await;
    for _ in 0..16 {
        client.raw("nonsense").await;
    }
    assert_eq!(client.closed().await, 1008);
    server.stop().await;
}

#[tokio::test]
async fn over_long_message_closes_the_connection_and_nothing_else() {
    let server = start(scene(2)).await;
    let (mut client, _) = Client::enter(&server, hello()).await;
    let long = format!("\"{}\"", "x".repeat(2 << 20));
    drop(client.socket.send(Message::Text(long.into())).await);
    assert!([1006, 1009].contains(&client.closed().await));
    let (mut other, _) = Client::enter(&server, hello()).await;
    other.frame().await;
    server.stop().await;
}

#[tokio::test]
async fn first_message_must_be_a_fitting_hello() {
    let server = start(scene(2)).await;
    let wrong = [
        (json!({"type": "ack", "frame": 1}), "hello_expected", 1008),
        (json!({"type": "hello"}), "malformed", 1008),
        (
            with(&hello(), "protocol", json!(2)),
            "protocol_version",
            1002,
        ),
        (
            with(&hello(), "accept", json!(["h264"])),
            "no_common_codec",
            1008,
        ),
    ];
    for (message, code, close) in wrong {
        let mut client = Client::connect(&server).await;
        client.say(message).await;
        assert_eq!(client.json("error").await["code"], code);
        assert_eq!(client.closed().await, close);
    }
    server.stop().await;
}

#[tokio::test]
async fn late_hello_is_not_waited_for() {
    let mut options = support::options(scene(2));
    options.limits.hello_within = Duration::from_millis(100);
    let server = start_with(options).await;
    let mut client = Client::connect(&server).await;
    assert_eq!(client.json("error").await["code"], "hello_expected");
    assert_eq!(client.closed().await, 1008);
    server.stop().await;
}

#[tokio::test]
async fn refused_edit_names_its_path_and_leaves_the_scene() {
    let server = start(scene(2)).await;
    let (mut client, _) = Client::enter(&server, hello()).await;
    client.frame_where(|frame| frame.converged).await;
    let medium = |g: f64| json!([{"kind": "homogeneous", "sigma_s": 0.2, "sigma_a": 0, "g": g}]);
    client
        .say(json!({"type": "edit", "input": 7, "edit": {"media": medium(1.5)}}))
        .await;
    let error = client.json("error").await;
    assert_eq!(error["code"], "invalid_scene");
    assert_eq!(error["path"], "media[0].g");
    assert_eq!(error["input"], 7);
    client
        .say(json!({"type": "edit", "input": 8, "edit": {"media": medium(0.5)}}))
        .await;
    let frame = client.frame_where(|frame| frame.applied_input > 0).await;
    assert_eq!(frame.applied_input, 8);
    client
        .say(json!({"type": "resize", "input": 9, "width": 0, "height": 10}))
        .await;
    assert_eq!(client.json("error").await["code"], "invalid_size");
    server.stop().await;
}

#[tokio::test]
async fn preset_opens_as_another_scene_and_an_unknown_one_is_refused() {
    let server = start(scene(2)).await;
    let (mut client, welcome) = Client::enter(&server, hello()).await;
    client
        .say(json!({"type": "open_preset", "input": 1, "name": "no_such"}))
        .await;
    let error = client.json("error").await;
    assert_eq!(
        (error["code"].as_str(), error["input"].as_u64()),
        (Some("not_found"), Some(1))
    );
    let name = welcome["presets"][0]["name"].as_str().unwrap().to_owned();
    client
        .say(json!({"type": "open_preset", "input": 2, "name": name}))
        .await;
    loop {
        let opened = client.json("scene").await;
        if opened["epoch"] == 2 {
            break;
        }
    }
    let frame = client.frame_where(|frame| frame.session_epoch == 2).await;
    assert_eq!(frame.applied_input, 2);
    server.stop().await;
}

#[tokio::test]
async fn hidden_page_costs_no_frames() {
    let server = start(scene(ENDLESS)).await;
    let (mut client, _) = Client::enter(&server, hello()).await;
    client.frame().await;
    client
        .say(json!({"type": "visible", "visible": false}))
        .await;
    client.during(Duration::from_millis(300)).await;
    let before = server.script.frames.load(Ordering::SeqCst);
    let received = client.during(Duration::from_millis(500)).await;
    assert_eq!(frames(&received).len(), 0);
    assert_eq!(server.script.frames.load(Ordering::SeqCst), before);
    client
        .say(json!({"type": "visible", "visible": true}))
        .await;
    client.frame().await;
    server.stop().await;
}

#[tokio::test]
async fn dropped_session_is_resumed_with_its_camera_and_picture() {
    let server = start(scene(3)).await;
    let (mut client, welcome) = Client::enter(&server, hello()).await;
    client.say(camera(41, 2.5)).await;
    client
        .frame_where(|frame| frame.applied_input == 41 && frame.converged)
        .await;
    drop(client);
    let token = welcome["session"].clone();
    let (mut client, welcome) = Client::enter(&server, with(&hello(), "resume", token)).await;
    assert_eq!(welcome["resumed"], true);
    let opened = client.json("scene").await;
    assert_eq!(
        opened["description"]["camera"]["position"],
        json!([2.5, 0.0, 5.0])
    );
    client.json("plan").await;
    let (frame, _) = client.frame().await;
    assert_eq!((frame.applied_input, frame.converged), (41, true));
    assert_eq!(opened["epoch"], frame.session_epoch);
    server.stop().await;
}

#[tokio::test]
async fn resuming_takes_over_a_connection_that_is_still_open() {
    let server = start(scene(2)).await;
    let (mut old, welcome) = Client::enter(&server, hello()).await;
    let token = welcome["session"].clone();
    let (mut new, welcome) = Client::enter(&server, with(&hello(), "resume", token)).await;
    assert_eq!(welcome["resumed"], true);
    assert_eq!(old.closed().await, 4001);
    new.frame().await;
    server.stop().await;
}

#[tokio::test]
async fn session_is_forgotten_after_its_time() {
    let mut options = support::options(scene(2));
    options.limits.resume_for = Duration::from_millis(200);
    let server = start_with(options).await;
    let (client, welcome) = Client::enter(&server, hello()).await;
    drop(client);
    tokio::time::sleep(Duration::from_millis(800)).await;
    let token = welcome["session"].clone();
    let (_client, welcome) = Client::enter(&server, with(&hello(), "resume", token)).await;
    assert_eq!(welcome["resumed"], false);
    server.stop().await;
}

#[tokio::test]
async fn client_above_the_limit_is_told_so_and_gets_a_place_once_one_is_free() {
    let mut options = support::options(scene(2));
    options.limits.max_sessions = 2;
    let server = start_with(options).await;
    let (first, _) = Client::enter(&server, hello()).await;
    let (_second, _) = Client::enter(&server, hello()).await;
    let refused = async || {
        let mut client = Client::connect(&server).await;
        client.say(hello()).await;
        loop {
            match client.next().await {
                Received::Json(message) if message["type"] == "welcome" => return false,
                Received::Closed(code) => {
                    assert_eq!(code, 1013);
                    return true;
                }
                _ => {}
            }
        }
    };
    assert!(refused().await);
    drop(first);
    let mut tries = 0;
    while refused().await {
        tries += 1;
        assert!(tries < 200, "no place became free");
        tokio::time::sleep(Duration::from_millis(20)).await;
    }
    server.stop().await;
}

#[tokio::test]
async fn every_session_gets_frames_of_its_own_camera() {
    let server = start(scene(ENDLESS)).await;
    let (mut a, _) = Client::enter(&server, hello()).await;
    let (mut b, _) = Client::enter(&server, with(&hello(), "width", json!(48))).await;
    a.say(camera(10, 1.0)).await;
    assert_eq!(
        a.frame_where(|frame| frame.applied_input == 10).await.width,
        96
    );
    for _ in 0..5 {
        let (frame, _) = b.frame().await;
        assert_eq!((frame.applied_input, frame.width), (0, 48));
        a.frame().await;
    }
    server.stop().await;
}

#[tokio::test]
async fn lost_device_is_replaced_and_sessions_go_on() {
    let server = start(scene(ENDLESS)).await;
    let (mut client, _) = Client::enter(&server, hello()).await;
    client.frame().await;
    server.script.gone.store(true, Ordering::SeqCst);
    server.script.lose.store(true, Ordering::SeqCst);
    assert_eq!(client.json("error").await["code"], "render_failed");
    assert_eq!(server.get("/readyz").await.0, 503);
    assert_eq!(server.get("/livez").await.0, 200);
    client.say(camera(1, 1.0)).await;
    server.script.gone.store(false, Ordering::SeqCst);
    let frame = client.frame_where(|frame| frame.applied_input == 1).await;
    // The picture began anew; the first of its frames may have been replaced by later ones.
    assert!(frame.samples < 100, "{} samples", frame.samples);
    assert_eq!(server.get("/readyz").await.0, 200);
    assert_eq!(server.script.opened.load(Ordering::SeqCst), 2);
    server.stop().await;
}

#[tokio::test]
async fn shutdown_says_goodbye() {
    let server = start(scene(ENDLESS)).await;
    let (mut client, _) = Client::enter(&server, hello()).await;
    client.frame().await;
    server.shutdown.cancel();
    assert_eq!(client.closed().await, 1001);
    drop(client);
    let start = Instant::now();
    server.stop().await;
    assert!(start.elapsed() < Duration::from_secs(5));
}

/// A JSON object with one member replaced.
fn with(object: &serde_json::Value, name: &str, value: serde_json::Value) -> serde_json::Value {
    let mut object = object.clone();
    object[name] = value;
    object
}
