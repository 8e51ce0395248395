//! Time and variance of the path tracer on the reference scenes: `cargo run -p tyndall-tests --example
//! efficiency -- [SAMPLES] [NAME]...`. CPU seconds of the process, first dispatch (compilation) left out.

#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "a tool for developers"
)]

use std::sync::Arc;

use tyndall_scene::{StopRule, Technique};
use tyndall_tests::{gpu, npz, pm_ref, shared_folder};

/// CPU time of this process so far. Unit: s.
fn cpu_seconds() -> f64 {
    let stat = std::fs::read_to_string("/proc/self/stat").unwrap();
    let fields: Vec<&str> = stat
        .rsplit(')')
        .next()
        .unwrap()
        .split_whitespace()
        .collect();
    let ticks: f64 = fields[11].parse::<f64>().unwrap() + fields[12].parse::<f64>().unwrap();
    ticks / 100.0
}

fn main() {
    let mut arguments = std::env::args().skip(1);
    let samples: u32 = arguments.next().map_or(64, |s| s.parse().unwrap());
    let only: Vec<String> = arguments.collect();
    let scenes = [
        ("fog_box", "full"),
        ("fog_box", "single"),
        ("exp_fog", "single"),
        ("furnace", "full"),
        ("light_shafts", "full"),
        ("light_shafts", "single"),
        ("smoke_plume", "full"),
        ("smoke_plume", "single"),
    ];
    let mut renderer = gpu::renderer();
    for (name, kind) in scenes {
        if !only.is_empty()
            && !only
                .iter()
                .any(|o| format!("{name}_{kind}").starts_with(o.as_str()))
        {
            continue;
        }
        let Some(shared) = shared_folder::find(name) else {
            continue;
        };
        let description =
            pm_ref::load(&shared.join(format!("reference/scenes/{name}.json"))).unwrap();
        let Ok(loaded) = tyndall_scene::build(description, Some(&shared.join("reference"))) else {
            println!("{name}: not loaded");
            continue;
        };
        let mut scene = loaded.scene;
        scene.render.technique = Technique::Reference;
        if kind == "single" {
            scene.render.reference.max_scatterings = Some(1);
        }
        let (width, height) = (scene.render.width as usize, scene.render.height as usize);
        scene.render.stop = StopRule::Samples(1);
        let mut view =
            match renderer.create_view(Arc::new(scene.clone()), width as u32, height as u32) {
                Ok(view) => view,
                Err(error) => {
                    println!("{name}: {error}");
                    continue;
                }
            };
        view.set_slice_budget(std::time::Duration::from_millis(20000));
        renderer.render_still(&mut view, |_| {}).unwrap();
        scene.render.seed = 7;
        scene.render.stop = StopRule::Samples(samples);
        renderer.update_view(&mut view, Arc::new(scene)).unwrap();
        let (wall, cpu) = (std::time::Instant::now(), cpu_seconds());
        let still = renderer.render_still(&mut view, |_| {}).unwrap();
        let (wall, cpu) = (wall.elapsed().as_secs_f64(), cpu_seconds() - cpu);
        let file = shared.join(format!("reference/data/ref_{name}_{kind}.npz"));
        let mean = npz::read_f32(&file, "mean").unwrap();
        let stderr = npz::read_f32(&file, "stderr").unwrap();
        let mut errors: Vec<f64> = (0..width * height)
            .map(|p| {
                (0..3)
                    .map(|c| {
                        let i = 3 * p + c;
                        (f64::from(still.radiance[p][c]) - f64::from(mean[i])).powi(2)
                            - f64::from(stderr[i]).powi(2)
                    })
                    .sum::<f64>()
                    / 3.0
            })
            .collect();
        errors.sort_by(f64::total_cmp);
        let kept = errors.len() - errors.len().div_ceil(1000);
        let level = mean.iter().map(|v| f64::from(*v)).sum::<f64>() / mean.len() as f64;
        let against = (errors[..kept].iter().sum::<f64>().max(0.0) / kept as f64).sqrt() / level;
        if let Ok(folder) = std::env::var("DUMP") {
            let flat: Vec<f32> = still
                .variance
                .as_ref()
                .unwrap()
                .iter()
                .flatten()
                .copied()
                .chain(still.radiance.iter().flat_map(|p| [p[0], p[1], p[2]]))
                .collect();
            std::fs::write(
                format!("{folder}/{name}_{kind}.raw"),
                flat.iter()
                    .flat_map(|v| v.to_le_bytes())
                    .collect::<Vec<u8>>(),
            )
            .unwrap();
        }
        let mut variances: Vec<f64> = still
            .variance
            .as_ref()
            .unwrap()
            .iter()
            .map(|v| v.iter().map(|x| f64::from(*x)).sum::<f64>() / 3.0)
            .collect();
        variances.sort_by(f64::total_cmp);
        let own = (variances[..kept].iter().sum::<f64>() / kept as f64).sqrt() / level;
        println!(
            "{name:>13} {kind:<6} {samples:>5} spp  wall {wall:7.2} cpu {cpu:7.2} s  ref relRMSE_trim {against:.4}  own {own:.4} est {:.4}  efficiency 1/(cpu·e²) {:8.2} (own {:8.2})  truncated {} non-finite {}",
            still.frame.stats.estimated_error.unwrap_or(-1.0),
            1.0 / (cpu * against * against).max(1e-12),
            1.0 / (cpu * own * own),
            still.frame.stats.truncated,
            still.non_finite
        );
    }
}
