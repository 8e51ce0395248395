//! Files that would hang, end or fill the process if they were read as they stand.

#![allow(
    clippy::unwrap_used,
    reason = "helpers of tests, too, fail by unwrapping"
)]

use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::sync::mpsc::sync_channel;
use std::time::{Duration, Instant};

use serde_json::json;
use tyndall_scene::load;

/// How long any of these files may take.
const SOON: Duration = Duration::from_secs(10);

/// Why a file is refused, which has to be said soon.
fn refusal(file: &Path) -> String {
    let (tell, told) = sync_channel(1);
    let path = file.to_owned();
    std::thread::Builder::new()
        .spawn(move || {
            let loaded = load(&path).map(|_| ()).map_err(|error| error.to_string());
            drop(tell.send(loaded));
        })
        .unwrap();
    let loaded = told.recv_timeout(SOON);
    let loaded = loaded.unwrap_or_else(|_| panic!("{} panics or hangs", file.display()));
    loaded.expect_err("it is refused")
}

fn write(folder: &Path, name: &str, bytes: &[u8]) -> PathBuf {
    let file = folder.join(name);
    std::fs::write(&file, bytes).unwrap();
    file
}

fn pipe(folder: &Path, name: &str) -> PathBuf {
    let file = folder.join(name);
    let made = std::process::Command::new("mkfifo").arg(&file).status();
    assert!(made.unwrap().success());
    file
}

/// A scene whose only medium is a grid file.
fn with_grid(folder: &Path, grid: &str) -> PathBuf {
    let scene = json!({
        "version": 1,
        "camera": {"position": [0, 0, 3], "target": [0, 0, 0]},
        "media": [{"kind": "grid", "path": grid, "sigma_s": 1, "sigma_a": 0}],
    });
    write(folder, "scene.json", scene.to_string().as_bytes())
}

/// A PNG of one pixel whose table of colours ends within a colour.
fn cut_palette() -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, 1, 1);
    encoder.set_color(png::ColorType::Indexed);
    encoder.set_palette(vec![1, 2, 3, 4]);
    let mut writer = encoder.write_header().unwrap();
    writer.write_image_data(&[0]).unwrap();
    writer.finish().unwrap();
    bytes
}

#[test]
fn a_texture_whose_decoder_panics_is_refused_by_name() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    write(folder, "a.png", &cut_palette());
    write(folder, "a.mtl", b"newmtl a\nmap_Kd a.png\n");
    let text = b"mtllib a.mtl\nusemtl a\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    let error = refusal(&write(folder, "a.obj", text));
    assert!(
        error.contains("a.png: image: the decoder of PNG and JPEG failed on this file"),
        "{error}"
    );
}

#[test]
fn pipes_are_refused_wherever_a_file_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let is_pipe = |error: &str, name: &str| {
        assert!(error.contains("a named pipe"), "{error}");
        assert!(error.contains(name), "{error}");
    };
    is_pipe(&refusal(&pipe(folder, "whole.json")), "whole.json");
    pipe(folder, "smoke.vdb");
    is_pipe(&refusal(&with_grid(folder, "smoke.vdb")), "smoke.vdb");
    write(folder, "fog.raw", &[0; 8]);
    pipe(folder, "fog.raw.json");
    is_pipe(&refusal(&with_grid(folder, "fog.raw")), "fog.raw.json");
    pipe(folder, "a.mtl");
    let obj = write(folder, "a.obj", b"mtllib a.mtl\nv 0 0 0\n");
    is_pipe(&refusal(&obj), "a.mtl");
}

#[test]
fn few_zipped_bytes_are_little_work() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let npz = |side: u32| {
        let header = format!(
            "{{'descr': '<f4', 'fortran_order': False, 'shape': ({side}, {side}, {side}), }}"
        );
        let file = std::fs::File::create(folder.join("zeros.npz")).unwrap();
        let mut writer = zip::ZipWriter::new(file);
        let options = zip::write::SimpleFileOptions::default()
            .compression_method(zip::CompressionMethod::Deflated);
        writer.start_file("density.npy", options).unwrap();
        writer.write_all(b"\x93NUMPY\x01\x00\x76\x00").unwrap();
        writer
            .write_all(format!("{header:<117}\n").as_bytes())
            .unwrap();
        let slice = vec![0_u8; 4 * (side * side) as usize];
        for _ in 0..side {
            writer.write_all(&slice).unwrap();
        }
        writer.finish().unwrap();
        with_grid(folder, "zeros.npz")
    };
    // As many zeros as took 18 s, and as many as are still read.
    let error = refusal(&npz(640));
    assert!(
        error.contains("zeros.npz: array: found 1048576128 bytes from"),
        "{error}"
    );
    let scene = npz(272);
    let start = Instant::now();
    load(&scene).unwrap();
    assert!(
        start.elapsed() < Duration::from_secs(3),
        "{:?}",
        start.elapsed()
    );
}
