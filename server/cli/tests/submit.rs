//! `tyndall submit` against `tyndall serve`: equal bits, and results that outlive a killed server.

#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use std::path::Path;
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

use serde_json::json;
use tempfile::TempDir;

/// How long a first start on a cold cache of kernels may take.
const START_WITHIN: Duration = Duration::from_mins(2);

fn tyndall(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_tyndall"))
        .args(arguments)
        .output()
        .expect("the binary starts")
}

/// A scene of two files.
fn scene(folder: &Path) -> String {
    let scene = json!({
        "version": 1,
        "camera": {"position": [0, 0, 5], "target": [0, 0, 0]},
        "geometry": [{"kind": "obj", "path": "./models/tile.obj"}],
        "lights": [{"kind": "point", "position": [0, 3, 3], "intensity": 50}],
        "media": [{"kind": "homogeneous", "sigma_s": 0.05, "sigma_a": 0.01}],
        "render": {"width": 40, "height": 30, "samples": 3},
    });
    std::fs::create_dir(folder.join("models")).unwrap();
    let model = "v -1 -1 0\nv 1 -1 0\nv 0 1 0\nf 1 2 3\n";
    std::fs::write(folder.join("models/tile.obj"), model).unwrap();
    let path = folder.join("scene.json");
    std::fs::write(&path, scene.to_string()).unwrap();
    path.to_string_lossy().into_owned()
}

/// A server on a free port that ends with the test.
struct Server {
    process: Child,
    url: String,
}

impl Server {
    fn start(folder: &Path) -> Self {
        let port_file = folder.join("port");
        std::fs::remove_file(&port_file).unwrap_or_default();
        let data = folder.join("data");
        let process = Command::new(env!("CARGO_BIN_EXE_tyndall"))
            .args([
                "serve",
                "cornell_fog",
                "--bind",
                "127.0.0.1:0",
                "--port-file",
            ])
            .arg(&port_file)
            .arg("--data")
            .arg(data)
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .expect("the binary starts");
        let mut server = Self {
            process,
            url: String::new(),
        };
        let began = Instant::now();
        while server.url.is_empty() {
            assert!(began.elapsed() < START_WITHIN, "the server does not start");
            assert!(server.process.try_wait().unwrap().is_none(), "it ended");
            if let Ok(address) = std::fs::read_to_string(&port_file) {
                server.url = format!("http://{}", address.trim());
            }
            std::thread::sleep(Duration::from_millis(20));
        }
        server
    }
}

impl Drop for Server {
    /// SIGKILL: nothing is put in order.
    fn drop(&mut self) {
        self.process.kill().unwrap_or_default();
        self.process.wait().map(drop).unwrap_or_default();
    }
}

#[test]
fn a_submitted_scene_has_the_bits_of_a_rendered_one_and_outlives_its_server() {
    let folder = TempDir::new().unwrap();
    let scene = scene(folder.path());
    let path = |name: &str| folder.path().join(name).to_string_lossy().into_owned();
    for name in ["here.png", "here.exr"] {
        let output = tyndall(&["render", &scene, "-q", "-o", &path(name)]);
        assert!(
            output.status.success(),
            "{}",
            String::from_utf8_lossy(&output.stderr)
        );
    }
    let server = Server::start(folder.path());
    let submit = |server: &Server, name: &str| {
        let output = tyndall(&["submit", &scene, "--server", &server.url, "-o", &path(name)]);
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.success(), "{said}");
        said
    };
    submit(&server, "there.png");
    submit(&server, "there.exr");
    let read = |name: &str| std::fs::read(path(name)).unwrap();
    assert!(
        read("here.png") == read("there.png"),
        "the displayed picture"
    );
    assert!(
        read("here.exr") == read("there.exr"),
        "linear radiance and all layers"
    );
    let wrong = [
        "submit",
        "cornell_fog",
        "--server",
        &server.url,
        "--priority",
        "11",
        "-o",
        "a.png",
    ];
    let refused = tyndall(&wrong);
    let said = String::from_utf8_lossy(&refused.stderr).into_owned();
    assert!(
        refused.status.code() == Some(1) && said.contains("priority"),
        "{said}"
    );
    drop(server);
    std::fs::remove_file(path("there.png")).unwrap();
    // What was made is still there: the second server renders nothing for it.
    let server = Server::start(folder.path());
    submit(&server, "there.png");
    assert!(read("here.png") == read("there.png"));
}
