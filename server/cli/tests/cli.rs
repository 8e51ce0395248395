//! The binary as a user runs it: exit codes, one-line errors, files.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use tempfile::TempDir;

fn tyndall(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_tyndall"))
        .args(arguments)
        .output()
        .expect("the binary starts")
}

fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

fn text(output: &Output) -> String {
    String::from_utf8_lossy(&output.stdout).into_owned()
}

/// Runs a command that must fail with exit code 1 and one line that contains all of `named`.
fn refused(arguments: &[&str], named: &[&str]) {
    let output = tyndall(arguments);
    let message = stderr(&output);
    assert_eq!(output.status.code(), Some(1), "{arguments:?}: {message}");
    let line = message.lines().last().unwrap_or_default();
    assert!(line.starts_with("tyndall: "), "{message}");
    for word in named {
        assert!(
            line.contains(word),
            "{arguments:?} should name {word}: {message}"
        );
    }
    assert!(!message.contains("panicked"), "{message}");
}

fn scene_file(folder: &TempDir, json: &str) -> String {
    let path = folder.path().join("scene.json");
    fs::write(&path, json).expect("the folder was just made");
    path.to_string_lossy().into_owned()
}

#[test]
fn help_names_every_command() {
    let output = tyndall(&["--help"]);
    assert!(output.status.success());
    for command in [
        "serve", "render", "submit", "compare", "plan", "check", "adapters", "bench",
    ] {
        assert!(text(&output).contains(command), "{command}");
    }
}

#[test]
fn a_wrong_command_line_is_exit_code_2() {
    assert_eq!(tyndall(&["fly"]).status.code(), Some(2));
    assert_eq!(tyndall(&["render", "fogged_hall"]).status.code(), Some(2));
    assert_eq!(
        tyndall(&["--log", "wgpu=loud", "adapters"]).status.code(),
        Some(2)
    );
}

#[test]
fn check_accepts_every_preset_and_names_what_is_wrong_with_a_file() {
    for preset in [
        "fogged_hall",
        "light_shafts",
        "cornell_fog",
        "street_night",
        "swinging_lamp",
        "smoke_plume",
        "cloud",
    ] {
        let output = tyndall(&["check", preset]);
        assert!(output.status.success(), "{preset}: {}", stderr(&output));
        assert!(text(&output).contains("valid"));
    }
    let folder = TempDir::new().unwrap();
    refused(
        &["check", "no_such_scene"],
        &["no_such_scene", "fogged_hall"],
    );
    let path = scene_file(
        &folder,
        "{ \"version\": 1, \"media\": [{ \"kind\": \"homogeneous\", \"sigma_s\": 0.1, \"sigma_a\": 0, \"g\": 1.5 }], \"camera\": { \"position\": [0,0,0], \"target\": [0,0,-1] } }",
    );
    refused(&["check", &path], &["media[0].g", "1.5"]);
    let path = scene_file(&folder, "{ \"version\": 1, ");
    refused(&["check", &path], &["scene.json"]);
    let path = scene_file(
        &folder,
        "{ \"version\": 1, \"camera\": { \"position\": [0,0,0], \"target\": [0,0,-1] }, \"render\": { \"technique\": \"instant_vpl\" } }",
    );
    refused(&["check", &path], &["not rendered yet", "render.technique"]);
}

#[test]
fn plan_prints_a_table_or_json() {
    let output = tyndall(&["plan", "fogged_hall"]);
    assert!(output.status.success());
    assert!(text(&output).contains("single_scattering"));
    let output = tyndall(&["plan", "fogged_hall", "--json"]);
    let plan: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON");
    assert!(
        plan["passes"]
            .as_array()
            .is_some_and(|passes| passes.len() >= 4)
    );
    assert!(plan["skipped"][0]["reason"].is_string());
}

#[test]
fn adapters_lists_at_least_one() {
    let output = tyndall(&["adapters", "--json"]);
    let adapters: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON");
    assert!(!adapters.as_array().expect("array").is_empty());
}

#[test]
fn an_adapter_that_is_not_there_is_named() {
    refused(
        &[
            "render",
            "cornell_fog",
            "-o",
            "x.png",
            "--adapter",
            "no such device",
        ],
        &["no such device", "found"],
    );
}

fn render_to(path: &Path, extra: &[&str]) -> Output {
    let name = path.to_string_lossy().into_owned();
    let mut arguments = vec![
        "render",
        "cornell_fog",
        "-o",
        &name,
        "--width",
        "32",
        "--height",
        "24",
        "--samples",
        "2",
    ];
    arguments.extend(extra);
    tyndall(&arguments)
}

#[test]
fn render_writes_an_exr_with_linear_radiance_and_transmittance() {
    use exr::prelude::{Vec2, read_first_flat_layer_from_file};
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("out.exr");
    let output = render_to(&path, &["--correction", "off"]);
    assert!(output.status.success(), "{}", stderr(&output));
    let image = read_first_flat_layer_from_file(&path).expect("a readable EXR");
    let layer = &image.layer_data;
    assert_eq!(layer.size, Vec2(32, 24));
    let names: Vec<String> = layer
        .channel_data
        .list
        .iter()
        .map(|c| c.name.to_string())
        .collect();
    assert_eq!(names, ["B", "G", "R", "transmittance"]);
    for channel in &layer.channel_data.list {
        let values: Vec<f32> = channel.sample_data.values_as_f32().collect();
        assert!(values.iter().all(|v| v.is_finite() && *v >= 0.0));
        assert!(values.iter().any(|v| *v > 0.0), "{} is black", channel.name);
    }
}

#[test]
fn a_corrected_exr_holds_what_it_was_made_of() {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("out.exr");
    let output = render_to(&path, &["--correction", "always"]);
    assert!(output.status.success(), "{}", stderr(&output));
    let (layers, _) = tyndall_picture::read_exr(&path).expect("a readable EXR");
    let mean = |rgb: &[[f32; 3]]| rgb.iter().flatten().sum::<f32>() / (3.0 * rgb.len() as f32);
    let (base, traced) = (layers.base.unwrap(), layers.traced.unwrap());
    assert!(mean(&base) > 0.0 && mean(&traced) > 0.0);
    assert_ne!(layers.beauty, base);
    assert_ne!(layers.beauty, traced);
    let errors = layers.estimated_error.unwrap();
    assert!(errors.iter().all(|e| e.is_finite() && *e >= 0.0));
    assert!(errors.iter().any(|e| *e > 0.0));
}

#[test]
fn render_says_in_the_exr_where_the_picture_comes_from() {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("out.exr");
    let output = render_to(
        &path,
        &["--seed", "7", "--technique", "single_scattering", "--quiet"],
    );
    assert!(output.status.success(), "{}", stderr(&output));
    let (_, metadata) = tyndall_picture::read_exr(&path).unwrap();
    assert_eq!(metadata.technique, "single_scattering");
    assert_eq!((metadata.seed, metadata.samples), (7, 2));
    assert_eq!(metadata.scene_hash.len(), 32);
    assert!(!metadata.adapter.is_empty());
}

#[test]
fn compare_measures_two_pictures_and_writes_their_errors() {
    let folder = TempDir::new().unwrap();
    let file = |name: &str| folder.path().join(name).to_string_lossy().into_owned();
    for (name, seed) in [("a.exr", "1"), ("b.exr", "2"), ("a.png", "1")] {
        let output = render_to(Path::new(&file(name)), &["--seed", seed, "--quiet"]);
        assert!(output.status.success(), "{}", stderr(&output));
    }
    let output = tyndall(&[
        "compare",
        &file("a.exr"),
        &file("b.exr"),
        "--json",
        "--error-image",
        &file("error.png"),
    ]);
    assert!(output.status.success(), "{}", stderr(&output));
    let measures: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON");
    let error = measures["relative_rmse"].as_f64().expect("a number");
    // Two pictures of a few samples, whose area light is mostly noise.
    assert!(error > 0.0 && error < 3.0, "{error}");
    assert!(measures["block_z"].is_null(), "no variance is known");
    assert!(measures["hdr_flip"].as_f64().is_some_and(|flip| flip > 0.0));
    assert!(Path::new(&file("error.png")).exists());

    let same = tyndall(&["compare", &file("a.png"), &file("a.png")]);
    assert!(text(&same).contains("ldr_flip"), "{}", text(&same));
    refused(
        &["compare", &file("a.png"), &file("b.exr")],
        &["displayed", "radiance"],
    );
    refused(&["compare", "no.exr", "no.exr"], &["no.exr"]);
}

#[test]
fn render_writes_a_png_of_the_asked_size() {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("out.png");
    let output = render_to(&path, &["--quiet"]);
    assert!(output.status.success(), "{}", stderr(&output));
    let decoder = png::Decoder::new(std::io::BufReader::new(fs::File::open(&path).unwrap()));
    let reader = decoder.read_info().unwrap();
    assert_eq!((reader.info().width, reader.info().height), (32, 24));
    assert!(!folder.path().join("out.partial").exists());
}

#[test]
fn render_refuses_what_it_cannot_write_before_rendering() {
    refused(
        &["render", "cornell_fog", "-o", "picture.tiff"],
        &["picture.tiff", ".exr, .png or .jpg"],
    );
    refused(
        &["render", "cornell_fog", "-o", "no/such/folder/x.png"],
        &["folder"],
    );
    refused(
        &["render", "cornell_fog", "-o", "x.png", "--width", "0"],
        &["render.width", "0"],
    );
    refused(
        &["render", "cornell_fog", "-o", "x.png", "--time", "-1"],
        &["time_seconds"],
    );
    refused(
        &["render", "cornell_fog", "-o", "x.png", "--error", "7"],
        &["relative_error", "7"],
    );
    refused(
        &[
            "render",
            "cornell_fog",
            "-o",
            "x.png",
            "--technique",
            "instant_vpl",
        ],
        &["instant_vpl"],
    );
}

#[test]
fn serving_beyond_loopback_without_a_token_is_refused() {
    refused(&["serve", "cornell_fog", "--bind", "0.0.0.0:0"], &["token"]);
}
