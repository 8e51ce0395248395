//! `tyndall serve` as a process: what it says, what it keeps to itself, and its options.

use std::io::{BufRead as _, BufReader, Read as _};
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

use futures_util::{SinkExt as _, StreamExt as _};
use serde_json::{Value, json};
use tempfile::TempDir;
use tokio_tungstenite::connect_async;
use tokio_tungstenite::tungstenite::Message;

const TOKEN: &str = "a-server's+token/of=this&test";
/// How long a first start on a cold cache of kernels may take.
const START_WITHIN: Duration = Duration::from_mins(2);

fn tyndall(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_tyndall"))
        .args(arguments)
        .output()
        .expect("the binary starts")
}

fn said(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// A scene that renders at once.
fn fog(folder: &TempDir) -> String {
    let scene = json!({
        "version": 1,
        "camera": {"position": [0, 0, 5], "target": [0, 0, 0]},
        "lights": [{"kind": "point", "position": [0, 3, 3], "intensity": 50}],
        "media": [{"kind": "homogeneous", "sigma_s": 0.05, "sigma_a": 0.01}],
        "render": {"samples": 1, "correction": "off"},
    });
    let path = folder.path().join("fog.json");
    std::fs::write(&path, scene.to_string()).expect("the folder was just made");
    path.to_string_lossy().into_owned()
}

/// Waits for a process that was told to end.
fn wait(child: &mut Child, within: Duration) {
    let begin = Instant::now();
    while child.try_wait().expect("it is a child").is_none() {
        if begin.elapsed() > within {
            child.kill().expect("it lives");
            panic!("it still lives after {within:?}");
        }
        std::thread::sleep(Duration::from_millis(20));
    }
}

/// Says hello and returns the name of the session, which is secret.
async fn session(address: &str, resume: Option<&str>) -> String {
    let token = "a-server%27s%2Btoken%2Fof%3Dthis%26test";
    let url = format!("ws://{address}/v1/stream?token={token}");
    let (mut socket, _) = connect_async(url).await.expect("the token is right");
    let hello = json!({"type": "hello", "protocol": 1, "accept": ["png"], "width": 32, "height": 24,
        "resume": resume});
    let text = Message::Text(hello.to_string().into());
    socket.send(text).await.expect("the server listens");
    loop {
        let message = socket.next().await.expect("a welcome").expect("a welcome");
        if let Message::Text(text) = message {
            let message: Value = serde_json::from_str(&text).expect("JSON");
            if message["type"] == "welcome" {
                assert_eq!(message["resumed"], json!(resume.is_some()));
                let name = message["session"].as_str().expect("a name").to_owned();
                socket.close(None).await.expect("a goodbye");
                return name;
            }
        }
    }
}

#[tokio::test]
async fn the_log_has_no_colours_and_no_secrets_and_says_last_where_to_look() {
    let folder = TempDir::new().unwrap();
    let mut child = Command::new(env!("CARGO_BIN_EXE_tyndall"))
        .args([
            "serve",
            &fog(&folder),
            "--bind",
            "127.0.0.1:0",
            "--log",
            "trace,naga=warn",
        ])
        .args(["--drain-within", "3s"])
        .env("TYNDALL_TOKEN", TOKEN)
        .env_remove("NO_COLOR")
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the binary starts");
    let mut log = child.stderr.take().expect("a pipe");
    let read = move || {
        let mut bytes = Vec::new();
        log.read_to_end(&mut bytes).expect("a log");
        String::from_utf8_lossy(&bytes).into_owned()
    };
    let reader = std::thread::Builder::new().name("log".to_owned());
    let log = reader.spawn(read).expect("a thread");
    let mut out = BufReader::new(child.stdout.take().expect("a pipe")).lines();
    let line = out.next().expect("a line").expect("text");
    let address = line
        .strip_prefix("tyndall: http://")
        .and_then(|rest| rest.strip_suffix("/?token=YOUR_TOKEN"))
        .unwrap_or_else(|| panic!("{line}"))
        .to_owned();
    let exchange = async {
        let name = session(&address, None).await;
        assert_eq!(session(&address, Some(&name)).await, name);
        name
    };
    let name = tokio::time::timeout(START_WITHIN, exchange)
        .await
        .expect("in time");
    let kill = Command::new("kill").arg(child.id().to_string()).status();
    assert!(kill.expect("kill runs").success());
    wait(&mut child, Duration::from_secs(5));
    let log = log.join().expect("the log is read");
    assert!(log.contains("TRACE"), "it is a whole log");
    assert!(!log.contains('\u{1b}'), "colours");
    for secret in [name.as_str(), TOKEN, "a-server%27s"] {
        let leak = log.lines().find(|line| line.contains(secret));
        assert_eq!(leak, None, "a secret is in the log");
    }
    let before = log.split("listening").next().expect("a part");
    let assets = |line: &&str| line.contains("INFO") && line.contains("asset");
    assert_eq!(before.lines().find(assets), None);
}

#[test]
fn every_limit_is_an_option_and_shown_with_its_default() {
    let help = said(&tyndall(&["serve", "--help"]).stdout);
    for (option, default) in [
        ("--max-sessions", "16"),
        ("--max-connections", "256"),
        ("--max-pixels", "8294400"),
        ("--max-side", "8192"),
        ("--max-message-bytes", "1048576"),
        ("--max-body-bytes", "4194304"),
        ("--resume-for", "60s"),
        ("--header-within", "10s"),
        ("--body-within", "20s"),
        ("--plan-within", "10s"),
        ("--hello-within", "5s"),
        ("--ping-every", "10s"),
        ("--send-within", "20s"),
        ("--drain-within", "10s"),
        ("--edit-percent", "20"),
        ("--picture-memory", "4096"),
        ("--device-memory", "16384"),
    ] {
        let at = help
            .find(option)
            .unwrap_or_else(|| panic!("{option}: {help}"));
        let rest = help[at..].split("[default: ").nth(1).unwrap_or_default();
        assert!(rest.starts_with(&format!("{default}]")), "{option}: {rest}");
    }
    let output = tyndall(&["serve", "cornell_fog", "--drain-within", "0s"]);
    assert_eq!(output.status.code(), Some(2));
}

#[test]
fn an_origin_that_is_none_is_refused_at_the_start() {
    let output = tyndall(&[
        "serve",
        "cornell_fog",
        "--allow-origin",
        "tyndall.example.org/page",
    ]);
    assert_eq!(output.status.code(), Some(1));
    let message = said(&output.stderr);
    assert!(message.contains("tyndall.example.org/page"), "{message}");
    assert!(message.contains("cannot be allowed: "), "{message}");
}

#[test]
fn an_error_names_its_file_once() {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("once.json");
    std::fs::create_dir(&path).unwrap();
    let name = path.to_string_lossy().into_owned();
    for arguments in [
        vec!["check", &name],
        vec!["compare", &name, &name],
        vec!["bench", &name],
    ] {
        let output = tyndall(&arguments);
        let message = said(&output.stderr);
        assert_eq!(output.status.code(), Some(1), "{message}");
        let last = message.lines().last().unwrap_or_default();
        assert_eq!(last.matches("once.json").count(), 1, "{last}");
        assert!(last.matches("regular file").count() <= 1, "{last}");
    }
}

#[test]
fn the_help_of_bench_says_what_it_is() {
    for arguments in [["--help"].as_slice(), &["bench", "--help"]] {
        let help = said(&tyndall(arguments).stdout);
        assert!(help.contains("un time against error"), "{help}");
    }
}

#[test]
fn a_bad_scene_does_not_end_a_bench() {
    let folder = TempDir::new().unwrap();
    let good = fog(&folder);
    let bad = folder.path().join("bad.json");
    std::fs::write(&bad, "{").unwrap();
    let bad = bad.to_string_lossy().into_owned();
    let output = tyndall(&[
        "bench",
        &bad,
        &good,
        "no_such_scene",
        "--quick",
        "--quiet",
        "--frames",
        "0",
        "--width",
        "16",
        "--height",
        "12",
        "--techniques",
        "single_scattering",
        "--truth-samples",
        "2",
        "--row-time",
        "100ms",
    ]);
    assert_eq!(output.status.code(), Some(1));
    let (table, message) = (said(&output.stdout), said(&output.stderr));
    assert!(table.contains(&format!("{bad}: not measured: ")), "{table}");
    assert!(table.contains("single_scattering"), "{table}");
    let last = message.lines().last().unwrap_or_default();
    assert!(
        last.contains("2 of 3 scenes could not be measured"),
        "{last}"
    );
    assert!(
        last.contains("bad.json") && last.contains("no_such_scene"),
        "{last}"
    );
}
