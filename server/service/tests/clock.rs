//! Sessions whose scene moves: the clock runs, stands, is set, and refuses what is no time.

use std::sync::atomic::Ordering;
use std::time::Duration;

use crate::support::{Client, Server, hello, start};
use serde_json::{Value, json};
use tyndall_scene::{Loaded, SceneDescription, build};

/// A box that slides for `period` seconds and starts over, finished after two samples.
fn moving(period: f64) -> Loaded {
    let text = json!({
        "version": 1,
        "name": "moving",
        "camera": {"position": [0, 0, 5], "target": [0, 0, 0]},
        "geometry": [{"kind": "box", "min": [-1, -1, -1], "max": [1, 1, 1], "keyframes": [
            {"time_seconds": 0, "transform": {}},
            {"time_seconds": period, "transform": {"translation": [1, 0, 0]}}]}],
        "lights": [{"kind": "point", "position": [0, 3, 3], "intensity": 50}],
        "render": {"width": 96, "height": 64, "samples": 2},
        "animation": {"period_seconds": period},
    });
    let description = SceneDescription::from_json(&text.to_string()).expect("the scene parses");
    build(description, None).expect("the scene is valid")
}

fn edit(input: u64, edit: &Value) -> Value {
    json!({"type": "edit", "input": input, "edit": edit})
}

async fn enter(period: f64) -> (Server, Client, Value) {
    let server = start(moving(period)).await;
    let (mut client, _) = Client::enter(&server, hello()).await;
    let scene = client.json("scene").await;
    (server, client, scene)
}

#[tokio::test]
async fn time_goes_on_from_the_first_frame_and_every_frame_is_a_picture_of_its_own() {
    let (server, mut client, scene) = enter(1e6).await;
    assert_eq!(
        scene["clock"],
        json!({"playing": true, "time_seconds": 0.0, "duration_seconds": 1e6})
    );
    let mut before = -1.0;
    for _ in 0..20 {
        let stats = client.json("stats").await;
        let seconds = stats["time_seconds"].as_f64().unwrap();
        assert!(seconds > before, "{seconds} after {before}");
        assert_eq!(stats["samples"], 1);
        before = seconds;
    }
    assert!(before > 0.01, "20 frames of 2 ms");
    server.stop().await;
}

#[tokio::test]
async fn a_paused_picture_converges_where_it_was_sent_and_costs_nothing_more() {
    let (server, mut client, _) = enter(100.0).await;
    client
        .say(edit(1, &json!({"playing": false, "time_seconds": 42.5})))
        .await;
    let shown = client
        .frame_where(|frame| frame.applied_input == 1 && frame.converged)
        .await;
    assert_eq!(shown.samples, 2);
    assert_eq!(client.json("stats").await["time_seconds"], 42.5);
    let frames = server.script.frames.load(Ordering::SeqCst);
    client.during(Duration::from_millis(200)).await;
    assert_eq!(server.script.frames.load(Ordering::SeqCst), frames);
    client.say(edit(2, &json!({"playing": true}))).await;
    client.frame_where(|frame| frame.applied_input == 2).await;
    client.json("stats").await;
    let later = client.json("stats").await["time_seconds"].as_f64();
    assert!(
        later.is_some_and(|later| (42.5..52.5).contains(&later)),
        "{later:?}"
    );
    server.stop().await;
}

#[tokio::test]
async fn hostile_times_are_refused_by_name() {
    let (server, mut client, _) = enter(100.0).await;
    for (input, seconds) in [(1, json!(1e30)), (2, json!(-1)), (3, json!("now"))] {
        client
            .say(edit(input, &json!({"time_seconds": seconds})))
            .await;
        let error = client.json("error").await;
        let path = error["path"].as_str().unwrap();
        assert!(path.ends_with("time_seconds"), "{error}");
    }
    // The session goes on.
    client.say(edit(4, &json!({"time_seconds": 7}))).await;
    client.frame_where(|frame| frame.applied_input == 4).await;
    server.stop().await;
}

#[tokio::test]
async fn a_hidden_page_stops_the_clock() {
    let (server, mut client, _) = enter(1e6).await;
    client.json("stats").await;
    client
        .say(json!({"type": "visible", "visible": false}))
        .await;
    client.during(Duration::from_millis(300)).await;
    let frames = server.script.frames.load(Ordering::SeqCst);
    client.during(Duration::from_millis(500)).await;
    assert_eq!(server.script.frames.load(Ordering::SeqCst), frames);
    client
        .say(json!({"type": "visible", "visible": true}))
        .await;
    let seconds = client.json("stats").await["time_seconds"].as_f64().unwrap();
    assert!(seconds < 0.4, "{seconds} s: it stood for 0.5 s at least");
    server.stop().await;
}
