//! Jobs over HTTP, on a renderer that keeps time but draws nothing.

#![allow(clippy::unwrap_used, reason = "helpers of tests")]

mod making;
mod requests;

use std::time::{Duration, Instant};

use serde_json::{Value, json};
use tokio::io::{AsyncReadExt as _, AsyncWriteExt as _};
use tokio::net::TcpStream;

use crate::support::{SOON, Server};

/// A picture that takes so many frames of 2 ms.
pub fn still(samples: u32) -> Value {
    json!({
        "scene": {
            "version": 1,
            "camera": {"position": [0, 0, 5], "target": [0, 0, 0]},
            "lights": [{"kind": "point", "position": [0, 3, 3], "intensity": 50}],
            "media": [{"kind": "homogeneous", "sigma_s": 0.05, "sigma_a": 0.01}],
        },
        "render": {"width": 20, "height": 10, "samples": samples},
    })
}

/// Merges members into a job.
pub fn with(mut job: Value, members: &Value) -> Value {
    for (name, value) in members.as_object().unwrap() {
        job[name] = value.clone();
    }
    job
}

pub async fn post(server: &Server, headers: &str, body: &str) -> (u16, String, Value) {
    let request = format!("POST /v1/jobs\nContent-Type: application/json\n{headers}");
    let (status, head, body) = server.http(&request, body).await;
    let body = serde_json::from_str(&body).unwrap_or(Value::Null);
    (status, head, body)
}

/// The name of an accepted job.
pub async fn submit(server: &Server, job: &Value) -> String {
    let (status, head, body) = post(server, "", &job.to_string()).await;
    assert_eq!(status, 202, "{body}");
    let id = body["id"].as_str().unwrap().to_owned();
    assert!(head.contains(&format!("location: /v1/jobs/{id}")), "{head}");
    id
}

/// Posts a form.
pub async fn send_form(server: &Server, parts: String) -> (u16, Value) {
    let request = "POST /v1/jobs\nContent-Type: multipart/form-data; boundary=limit";
    let (status, _, body) = server.http(request, &parts).await;
    (status, serde_json::from_str(&body).unwrap_or(Value::Null))
}

pub async fn status(server: &Server, id: &str) -> Value {
    let (status, _, body) = server.get(&format!("/v1/jobs/{id}")).await;
    assert_eq!(status, 200, "{body}");
    serde_json::from_str(&body).unwrap()
}

/// Waits until a job stands so.
pub async fn reach(server: &Server, id: &str, wanted: impl Fn(&Value) -> bool) -> Value {
    let began = Instant::now();
    loop {
        let found = status(server, id).await;
        if wanted(&found) {
            return found;
        }
        assert!(began.elapsed() < SOON, "{found}");
        tokio::time::sleep(Duration::from_millis(5)).await;
    }
}

pub async fn finish(server: &Server, id: &str) -> Value {
    reach(server, id, |job| {
        job["state"] != "queued" && job["state"] != "running"
    })
    .await
}

pub async fn results(server: &Server, id: &str) -> Vec<Value> {
    let (status, _, body) = server.get(&format!("/v1/jobs/{id}/results")).await;
    assert_eq!(status, 200, "{body}");
    serde_json::from_str(&body).unwrap()
}

/// Fetches bytes: status, head, body.
pub async fn fetch(server: &Server, path: &str, headers: &str) -> (u16, String, Vec<u8>) {
    let mut stream = TcpStream::connect(server.address).await.unwrap();
    let request = format!(
        "GET {path} HTTP/1.1\r\nHost: {}\r\nConnection: close\r\n{headers}\r\n",
        server.address
    );
    stream.write_all(request.as_bytes()).await.unwrap();
    let mut answer = Vec::new();
    stream.read_to_end(&mut answer).await.unwrap();
    let end = answer
        .windows(4)
        .position(|four| four == b"\r\n\r\n")
        .unwrap();
    let head = String::from_utf8_lossy(&answer[..end]).to_ascii_lowercase();
    let status = head.split(' ').nth(1).unwrap().parse().unwrap();
    (status, head, answer[end + 4..].to_vec())
}
