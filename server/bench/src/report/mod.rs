//! The report: one HTML file without anything from elsewhere.

mod escape;
mod plot;
mod strip;

use std::fmt::Write as _;

use crate::claim::Claim;
use crate::error::BenchError;
use crate::machine::Machine;
use crate::row::LadderRow;
use crate::suite::SceneResult;
use crate::table::efficiencies;
use escape::escape;

const STYLE: &str = include_str!("style.css");

/// The whole report as HTML.
///
/// # Errors
/// [`BenchError`] if a picture can't be encoded or compared.
pub fn html(machine: &Machine, scenes: &[SceneResult]) -> Result<String, BenchError> {
    let mut page = String::new();
    page += "<!doctype html>\n<html lang=\"en\">\n<meta charset=\"utf-8\">\n";
    page += "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n";
    page += "<title>tyndall bench</title>\n<style>\n";
    page += STYLE;
    page += "</style>\n<main>\n<h1>Run time against error</h1>\n";
    page += &format!(
        "<p class=\"facts\">{}, {}; {} CPU threads; tyndall {}, commit {}</p>\n",
        escape(&machine.device),
        escape(&machine.driver),
        machine.threads,
        machine.version,
        machine.commit
    );
    page += "<p>Error: relative RMSE without the worst 0.1&nbsp;% of pixels, the truth's own variance \
             taken off; of errors far below the truth's own little is known. FLIP sees the truth's noise, too. \
             Time: wall clock, pipelines and kernels built before. Rings mark what nothing else beats in \
             both. Down and left is better.</p>\n";
    for scene in scenes {
        self::scene(&mut page, scene)?;
    }
    page += "</main>\n</html>\n";
    Ok(page)
}

fn scene(page: &mut String, scene: &SceneResult) -> Result<(), BenchError> {
    *page += &format!("<section>\n<h2>{}</h2>\n", escape(&scene.name));
    if let Some(row) = scene.rows.first() {
        *page += &format!(
            "<p class=\"facts\">{}×{} pixels, seed {}, scene {}</p>\n",
            row.width, row.height, row.seed, row.scene_hash
        );
    }
    for (claim, _, origin) in &scene.truths {
        *page += &format!(
            "<p class=\"facts\">truth ({}): {}</p>\n",
            claim.label(),
            escape(origin)
        );
    }
    for remark in &scene.remarks {
        *page += &format!("<p class=\"remark\">{}</p>\n", escape(remark));
    }
    *page += "<div class=\"plots\">\n";
    // A peer that was told to leave paths out is no rival here.
    let restricted =
        |row: &LadderRow| row.claim == Claim::OneScattering && row.technique.starts_with("mitsuba");
    let whole = |row: &LadderRow| {
        let error = row.whole.as_ref()?.error();
        (!restricted(row)).then_some((error, row.pareto_whole))
    };
    *page += &plot::plot("Against the whole", &scene.rows, &whole);
    let single = |row: &LadderRow| {
        let error = row.claimed.as_ref()?.error();
        (row.claim == Claim::OneScattering).then_some((error, row.pareto_claimed))
    };
    *page += &plot::plot("Against at most one scattering", &scene.rows, &single);
    *page += "</div>\n";
    *page += &strip::strip(scene)?;
    *page += &efficiency_table(scene);
    *page += &rows_table(scene);
    *page += "</section>\n";
    Ok(())
}

fn efficiency_table(scene: &SceneResult) -> String {
    let found = efficiencies(&scene.rows);
    if found.is_empty() {
        return String::new();
    }
    let mut text = String::from(
        "<div class=\"wide\"><table><tr><th>technique<th>claims<th>efficiency, s⁻¹<th>of Mitsuba's</tr>\n",
    );
    for row in found {
        let ratio = row
            .of_peer
            .map_or("–".to_owned(), |ratio| format!("{ratio:.2}×"));
        text += &format!(
            "<tr><td>{}<td>{}<td>{:.3}<td>{ratio}</tr>\n",
            escape(&row.technique),
            row.claim.label(),
            row.efficiency
        );
    }
    text + "</table></div>\n"
}

fn rows_table(scene: &SceneResult) -> String {
    let mut text = String::from(
        "<details><summary>All rows</summary><div class=\"wide\"><table><tr><th>technique<th>setting\
         <th>seconds<th>CPU s<th>frame ms<th>p95<th>device ms<th>error (claim)<th>error (whole)<th>energy\
         <th>block z<th>LDR-FLIP<th>HDR-FLIP<th>not finite<th>MiB</tr>\n",
    );
    for row in &scene.rows {
        let number = |value: Option<f64>, digits: usize| {
            value.map_or("–".to_owned(), |value| format!("{value:.digits$}"))
        };
        let claimed = row.claimed.as_ref();
        let passes: f64 = row.pass_millis.iter().map(|(_, pass)| pass.median).sum();
        let passes = (!row.pass_millis.is_empty()).then_some(passes);
        let title: Vec<String> = row
            .pass_millis
            .iter()
            .map(|(name, pass)| format!("{name} {:.3} ms", pass.median))
            .collect();
        let mut line = format!(
            "<tr><td>{}<td>{}<td>{:.3}<td>{}<td>{}<td>{}<td title=\"{}\">{}",
            escape(&row.technique),
            row.setting(),
            row.seconds,
            number(row.cpu_seconds, 2),
            number(row.frame_millis.map(|frame| frame.median), 2),
            number(row.frame_millis.map(|frame| frame.p95), 2),
            escape(&title.join(", ")),
            number(passes, 2),
        );
        // Writing to a string can't fail.
        writeln!(
            line,
            "<td>{}<td>{}<td>{}<td>{}<td>{}<td>{}<td>{}<td>{}</tr>",
            number(claimed.map(crate::measures::Measures::error), 4),
            number(row.whole.as_ref().map(crate::measures::Measures::error), 4),
            number(claimed.map(|m| m.radiance.mean_ratio), 4),
            number(
                claimed
                    .and_then(|m| m.radiance.block_z)
                    .map(|z| z.deviation),
                2
            ),
            number(claimed.map(|m| m.ldr_flip), 4),
            number(claimed.map(|m| m.radiance.hdr_flip), 4),
            row.non_finite,
            number(
                row.resident_bytes.map(|bytes| bytes as f64 / 1_048_576.0),
                0
            ),
        )
        .unwrap_or_default();
        text += &line;
    }
    text + "</table></div></details>\n"
}
