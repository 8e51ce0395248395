//! Expected errors against found ones over blocks, drawn for the docs.

use std::fmt::Write as _;

use super::gains::{BASES, climb};

/// A line more of a text.
macro_rules! put {
    ($($part:tt)*) => { writeln!($($part)*).expect("a text takes every line") };
}

/// Samples a pixel.
const LADDER: [u32; 6] = [1, 4, 16, 64, 256, 1024];
const COLORS: [&str; 6] = [
    "#7b3294", "#c2385a", "#e08214", "#b8a500", "#35978f", "#2166ac",
];
/// Errors from which to which the axes go, and the side of a plot. Unit: pixel.
const LEAST: f64 = 1e-3;
const MOST: f64 = 3.0;
const SIDE: f64 = 320.0;

/// Where a value lies along an axis.
fn along(value: f64) -> f64 {
    let share = (value.clamp(LEAST, MOST) / LEAST).ln() / (MOST / LEAST).ln();
    share * SIDE
}

#[test]
#[ignore = "takes a quarter of an hour: run by hand to draw docs/calibration.svg again"]
fn expected_errors_are_drawn() {
    let mut plots = String::new();
    for (column, name) in ["light_shafts", "fog_box", "smoke_plume"]
        .iter()
        .enumerate()
    {
        let x0 = 50.0 + column as f64 * (SIDE + 50.0);
        put!(plots, "<g transform='translate({x0} 40)'>");
        put!(
            plots,
            "<rect width='{SIDE}' height='{SIDE}' fill='none' stroke='#888'/><text y='-10'>{name}</text>"
        );
        for factor in [1.0, 1.5, 1.0 / 1.5] {
            let (a, b) = (LEAST.max(LEAST / factor), MOST.min(MOST / factor));
            put!(
                plots,
                "<path d='M{:.1} {:.1}L{:.1} {:.1}' stroke='#aaa' stroke-dasharray='{}'/>",
                along(a),
                SIDE - along(a * factor),
                along(b),
                SIDE - along(b * factor),
                if factor == 1.0 { "none" } else { "4" }
            );
        }
        for tick in [1e-3, 1e-2, 1e-1, 1.0] {
            let at = along(tick);
            put!(
                plots,
                "<text x='{at:.1}' y='{:.1}' text-anchor='middle'>{tick}</text><text x='-6' y='{:.1}' text-anchor='end'>{tick}</text>",
                SIDE + 18.0,
                SIDE - at + 4.0
            );
        }
        for (label, settings) in BASES {
            let Some(rungs) = climb(name, label, settings, &LADDER) else {
                return;
            };
            for ((rung, samples), color) in rungs.iter().zip(LADDER).zip(COLORS) {
                let within = |factor: f64| {
                    let near = rung
                        .blocks
                        .iter()
                        .filter(|(told, found)| (told / found).ln().abs() <= factor.ln());
                    near.count() as f64 / rung.blocks.len().max(1) as f64
                };
                let least = rung.blocks.iter().map(|(told, found)| told / found);
                println!(
                    "{name} {label} n {samples}: {} blocks, within 1.5: {:.2}, within 2: {:.2}, most optimistic {:.2}",
                    rung.blocks.len(),
                    within(1.5),
                    within(2.0),
                    least.fold(f64::INFINITY, f64::min)
                );
                for (told, found) in &rung.blocks {
                    put!(
                        plots,
                        "<circle cx='{:.1}' cy='{:.1}' r='2.2' fill='{}' stroke='{color}'/>",
                        along(*found),
                        SIDE - along(*told),
                        if label == "black" { "none" } else { color }
                    );
                }
            }
        }
        plots.push_str("</g>\n");
    }
    let mut legend = String::new();
    for (i, (samples, color)) in LADDER.iter().zip(COLORS).enumerate() {
        let x = 60.0 + 90.0 * i as f64;
        put!(
            legend,
            "<circle cx='{x}' cy='415' r='4' fill='{color}'/><text x='{}' y='419'>n = {samples}</text>",
            x + 8.0
        );
    }
    let svg = format!(
        "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 1160 450' font-family='sans-serif' font-size='13'>\n\
         <rect width='1160' height='450' fill='white'/>\n{plots}{legend}\
         <text x='50' y='440'>across: error found, up: error expected, of blocks of 32×32 pixels; rings: from a black picture; dashes: a factor of 1.5</text>\n</svg>\n"
    );
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/calibration.svg");
    std::fs::write(file, svg).expect("the docs can be written");
}
