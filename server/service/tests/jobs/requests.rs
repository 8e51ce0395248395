//! What is asked of jobs, and what is refused.

use serde_json::{Value, json};
use tyndall_service::JobLimits;

use super::{fetch, finish, post, results, send_form, still, submit, with};
use crate::support::{options, scene, start, start_with};

#[tokio::test(flavor = "multi_thread")]
async fn a_job_is_accepted_made_and_fetched_whole_and_in_ranges() {
    let server = start(scene(1)).await;
    let id = submit(&server, &with(still(3), &json!({"name": "a box"}))).await;
    let done = finish(&server, &id).await;
    assert_eq!(
        (&done["state"], &done["fraction"]),
        (&json!("done"), &json!(1.0))
    );
    assert_eq!((&done["name"], &done["done"]), (&json!("a box"), &json!(1)));
    let results = results(&server, &id).await;
    assert_eq!(results.len(), 1);
    assert_eq!(
        (&results[0]["name"], &results[0]["complete"]),
        (&json!("picture.png"), &json!(true))
    );
    let url = results[0]["url"].as_str().unwrap();
    let (code, head, bytes) = fetch(&server, url, "").await;
    assert_eq!(code, 200);
    assert!(head.contains("content-type: image/png"), "{head}");
    assert_eq!(bytes.len() as u64, results[0]["bytes"].as_u64().unwrap());
    let decoder = png::Decoder::new(std::io::Cursor::new(bytes.clone()));
    let reader = decoder.read_info().unwrap();
    assert_eq!((reader.info().width, reader.info().height), (20, 10));
    let tag = head
        .lines()
        .find_map(|line| line.strip_prefix("etag: "))
        .unwrap()
        .to_owned();
    let same = fetch(&server, url, &format!("If-None-Match: {tag}\r\n")).await;
    assert_eq!((same.0, same.2.len()), (304, 0));
    let (code, head, part) = fetch(&server, url, "Range: bytes=1-3\r\n").await;
    assert_eq!((code, &part[..]), (206, &b"PNG"[..]));
    assert!(
        head.contains(&format!("content-range: bytes 1-3/{}", bytes.len())),
        "{head}"
    );
    let other = "Range: bytes=1-3\r\nIf-Range: \"another\"\r\n";
    assert_eq!(fetch(&server, url, other).await.0, 200);
    let (code, head, _) = fetch(&server, url, "Range: bytes=99999-\r\n").await;
    assert_eq!(code, 416);
    assert!(
        head.contains(&format!("content-range: bytes */{}", bytes.len())),
        "{head}"
    );
    let missing = format!("/v1/jobs/{id}/results/other.png");
    assert_eq!(server.get(&missing).await.0, 404);
    server.stop().await;
}

#[tokio::test(flavor = "multi_thread")]
async fn what_is_wrong_with_a_job_has_a_name_and_a_place() {
    let mut options = options(scene(1));
    options.limits.max_side = 500;
    options.limits.max_body_bytes = 5000;
    let server = start_with(options).await;
    let of = |members: Value| with(still(1), &members).to_string();
    let long = format!("{{\"name\": \"{}\"}}", "x".repeat(6000));
    for (body, code, cause, place) in [
        ("{".to_owned(), 400, "malformed", Value::Null),
        ("{}".to_owned(), 422, "invalid_scene", Value::Null),
        (long, 413, "too_large", Value::Null),
        (
            of(json!({"priority": 99})),
            422,
            "invalid_scene",
            json!("priority"),
        ),
        (
            of(json!({"render": {"samples": 0}})),
            422,
            "invalid_scene",
            json!("render.samples"),
        ),
        (
            of(json!({"render": {"width": 501}})),
            422,
            "invalid_size",
            Value::Null,
        ),
        (
            json!({"preset": "nowhere"}).to_string(),
            404,
            "not_found",
            Value::Null,
        ),
        (
            json!({"scene_file": "../a.json"}).to_string(),
            422,
            "invalid_scene",
            json!("scene_file"),
        ),
        (
            of(json!({"render": {"technique": "instant_vpl", "width": 20, "height": 10}})),
            422,
            "not_rendered_yet",
            Value::Null,
        ),
    ] {
        let (status, head, problem) = post(&server, "", &body).await;
        assert_eq!(
            (status, &problem["code"], &problem["path"]),
            (code, &json!(cause), &place),
            "{problem}"
        );
        assert!(
            head.contains("content-type: application/problem+json"),
            "{head}"
        );
    }
    let (status, _, _) = server
        .http("POST /v1/jobs\nContent-Type: text/plain", "x")
        .await;
    assert_eq!(status, 415);
    for path in [
        "/v1/jobs/nothing",
        "/v1/jobs/00000000000000000000000000000000",
    ] {
        assert_eq!(server.get(path).await.0, 404);
        assert_eq!(server.http(&format!("DELETE {path}"), "").await.0, 404);
        assert_eq!(server.get(&format!("{path}/events")).await.0, 404);
    }
    for query in ["limit=0", "limit=201", "state=lost", "after=x", "color=red"] {
        assert_eq!(
            server.get(&format!("/v1/jobs?{query}")).await.0,
            400,
            "{query}"
        );
    }
    let (_, _, list) = server.get("/v1/jobs").await;
    assert_eq!(list, "{\"jobs\":[]}");
    server.stop().await;
}

#[tokio::test(flavor = "multi_thread")]
async fn a_job_is_only_validated_where_that_is_asked_and_repeated_under_a_key() {
    let server = start(scene(1)).await;
    let job = still(2).to_string();
    let request = "POST /v1/jobs?validate_only=true\nContent-Type: application/json";
    let (status, _, body) = server.http(request, &job).await;
    let body: Value = serde_json::from_str(&body).unwrap();
    assert_eq!((status, &body["tasks"]), (200, &json!(1)), "{body}");
    assert!(body["plan"]["plan"]["passes"].is_array(), "{body}");
    assert_eq!(server.get("/v1/jobs").await.2, "{\"jobs\":[]}");
    let (_, _, first) = post(&server, "Idempotency-Key: one", &job).await;
    let (status, _, again) = post(&server, "Idempotency-Key: one", &job).await;
    assert_eq!((status, &again["id"]), (202, &first["id"]));
    let (status, _, problem) = post(&server, "Idempotency-Key: one", &still(3).to_string()).await;
    assert_eq!((status, &problem["code"]), (409, &json!("conflict")));
    let long = format!("Idempotency-Key: {}", "k".repeat(256));
    assert_eq!(post(&server, &long, &job).await.0, 400);
    server.stop().await;
}

#[tokio::test(flavor = "multi_thread")]
async fn files_come_as_a_form_and_stay_inside_their_folder() {
    let mut options = options(scene(1));
    options.jobs = JobLimits {
        max_upload_bytes: 100_000,
        ..JobLimits::default()
    };
    let server = start_with(options).await;
    let form = |parts: &[(&str, &str)]| -> String {
        let part = |(disposition, body): &(&str, &str)| {
            format!("--limit\r\nContent-Disposition: form-data; {disposition}\r\n\r\n{body}\r\n")
        };
        let parts: String = parts.iter().map(part).collect();
        format!("{parts}--limit--\r\n")
    };
    let job = with(
        json!({"scene_file": "deep/scene.json"}),
        &json!({"render": still(2)["render"]}),
    )
    .to_string();
    let model = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    let mut described = still(1)["scene"].clone();
    described["geometry"] = json!([{"kind": "obj", "path": "model.obj"}]);
    let described = described.to_string();
    let scene_part = (
        "name=\"file\"; filename=\"deep/scene.json\"",
        described.as_str(),
    );
    let model_part = ("name=\"file\"; filename=\"deep/model.obj\"", model);
    let job_part = ("name=\"job\"", job.as_str());
    let (code, accepted) = send_form(&server, form(&[scene_part, model_part, job_part])).await;
    assert_eq!(code, 202, "{accepted}");
    let id = accepted["id"].as_str().unwrap().to_owned();
    assert_eq!(finish(&server, &id).await["state"], "done");
    let long = "x".repeat(100_001);
    for (parts, code, cause) in [
        (vec![scene_part, job_part], 422, "invalid_scene"),
        (vec![scene_part, model_part], 400, "malformed"),
        (
            vec![job_part, ("name=\"file\"; filename=\"../a\"", "x")],
            422,
            "invalid_upload",
        ),
        (
            vec![job_part, ("name=\"file\"; filename=\"a\"", &long)],
            413,
            "too_large",
        ),
        (
            vec![job_part, ("name=\"archive\"; filename=\"a.zip\"", "no zip")],
            422,
            "invalid_upload",
        ),
        (vec![job_part, ("name=\"other\"", "x")], 400, "malformed"),
    ] {
        let (found, problem) = send_form(&server, form(&parts)).await;
        assert_eq!(
            (found, &problem["code"]),
            (code, &json!(cause)),
            "{problem}"
        );
    }
    server.stop().await;
}

#[tokio::test(flavor = "multi_thread")]
async fn a_token_guards_jobs_and_the_document_is_open() {
    let mut options = options(scene(1));
    options.token = Some("a-secret-token".to_owned());
    let server = start_with(options).await;
    assert_eq!(post(&server, "", &still(1).to_string()).await.0, 401);
    assert_eq!(server.get("/v1/jobs").await.0, 401);
    assert_eq!(server.get("/v1/jobs?token=a-secret-token").await.0, 200);
    let bearer = "Authorization: Bearer a-secret-token";
    assert_eq!(post(&server, bearer, &still(1).to_string()).await.0, 202);
    let foreign = "Origin: http://elsewhere.example\nAuthorization: Bearer a-secret-token";
    assert_eq!(post(&server, foreign, &still(1).to_string()).await.0, 403);
    let (code, _, document) = server.get("/openapi.json").await;
    let document: Value = serde_json::from_str(&document).unwrap();
    assert_eq!((code, &document["openapi"]), (200, &json!("3.1.0")));
    let (code, _, page) = server.get("/docs").await;
    assert!(
        code == 200 && page.contains("<script src=\"/docs.js\">"),
        "{page}"
    );
    assert!(
        !page.contains("http://") && !page.contains("https://"),
        "{page}"
    );
    let (code, head, script) = server.get("/docs.js").await;
    assert!(code == 200 && head.contains("text/javascript"), "{head}");
    assert!(script.contains("Redoc.init(\"/openapi.json\""));
    server.stop().await;
}

#[tokio::test(flavor = "multi_thread")]
async fn a_full_queue_refuses_with_a_time_to_try_again() {
    let mut options = options(scene(1));
    options.jobs.max_open_jobs = 1;
    let server = start_with(options).await;
    submit(&server, &still(60_000)).await;
    let (code, head, problem) = post(&server, "", &still(1).to_string()).await;
    assert_eq!((code, &problem["code"]), (503, &json!("queue_full")));
    assert!(head.contains("retry-after: "), "{head}");
    server.stop().await;
}
