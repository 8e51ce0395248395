//! Who is heard: tokens, names, origins, connections that say nothing, and places when the server is full.

use std::time::{Duration, Instant};

use serde_json::{Value, json};
use tokio::io::{AsyncReadExt as _, AsyncWriteExt as _};
use tokio::net::TcpStream;
use tyndall_service::ServeError;

use crate::support::{Client, Server, hello, options, scene, start, start_with};

const TOKEN: &str = "p+l/u=s%&#:;?tok";

fn parsed(body: &str) -> Value {
    serde_json::from_str(body).unwrap_or_else(|error| panic!("{error}: {body}"))
}

/// Every byte that is not a letter or digit as %XX, as `encodeURIComponent` does with most of them.
fn encoded(token: &str) -> String {
    let byte = |byte: u8| {
        if byte.is_ascii_alphanumeric() {
            char::from(byte).to_string()
        } else {
            format!("%{byte:02X}")
        }
    };
    token.bytes().map(byte).collect()
}

async fn guarded() -> Server {
    let mut options = options(scene(1));
    options.token = Some(TOKEN.to_owned());
    start_with(options).await
}

#[tokio::test]
async fn tokens_with_signs_work_encoded_and_as_a_header() {
    let server = guarded().await;
    let query = format!("?token={}", encoded(TOKEN));
    let (status, _, body) = server.get(&format!("/v1/access{query}")).await;
    assert_eq!((status, body.as_str()), (204, ""));
    assert!(Client::connect_with(&server, &query, &[]).await.is_ok());
    let bearer = format!("GET /v1/access\nAuthorization: Bearer {TOKEN}");
    assert_eq!(server.http(&bearer, "").await.0, 204);
    // A plus is a plus, and what was decoded is not decoded again.
    let plain_plus = query.replace("%2B", "+");
    assert_eq!(server.get(&format!("/v1/access{plain_plus}")).await.0, 204);
    let twice = query.replace('%', "%25");
    assert_eq!(server.get(&format!("/v1/access{twice}")).await.0, 401);
    server.stop().await;
}

#[tokio::test]
async fn a_wrong_token_is_told_apart_from_none_in_plain_words() {
    let server = guarded().await;
    let (status, _, none) = server.get("/v1/access").await;
    assert_eq!(status, 401);
    let (status, head, wrong) = server.get("/v1/access?token=wrong-token").await;
    assert_eq!(status, 401);
    assert!(head.contains("application/problem+json"), "{head}");
    let (none, wrong) = (parsed(&none), parsed(&wrong));
    assert_eq!(none["title"], "a token is needed");
    assert_eq!(wrong["title"], "the token is wrong");
    let detail = wrong["detail"].as_str().unwrap();
    assert!(
        detail.contains("of 11 characters") && detail.contains("--token"),
        "{detail}"
    );
    assert!(!detail.contains("wrong-token"), "{detail}");
    server.stop().await;
    let open = start(scene(1)).await;
    assert_eq!(open.get("/v1/access").await.0, 204);
    open.stop().await;
}

#[tokio::test]
async fn guessing_tokens_gets_slow_and_is_refused_in_the_end() {
    let server = guarded().await;
    let start = Instant::now();
    for _ in 0..10 {
        assert_eq!(server.get("/v1/access?token=guess").await.0, 401);
    }
    // Eight cost nothing, the ninth half a second, the tenth one less what has passed.
    assert!(
        start.elapsed() >= Duration::from_millis(900),
        "{:?}",
        start.elapsed()
    );
    let guesses: Vec<_> = (0..40)
        .map(|_| server.get("/v1/access?token=guess"))
        .collect();
    let answers = futures_util::future::join_all(guesses).await;
    let refused: Vec<_> = answers
        .iter()
        .filter(|(status, ..)| *status == 429)
        .collect();
    assert!(!refused.is_empty());
    assert!(refused[0].1.contains("retry-after: "), "{}", refused[0].1);
    assert_eq!(parsed(&refused[0].2)["code"], "too_many_attempts");
    server.stop().await;
}

#[tokio::test]
async fn rebound_names_and_other_pages_read_nothing_from_any_route() {
    let server = start(scene(1)).await;
    let port = server.address.port();
    let raw = async |path: &str, headers: &str| {
        let mut stream = TcpStream::connect(server.address).await.unwrap();
        let text = format!("GET {path} HTTP/1.1\r\n{headers}Connection: close\r\n\r\n");
        stream.write_all(text.as_bytes()).await.unwrap();
        let mut answer = String::new();
        stream.read_to_string(&mut answer).await.unwrap();
        answer
    };
    let rebound = format!("Host: evil.example.org:{port}\r\n");
    let own = format!("Host: 127.0.0.1:{port}\r\n");
    let foreign = format!("{own}Origin: http://evil.example.org\r\n");
    let other_scheme = format!("{own}Origin: https://127.0.0.1:{port}\r\n");
    let same = format!("{own}Origin: http://127.0.0.1:{port}\r\n");
    for path in [
        "/",
        "/v1/plan?preset=cornell_fog",
        "/v1/presets",
        "/v1/schema",
        "/v1/access",
        "/metrics",
        "/version",
        "/livez",
        "/readyz",
        "/nothing",
    ] {
        for headers in [&rebound, &foreign, &other_scheme] {
            let answer = raw(path, headers).await;
            assert!(answer.starts_with("HTTP/1.1 403 "), "{path}: {answer}");
            assert!(answer.contains("origin_refused"), "{path}: {answer}");
        }
        let answer = raw(path, &same).await;
        assert!(!answer.starts_with("HTTP/1.1 403 "), "{path}: {answer}");
    }
    let twice = format!("{own}{rebound}");
    for (target, headers) in [
        ("/metrics", &twice),
        ("http://evil.example.org/metrics", &own),
    ] {
        let answer = raw(target, headers).await;
        assert!(answer.starts_with("HTTP/1.1 403 "), "{target}: {answer}");
    }
    let answer = raw("/v1/access", &other_scheme).await;
    let advice = format!("--allow-origin https://127.0.0.1:{port}");
    assert!(answer.contains(&advice), "{answer}");
    server.stop().await;
}

#[tokio::test]
async fn allowed_origins_are_normalised_or_refused_at_the_start() {
    let mut behind_gateway = options(scene(1));
    behind_gateway.allowed_origins = vec!["HTTPS://Tyndall.example.org:443/".to_owned()];
    let server = start_with(behind_gateway).await;
    let headers = [
        ("origin", "https://tyndall.example.org".to_owned()),
        ("host", "tyndall.example.org".to_owned()),
    ];
    assert!(Client::connect_with(&server, "", &headers).await.is_ok());
    server.stop().await;
    let mut wrong = options(scene(1));
    wrong.allowed_origins = vec!["tyndall.example.org".to_owned()];
    let error = wrong.check().unwrap_err();
    assert!(matches!(error, ServeError::OriginUnfit { .. }));
    assert!(error.to_string().contains("no scheme"), "{error}");
}

#[tokio::test]
async fn the_page_may_open_this_servers_socket_and_no_other() {
    let server = start(scene(1)).await;
    let (_, head, _) = server.get("/").await;
    let policy = head
        .lines()
        .find(|line| line.starts_with("content-security-policy"));
    let policy = policy.unwrap();
    let address = server.address;
    let sockets = format!("connect-src 'self' ws://{address} wss://{address};");
    assert!(policy.contains(&sockets), "{policy}");
    server.stop().await;
}

#[tokio::test]
async fn half_requests_take_nobodys_place_and_are_not_waited_for() {
    let mut few = options(scene(1));
    few.limits.max_connections = 8;
    few.limits.header_within = Duration::from_millis(700);
    let server = start_with(few).await;
    let mut silent = Vec::new();
    for _ in 0..200 {
        let mut stream = TcpStream::connect(server.address).await.unwrap();
        // An evicted one may be closed already.
        drop(stream.write_all(b"GET / HTTP/1.1\r\nHost: loc").await);
        silent.push(stream);
    }
    assert_eq!(server.get("/livez").await.0, 200);
    let (_, _, metrics) = server.get("/metrics").await;
    let open = metrics
        .lines()
        .find(|line| line.starts_with("tyndall_connections "));
    let open: f64 = open.unwrap().split(' ').nth(1).unwrap().parse().unwrap();
    assert!(open <= 8.0, "{open} connections");
    let start = Instant::now();
    let mut last = silent.pop().unwrap();
    let mut rest = Vec::new();
    drop(last.read_to_end(&mut rest).await);
    assert!(
        start.elapsed() < Duration::from_secs(5),
        "{:?}",
        start.elapsed()
    );
    server.stop().await;
}

#[tokio::test]
async fn a_body_that_does_not_come_is_given_up() {
    let mut quick = options(scene(1));
    quick.limits.body_within = Duration::from_millis(200);
    let server = start_with(quick).await;
    let mut stream = TcpStream::connect(server.address).await.unwrap();
    let head = "POST /v1/plan HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\nContent-Length: 1000\r\n\r\n{";
    stream.write_all(head.as_bytes()).await.unwrap();
    let mut answer = [0; 4096];
    let read = tokio::time::timeout(Duration::from_secs(5), stream.read(&mut answer)).await;
    let answer = String::from_utf8_lossy(&answer[..read.unwrap().unwrap()]).into_owned();
    assert!(
        answer.starts_with("HTTP/1.1 503") && answer.contains("took_too_long"),
        "{answer}"
    );
    server.stop().await;
}

#[tokio::test]
async fn ones_own_session_is_resumed_when_the_server_is_full() {
    let mut options = options(scene(2));
    options.limits.max_sessions = 2;
    let server = start_with(options).await;
    let (_first, _) = Client::enter(&server, hello()).await;
    let (_mine, welcome) = Client::enter(&server, hello()).await;
    let mut again = hello();
    again["resume"] = welcome["session"].clone();
    let (mut mine, welcome) = Client::enter(&server, again).await;
    assert_eq!(welcome["resumed"], true);
    mine.frame().await;
    let mut other = Client::connect(&server).await;
    other.say(hello()).await;
    assert_eq!(
        other.json("error").await["code"],
        json!("too_many_sessions")
    );
    assert_eq!(other.closed().await, 1013);
    server.stop().await;
}
