//! A device that is lost, frames that cannot be read, pictures that must wait or are too large: what the
//! render thread makes of them, with a renderer that breaks as the test says.

use std::sync::atomic::Ordering;
use std::time::Duration;

use crate::support::fake::BYTES_A_PIXEL;
use crate::support::{self, Client, Server, camera, frames, hello, scene, start};
use serde_json::{Value, json};
use tyndall_stream::header::FrameHeader;

const ENDLESS: u32 = 60_000;
/// Long enough for many frames of 2 ms.
const WHILE: Duration = Duration::from_millis(300);

/// A hello that wants a picture of this size.
fn hello_of(width: u32, height: u32) -> Value {
    let mut hello = hello();
    hello["width"] = json!(width);
    hello["height"] = json!(height);
    hello
}

fn resize(input: u64, width: u32, height: u32) -> Value {
    json!({"type": "resize", "input": input, "width": width, "height": height})
}

/// An edit that leaves so many media.
fn media(input: u64, count: usize) -> Value {
    let medium = json!({"kind": "homogeneous", "sigma_s": 0.1, "sigma_a": 0});
    json!({"type": "edit", "input": input, "edit": {"media": vec![medium; count]}})
}

/// The first error about a picture whose message contains `words`.
async fn told(client: &mut Client, words: &str) -> Value {
    loop {
        let error = client.json("error").await;
        assert_eq!(error["code"], "render_failed", "{error}");
        let message = error["message"].as_str();
        if message.is_some_and(|message| message.contains(words)) {
            return error;
        }
    }
}

fn devices(server: &Server) -> u64 {
    server.script.opened.load(Ordering::SeqCst)
}

#[tokio::test]
async fn wish_that_lost_the_device_is_not_tried_again_until_it_changes() {
    let server = start(scene(ENDLESS)).await;
    let (mut client, _) = Client::enter(&server, hello()).await;
    client.frame().await;
    server.script.deadly_width.store(48, Ordering::SeqCst);
    client.say(resize(1, 48, 32)).await;
    let error = told(&mut client, "not tried again").await;
    assert_eq!(error["input"], 1);
    // One of the picture before may still have been on its way.
    let later = frames(&client.during(WHILE).await);
    assert!(later.iter().all(|frame| frame.width != 48));
    assert_eq!(server.script.begun_with(48).len(), 1);
    client.say(resize(2, 64, 32)).await;
    let frame = client.frame_where(|frame| frame.applied_input == 2).await;
    assert_eq!(frame.width, 64);
    assert_eq!(devices(&server), 2);
    server.stop().await;
}

#[tokio::test]
async fn of_several_suspects_each_is_tried_alone_and_only_the_guilty_one_is_refused() {
    let server = start(scene(ENDLESS)).await;
    let (mut innocent, _) = Client::enter(&server, hello()).await;
    innocent.frame().await;
    // A frame of the innocent stays on the device until the other one has lost it.
    server.script.held.store(true, Ordering::SeqCst);
    server.script.deadly_width.store(48, Ordering::SeqCst);
    let (mut guilty, _) = Client::enter(&server, hello_of(48, 32)).await;
    told(&mut guilty, "tried once more, alone").await;
    told(&mut innocent, "tried once more, alone").await;
    server.script.held.store(false, Ordering::SeqCst);
    told(&mut guilty, "not tried again").await;
    let beside: Vec<usize> = server
        .script
        .begun_with(48)
        .iter()
        .map(|b| b.beside)
        .collect();
    assert_eq!(beside, [1, 0], "together with the innocent, then alone");
    innocent.frame_where(|frame| frame.samples > 5).await;
    assert_eq!(frames(&guilty.during(WHILE).await).len(), 0);
    assert_eq!(devices(&server), 3);
    guilty.say(resize(1, 64, 32)).await;
    guilty.frame_where(|frame| frame.applied_input == 1).await;
    server.stop().await;
}

#[tokio::test]
async fn wishes_that_lose_the_device_only_together_are_refused_the_second_time() {
    let server = start(scene(ENDLESS)).await;
    let script = &server.script;
    script.deadly_width.store(48, Ordering::SeqCst);
    script.deadly_in_company.store(true, Ordering::SeqCst);
    let (mut a, _) = Client::enter(&server, hello()).await;
    let (mut b, _) = Client::enter(&server, hello_of(48, 32)).await;
    told(&mut a, "not tried again").await;
    told(&mut b, "not tried again").await;
    // Another device is opened a moment after both were told, and is not lost.
    a.during(WHILE).await;
    a.during(WHILE).await;
    assert_eq!(devices(&server), 3);
    a.say(camera(1, 1.0)).await;
    a.frame_where(|frame| frame.applied_input == 1).await;
    server.stop().await;
}

#[tokio::test]
async fn thread_waits_for_the_frame_that_was_begun_first() {
    let server = start(scene(ENDLESS)).await;
    let (mut a, _) = Client::enter(&server, hello()).await;
    let (mut b, _) = Client::enter(&server, hello()).await;
    for _ in 0..20 {
        a.frame().await;
        b.frame().await;
    }
    let script = &server.script;
    assert!(script.waited_for_oldest.load(Ordering::SeqCst) > 0);
    assert_eq!(script.waited_for_younger.load(Ordering::SeqCst), 0);
    server.stop().await;
}

#[tokio::test]
async fn frame_that_cannot_be_read_is_made_again() {
    let server = start(scene(1)).await;
    server.script.unreadable.store(2, Ordering::SeqCst);
    let (mut client, _) = Client::enter(&server, hello()).await;
    for _ in 0..2 {
        let error = told(&mut client, "made again").await;
        assert_eq!(error["input"], json!(null));
    }
    client.frame_where(|frame| frame.converged).await;
    assert_eq!(server.script.frames.load(Ordering::SeqCst), 3);
    server.stop().await;
}

#[tokio::test]
async fn wish_whose_frames_cannot_be_read_is_refused_after_three() {
    let server = start(scene(ENDLESS)).await;
    let (mut client, _) = Client::enter(&server, hello()).await;
    client.frame().await;
    server.script.unreadable.store(3, Ordering::SeqCst);
    told(&mut client, "3 in a row").await;
    client.during(WHILE).await;
    let begun = server.script.frames.load(Ordering::SeqCst);
    let calls = server.script.calls.load(Ordering::SeqCst);
    client.during(WHILE).await;
    assert_eq!(server.script.frames.load(Ordering::SeqCst), begun);
    assert_eq!(
        server.script.calls.load(Ordering::SeqCst),
        calls,
        "the renderer is polled"
    );
    client.say(camera(1, 1.0)).await;
    client.frame_where(|frame| frame.applied_input == 1).await;
    server.stop().await;
}

#[tokio::test]
async fn preparation_holds_up_no_other_session_and_the_newest_wish_wins() {
    let server = start(scene(ENDLESS)).await;
    let (mut waiting, _) = Client::enter(&server, hello_of(48, 32)).await;
    let (mut other, _) = Client::enter(&server, hello()).await;
    waiting.frame().await;
    server.script.preparing.store(true, Ordering::SeqCst);
    waiting.say(media(1, 2)).await;
    for input in 1..=5 {
        other.say(camera(input, input as f64)).await;
        other
            .frame_where(|frame| frame.applied_input == input)
            .await;
    }
    // What is there already can be looked at from elsewhere, and is not yet the answer to the edit.
    waiting.say(camera(2, 7.0)).await;
    for _ in 0..200 {
        let (frame, _) = waiting.frame().await;
        assert_eq!(frame.applied_input, 0);
        if server
            .script
            .begun_with(48)
            .iter()
            .any(|b| b.camera_x == 7.0)
        {
            break;
        }
    }
    waiting.say(media(3, 3)).await;
    // Messages are taken in order: where this camera is seen, the edit before it has been taken.
    waiting.say(camera(4, 8.0)).await;
    let seen = |x: f64| {
        let begun = server.script.begun_with(48);
        begun.iter().any(|begun| begun.camera_x == x)
    };
    while !seen(8.0) {
        waiting.frame().await;
    }
    let before = server.script.begun_with(48);
    assert!(before.iter().all(|begun| begun.media == 1));
    server.script.preparing.store(false, Ordering::SeqCst);
    waiting.frame_where(|frame| frame.applied_input == 4).await;
    let after = server.script.begun_with(48);
    assert!(after.iter().all(|begun| begun.media != 2), "an older wish");
    server.stop().await;
}

#[tokio::test]
async fn lone_session_gets_what_was_prepared_without_ringing_again() {
    let server = start(scene(1)).await;
    let (mut client, _) = Client::enter(&server, hello()).await;
    client.frame_where(|frame| frame.converged).await;
    server.script.preparing.store(true, Ordering::SeqCst);
    client.say(media(1, 2)).await;
    assert_eq!(frames(&client.during(WHILE).await).len(), 0);
    server.script.preparing.store(false, Ordering::SeqCst);
    client.frame_where(|frame| frame.applied_input == 1).await;
    server.stop().await;
}

#[tokio::test]
async fn picture_too_large_for_the_memory_gets_smaller_once_and_is_refused_if_nothing_helps() {
    let server = start(scene(ENDLESS)).await;
    let memory = &server.script.memory;
    let too_large = || server.script.too_large.load(Ordering::SeqCst);
    memory.store(BYTES_A_PIXEL * 800 * 400 / 4, Ordering::SeqCst);
    let (mut client, _) = Client::enter(&server, hello_of(800, 400)).await;
    let notice = client.json("notice").await;
    let message = notice["message"].as_str().unwrap();
    assert!(
        message.contains("380×190 pixels instead of 800×400"),
        "{message}"
    );
    // A moving picture has fewer pixels yet.
    client
        .frame_where(|frame| (frame.width, frame.height) == (380, 190))
        .await;
    client.say(camera(1, 1.0)).await;
    let settled = |frame: &FrameHeader| frame.applied_input == 1 && frame.width == 380;
    let frame = client.frame_where(settled).await;
    assert_eq!(frame.height, 190);
    assert_eq!(too_large(), 1, "the size is kept");

    memory.store(1, Ordering::SeqCst);
    client.say(resize(2, 400, 300)).await;
    let error = told(&mut client, "bytes of device memory, allowed are 1").await;
    assert_eq!(error["input"], 2);
    let tries = too_large();
    client.during(WHILE).await;
    assert_eq!(too_large(), tries, "refused until it changes");

    memory.store(0, Ordering::SeqCst);
    client.say(resize(3, 300, 150)).await;
    let settled = |frame: &FrameHeader| frame.applied_input == 3 && frame.width == 300;
    let frame = client.frame_where(settled).await;
    assert_eq!(frame.height, 150);
    server.stop().await;
}

#[tokio::test]
async fn picture_grows_when_another_session_leaves() {
    let mut options = support::options(scene(ENDLESS));
    options.limits.resume_for = Duration::from_millis(50);
    let server = support::start_with(options).await;
    let (other, _) = Client::enter(&server, hello()).await;
    let memory = &server.script.memory;
    memory.store(BYTES_A_PIXEL * 800 * 400 / 4, Ordering::SeqCst);
    let (mut client, _) = Client::enter(&server, hello_of(800, 400)).await;
    client.frame_where(|frame| frame.width == 380).await;
    memory.store(0, Ordering::SeqCst);
    drop(other);
    let frame = client.frame_where(|frame| frame.width == 800).await;
    assert_eq!(frame.height, 400);
    server.stop().await;
}
