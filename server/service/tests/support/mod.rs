//! A server on a free port and a client; the renderer keeps time but draws nothing.

#![allow(dead_code, reason = "each binary uses its part")]
#![allow(
    clippy::unwrap_used,
    clippy::missing_panics_doc,
    reason = "helpers of tests"
)]

mod box_in_fog;
pub mod fake;

#[allow(unused_imports, reason = "each test file uses its part")]
pub use box_in_fog::scene;
pub use fake::{Fake, Script};

use std::net::SocketAddr;
use std::path::PathBuf;
use std::sync::{Arc, Mutex};
use std::time::Duration;

use futures_util::{SinkExt as _, StreamExt as _};
use serde_json::{Value, json};
use tokio::io::{AsyncReadExt as _, AsyncWriteExt as _};
use tokio::net::TcpStream;
use tokio::task::JoinHandle;
use tokio_tungstenite::tungstenite::client::IntoClientRequest as _;
use tokio_tungstenite::tungstenite::protocol::CloseFrame;
use tokio_tungstenite::tungstenite::{Error, Message};
use tokio_tungstenite::{MaybeTlsStream, WebSocketStream, connect_async};
use tokio_util::sync::CancellationToken;
use tyndall_scene::Loaded;
use tyndall_service::{ServeError, ServeOptions, serve, serve_on};
use tyndall_stream::header::FrameHeader;

/// How long a test waits for what must come.
pub const SOON: Duration = Duration::from_secs(20);

/// A running service.
pub struct Server {
    pub address: SocketAddr,
    pub script: Arc<Script>,
    pub shutdown: CancellationToken,
    pub ended: JoinHandle<Result<(), ServeError>>,
    _folder: tempfile::TempDir,
}

pub fn options(scene: Loaded) -> ServeOptions {
    ServeOptions::new("127.0.0.1:0".parse().unwrap(), scene)
}

/// Starts a service on a fake renderer.
pub async fn start(scene: Loaded) -> Server {
    start_with(options(scene)).await
}

pub async fn start_with(options: ServeOptions) -> Server {
    let script = Arc::new(Script::default());
    let open = Fake::opener(&script);
    launch(options, script, |options, shutdown| {
        tokio::spawn(serve_on(options, open, shutdown))
    })
    .await
}

/// Starts a service on the real renderer.
pub async fn start_real(scene: Loaded) -> Server {
    launch(options(scene), Arc::default(), |options, shutdown| {
        tokio::spawn(serve(options, shutdown))
    })
    .await
}

async fn launch(
    mut options: ServeOptions,
    script: Arc<Script>,
    spawn: impl FnOnce(ServeOptions, CancellationToken) -> JoinHandle<Result<(), ServeError>>,
) -> Server {
    let folder = tempfile::tempdir().unwrap();
    let port_file: PathBuf = folder.path().join("port");
    options.port_file = Some(port_file.clone());
    let shutdown = CancellationToken::new();
    let ended = spawn(options, shutdown.clone());
    for _ in 0..6000 {
        if let Ok(text) = std::fs::read_to_string(&port_file) {
            let address = text.trim().parse().unwrap();
            return Server {
                address,
                script,
                shutdown,
                ended,
                _folder: folder,
            };
        }
        if ended.is_finished() {
            let outcome = ended.await.unwrap();
            panic!("the service did not start: {outcome:?}");
        }
        tokio::time::sleep(Duration::from_millis(10)).await;
    }
    panic!("the service did not start within a minute");
}

impl Server {
    /// Ends the service in order and checks that it had no fault.
    pub async fn stop(self) {
        self.shutdown.cancel();
        self.ended.await.unwrap().unwrap();
    }

    /// One HTTP exchange: status, head and body.
    pub async fn http(&self, request: &str, body: &str) -> (u16, String, String) {
        let mut stream = TcpStream::connect(self.address).await.unwrap();
        let (line, headers) = request.split_once('\n').unwrap_or((request, ""));
        let headers: Vec<&str> = headers
            .lines()
            .flat_map(|header| [header, "\r\n"])
            .collect();
        let headers = headers.concat();
        let text = format!(
            "{line} HTTP/1.1\r\nHost: {}\r\nConnection: close\r\nContent-Length: {}\r\n{headers}\r\n{body}",
            self.address,
            body.len()
        );
        stream.write_all(text.as_bytes()).await.unwrap();
        let mut answer = Vec::new();
        stream.read_to_end(&mut answer).await.unwrap();
        let answer = String::from_utf8_lossy(&answer).into_owned();
        let (head, body) = answer.split_once("\r\n\r\n").unwrap();
        let status = head.split(' ').nth(1).unwrap().parse().unwrap();
        (status, head.to_ascii_lowercase(), body.to_owned())
    }

    pub async fn get(&self, path: &str) -> (u16, String, String) {
        self.http(&format!("GET {path}"), "").await
    }
}

/// What a client received.
#[derive(Debug)]
pub enum Received {
    Json(Value),
    Frame(FrameHeader, Vec<u8>),
    Closed(u16),
}

/// A WebSocket client.
pub struct Client {
    pub socket: WebSocketStream<MaybeTlsStream<TcpStream>>,
    /// Acknowledges every frame.
    pub polite: bool,
}

pub fn hello() -> Value {
    json!({"type": "hello", "protocol": 1, "accept": ["jpeg", "png"], "width": 96, "height": 64})
}

impl Client {
    /// Connects without saying hello.
    pub async fn connect(server: &Server) -> Self {
        let url = format!("ws://{}/v1/stream", server.address);
        let (socket, _) = connect_async(url).await.unwrap();
        Self {
            socket,
            polite: true,
        }
    }

    /// Connects with headers; an error is the HTTP status.
    pub async fn connect_with(
        server: &Server,
        query: &str,
        headers: &[(&'static str, String)],
    ) -> Result<Self, u16> {
        let url = format!("ws://{}/v1/stream{query}", server.address);
        let mut request = url.into_client_request().unwrap();
        for (name, value) in headers {
            request.headers_mut().insert(*name, value.parse().unwrap());
        }
        match connect_async(request).await {
            Ok((socket, _)) => Ok(Self {
                socket,
                polite: true,
            }),
            Err(Error::Http(response)) => Err(response.status().as_u16()),
            Err(other) => panic!("{other}"),
        }
    }

    /// Connects, says hello and returns the welcome.
    pub async fn enter(server: &Server, hello: Value) -> (Self, Value) {
        let mut client = Self::connect(server).await;
        client.say(hello).await;
        let welcome = client.json("welcome").await;
        (client, welcome)
    }

    pub async fn say(&mut self, message: Value) {
        self.raw(&message.to_string()).await;
    }

    pub async fn raw(&mut self, text: &str) {
        self.socket
            .send(Message::Text(text.to_owned().into()))
            .await
            .unwrap();
    }

    pub async fn ack(&mut self, frame: u32) {
        self.say(json!({"type": "ack", "frame": frame})).await;
    }

    /// The next message of any kind, acknowledged if it is a frame and the client polite.
    pub async fn next(&mut self) -> Received {
        let received = tokio::time::timeout(SOON, self.receive()).await;
        let received = received.expect("nothing came in time");
        if let (true, Received::Frame(header, _)) = (self.polite, &received) {
            self.ack(header.frame_id).await;
        }
        received
    }

    async fn receive(&mut self) -> Received {
        loop {
            match self.socket.next().await {
                Some(Ok(Message::Text(text))) => {
                    return Received::Json(serde_json::from_str(&text).unwrap());
                }
                Some(Ok(Message::Binary(bytes))) => {
                    let (header, payload) = FrameHeader::decode_message(&bytes).unwrap();
                    return Received::Frame(header, payload.to_vec());
                }
                Some(Ok(Message::Close(frame))) => {
                    let code = frame.map_or(1005, |CloseFrame { code, .. }| code.into());
                    return Received::Closed(code);
                }
                Some(Ok(_)) => {}
                Some(Err(_)) | None => return Received::Closed(1006),
            }
        }
    }

    /// The next JSON message of this type, skipping others.
    pub async fn json(&mut self, kind: &str) -> Value {
        loop {
            match self.next().await {
                Received::Json(value) if value["type"] == kind => return value,
                Received::Closed(code) => panic!("closed with {code} while waiting for {kind}"),
                _ => {}
            }
        }
    }

    /// The next frame, skipping messages.
    pub async fn frame(&mut self) -> (FrameHeader, Vec<u8>) {
        loop {
            match self.next().await {
                Received::Frame(header, payload) => return (header, payload),
                Received::Closed(code) => panic!("closed with {code} while waiting for a frame"),
                Received::Json(_) => {}
            }
        }
    }

    /// The first frame for which `wanted` holds.
    pub async fn frame_where(&mut self, wanted: impl Fn(&FrameHeader) -> bool) -> FrameHeader {
        loop {
            let (header, _) = self.frame().await;
            if wanted(&header) {
                return header;
            }
        }
    }

    /// The code that the server closes with, skipping what comes before.
    pub async fn closed(&mut self) -> u16 {
        loop {
            if let Received::Closed(code) = self.next().await {
                return code;
            }
        }
    }

    /// Everything that comes within `time`.
    pub async fn during(&mut self, time: Duration) -> Vec<Received> {
        let received = Mutex::new(Vec::new());
        let collect = async {
            loop {
                let next = self.next().await;
                received.lock().unwrap().push(next);
            }
        };
        drop(tokio::time::timeout(time, collect).await);
        received.into_inner().unwrap()
    }
}

/// The frames among what came.
pub fn frames(received: &[Received]) -> Vec<FrameHeader> {
    let headers = received.iter().filter_map(|received| match received {
        Received::Frame(header, _) => Some(*header),
        _ => None,
    });
    headers.collect()
}

pub fn camera(input: u64, x: f64) -> Value {
    json!({"type": "camera", "input": input, "camera": {"position": [x, 0, 5],
        "target": [0, 0, 0], "up": [0, 1, 0], "vertical_fov_degrees": 50}})
}
