//! HTTP: addresses, errors, access.

use crate::support::{self, Client, hello, options, scene, start, start_with};
use serde_json::{Value, json};
use tyndall_service::ServeError;
use tyndall_stream::protocol::ErrorCode;

const TOKEN: &str = "correct-horse-battery";

fn parsed(body: &str) -> Value {
    serde_json::from_str(body).unwrap_or_else(|error| panic!("{error}: {body}"))
}

#[tokio::test]
async fn unknown_addresses_and_methods_are_problems() {
    let server = start(scene(1)).await;
    for (request, status, code) in [
        ("GET /nothing", 404, "not_found"),
        ("GET /v1/presets/nothing", 404, "not_found"),
        ("GET /v1/plan?preset=nothing", 404, "not_found"),
        ("GET /v1/plan", 400, "malformed"),
        ("GET /v1/stream", 400, "malformed"),
        ("DELETE /v1/presets", 405, "method_not_allowed"),
        ("POST /v1/plan", 415, "unsupported_media_type"),
    ] {
        let (found, head, body) = server.http(request, "").await;
        assert_eq!(found, status, "{request}: {body}");
        assert!(
            head.contains("content-type: application/problem+json"),
            "{request}: {head}"
        );
        let problem = parsed(&body);
        assert_eq!(problem["code"], code, "{request}");
        assert_eq!(problem["status"], status);
        assert!(
            problem["detail"]
                .as_str()
                .is_some_and(|detail| !detail.is_empty())
        );
    }
    server.stop().await;
}

#[tokio::test]
async fn page_and_its_security_headers() {
    let server = start(scene(1)).await;
    let (status, head, body) = server.get("/").await;
    assert_eq!(status, 200);
    assert!(head.contains("content-type: text/html"), "{head}");
    assert!(body.contains("<html"), "{body}");
    for header in [
        "content-security-policy: default-src 'self'",
        "x-content-type-options: nosniff",
        "x-frame-options: deny",
        "referrer-policy: no-referrer",
    ] {
        assert!(head.contains(header), "{header} is missing in {head}");
    }
    server.stop().await;
}

#[tokio::test]
async fn health_version_presets_schema_and_metrics() {
    let server = start(scene(1)).await;
    assert_eq!(server.get("/livez").await.0, 200);
    assert_eq!(server.get("/readyz").await.0, 200);
    let version = parsed(&server.get("/version").await.2);
    assert_eq!(
        (&version["name"], &version["protocol"]),
        (&json!("tyndall"), &json!(1))
    );
    let presets = parsed(&server.get("/v1/presets").await.2);
    let name = presets[0]["name"].as_str().unwrap().to_owned();
    let preset = parsed(&server.get(&format!("/v1/presets/{name}")).await.2);
    assert_eq!(preset["version"], 1);
    let schema = parsed(&server.get("/v1/schema").await.2);
    assert!(schema["properties"]["media"].is_object());
    let (mut client, _) = Client::enter(&server, hello()).await;
    client.json("stats").await;
    let (status, head, text) = server.get("/metrics").await;
    assert_eq!(status, 200);
    assert!(head.contains("text/plain"));
    for name in [
        "tyndall_frames_rendered_total",
        "tyndall_frames_sent_total",
        "tyndall_frames_dropped_total",
        "tyndall_bytes_sent_total",
        "tyndall_non_finite_pixels_total 0",
        "tyndall_negative_pixels_total 0",
        "tyndall_frame_render_seconds_bucket",
        "tyndall_encode_seconds_bucket",
        "tyndall_sessions",
        "tyndall_ready",
    ] {
        assert!(text.contains(name), "{name} is missing in\n{text}");
    }
    server.stop().await;
}

#[tokio::test]
async fn plan_of_a_posted_scene_or_its_first_error() {
    let server = start(scene(1)).await;
    let post = "POST /v1/plan\nContent-Type: application/json";
    let good = scene(1).description.to_json().unwrap();
    let (status, _, body) = server.http(post, &good).await;
    assert_eq!(status, 200, "{body}");
    let reply = parsed(&body);
    assert_eq!(reply["facts"]["triangles"], 12);
    assert!(reply["plan"]["passes"].is_array());
    let bad = good
        .replace("\"falloff\"", "\"fall\"")
        .replace("\"version\": 1", "\"version\": 7");
    let (status, _, body) = server.http(post, &bad).await;
    assert_eq!(status, 422, "{body}");
    assert_eq!(parsed(&body)["path"], "version");
    assert_eq!(server.http(post, "{").await.0, 400);
    let file = good.replacen(
        "\"kind\": \"box\"",
        "\"kind\": \"obj\", \"path\": \"/etc/passwd\"",
        1,
    );
    assert_eq!(server.http(post, &file).await.0, 422);
    server.stop().await;
    let mut small = options(scene(1));
    small.limits.max_body_bytes = 100;
    let server = start_with(small).await;
    let (status, _, body) = server.http(post, &good).await;
    assert_eq!((status, &parsed(&body)["code"]), (413, &json!("too_large")));
    server.stop().await;
}

#[tokio::test]
async fn stream_is_refused_to_pages_of_other_sites() {
    let server = start(scene(1)).await;
    let origin = |text: String| [("origin", text)];
    let port = server.address.port();
    let own = format!("http://127.0.0.1:{port}");
    assert!(
        Client::connect_with(&server, "", &origin(own))
            .await
            .is_ok()
    );
    for foreign in [
        "http://example.org".to_owned(),
        format!("http://example.org:{port}"),
        format!("http://127.0.0.1:{}", port.wrapping_add(1)),
        "null".to_owned(),
    ] {
        let refused = Client::connect_with(&server, "", &origin(foreign.clone())).await;
        assert_eq!(refused.err(), Some(403), "{foreign}");
    }
    // A name that an attacker makes resolve to this machine.
    let rebound = format!("evil.example.org:{port}");
    let headers = [("origin", format!("http://{rebound}")), ("host", rebound)];
    assert_eq!(
        Client::connect_with(&server, "", &headers).await.err(),
        Some(403)
    );
    server.stop().await;
    let mut behind_gateway = options(scene(1));
    behind_gateway.allowed_origins = vec!["https://tyndall.example.org".to_owned()];
    let server = start_with(behind_gateway).await;
    let allowed = origin("https://tyndall.example.org".to_owned());
    assert!(Client::connect_with(&server, "", &allowed).await.is_ok());
    server.stop().await;
}

#[tokio::test]
async fn token_guards_everything_but_page_and_probes() {
    let mut guarded = options(scene(1));
    guarded.token = Some(TOKEN.to_owned());
    let server = start_with(guarded).await;
    for path in ["/", "/livez", "/readyz", "/version"] {
        assert_eq!(server.get(path).await.0, 200, "{path}");
    }
    for path in [
        "/v1/presets",
        "/v1/schema",
        "/metrics",
        "/v1/presets?token=wrong-token",
    ] {
        let (status, head, body) = server.get(path).await;
        assert_eq!(
            (status, &parsed(&body)["code"]),
            (401, &json!("unauthorized")),
            "{path}"
        );
        assert!(head.contains("www-authenticate: bearer"));
    }
    assert_eq!(
        server.get(&format!("/v1/presets?token={TOKEN}")).await.0,
        200
    );
    let bearer = format!("GET /metrics\nAuthorization: Bearer {TOKEN}");
    assert_eq!(server.http(&bearer, "").await.0, 200);
    assert_eq!(
        Client::connect_with(&server, "", &[]).await.err(),
        Some(401)
    );
    let query = format!("?token={TOKEN}");
    assert!(Client::connect_with(&server, &query, &[]).await.is_ok());
    server.stop().await;
}

#[test]
fn public_address_needs_a_fitting_token() {
    let with = |bind: &str, token: Option<&str>| {
        let mut options = options(scene(1));
        options.bind = bind.parse().unwrap();
        options.token = token.map(str::to_owned);
        options.check()
    };
    assert!(matches!(
        with("0.0.0.0:8080", None),
        Err(ServeError::TokenNeeded { .. })
    ));
    assert!(matches!(
        with("[::]:8080", None),
        Err(ServeError::TokenNeeded { .. })
    ));
    assert!(matches!(
        with("0.0.0.0:8080", Some("")),
        Err(ServeError::TokenUnfit)
    ));
    assert!(matches!(
        with("127.0.0.1:0", Some("with space")),
        Err(ServeError::TokenUnfit)
    ));
    assert!(with("0.0.0.0:8080", Some(TOKEN)).is_ok());
    assert!(with("127.0.0.1:0", None).is_ok());
    assert!(with("[::1]:0", None).is_ok());
}

#[tokio::test]
async fn taken_address_is_an_error_that_names_it() {
    let server = start(scene(1)).await;
    let mut second = options(scene(1));
    second.bind = server.address;
    let open = support::Fake::opener(&server.script);
    let error = tyndall_service::serve_on(second, open, server.shutdown.clone())
        .await
        .unwrap_err();
    assert!(
        error.to_string().contains(&server.address.to_string()),
        "{error}"
    );
    server.stop().await;
}

#[test]
fn every_code_has_an_error_status() {
    for code in [
        ErrorCode::Malformed,
        ErrorCode::TooManySessions,
        ErrorCode::Internal,
    ] {
        let (status, title) = tyndall_service::problem::status_and_title(code);
        assert!(status.is_client_error() || status.is_server_error());
        assert!(!title.ends_with('.'));
    }
}
