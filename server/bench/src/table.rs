//! Results as text: one line a row, and how efficient each technique is.

use std::fmt::Write as _;

use crate::claim::Claim;
use crate::measures::Measures;
use crate::row::LadderRow;
use crate::suite::SceneResult;

/// How efficient a technique is in one scene.
#[derive(Debug, Clone, PartialEq)]
pub struct Efficiency {
    /// Technique or peer.
    pub technique: String,
    /// Which paths it claims, and is judged by.
    pub claim: Claim,
    /// 1/(seconds × relative variance) of its last rung. Unit: s⁻¹.
    pub efficiency: f64,
    /// Its efficiency divided by Mitsuba's for the same paths; `None` if Mitsuba did not run.
    pub of_peer: Option<f64>,
}

/// Efficiencies of each technique at its last setting. A biased technique's says something about that
/// setting only: once most of its error is bias, more samples take time and no longer reduce the error.
pub fn efficiencies(rows: &[LadderRow]) -> Vec<Efficiency> {
    let mut found: Vec<Efficiency> = Vec::new();
    for row in rows {
        let Some(efficiency) = row.efficiency() else {
            continue;
        };
        found.retain(|known| known.technique != row.technique);
        found.push(Efficiency {
            technique: row.technique.clone(),
            claim: row.claim,
            efficiency,
            of_peer: None,
        });
    }
    let peers: Vec<(Claim, f64)> = found
        .iter()
        .filter(|row| row.technique.starts_with("mitsuba") && !row.technique.contains("oidn"))
        .map(|row| (row.claim, row.efficiency))
        .collect();
    for row in &mut found {
        let peer = peers.iter().find(|(claim, _)| *claim == row.claim);
        row.of_peer = peer.map(|(_, efficiency)| row.efficiency / efficiency);
    }
    found
}

/// A scene's rows as text.
pub fn table(scene: &SceneResult) -> String {
    let mut text = format!("{}\n", scene.name);
    for (claim, _, origin) in &scene.truths {
        text += &format!("  truth ({}): {origin}\n", claim.label());
    }
    for remark in &scene.remarks {
        text += &format!("  note: {remark}\n");
    }
    text += &format!(
        "  {:<30} {:<22} {:>9} {:>9} {:>9} {:>9} {:>9} {:>9} {:>7} {:>8} {:>8}  {}\n",
        "technique",
        "setting",
        "seconds",
        "frame ms",
        "p95 ms",
        "err claim",
        "err whole",
        "energy",
        "z dev",
        "LDR-FLIP",
        "HDR-FLIP",
        "front"
    );
    for row in &scene.rows {
        text += &line(row);
    }
    let found = efficiencies(&scene.rows);
    if !found.is_empty() {
        text += "  efficiency = 1/(seconds × relative variance), last rung:\n";
    }
    for row in found {
        let ratio = row
            .of_peer
            .map_or(String::new(), |ratio| format!("  {ratio:.2} × Mitsuba"));
        text += &format!(
            "    {:<30} {:>12.3} /s  ({}){ratio}\n",
            row.technique,
            row.efficiency,
            row.claim.label()
        );
    }
    text
}

fn line(row: &LadderRow) -> String {
    let number = |value: Option<f64>, digits: usize| {
        value.map_or("–".to_owned(), |value| format!("{value:.digits$}"))
    };
    let claimed = row.claimed.as_ref();
    let mut line = format!(
        "  {:<30} {:<22} {:>9.3} {:>9} {:>9}",
        row.technique,
        row.setting(),
        row.seconds,
        number(row.frame_millis.map(|frame| frame.median), 2),
        number(row.frame_millis.map(|frame| frame.p95), 2),
    );
    // Writing to a string can't fail.
    writeln!(
        line,
        " {:>9} {:>9} {:>9} {:>7} {:>8} {:>8}  {}{}{}",
        number(claimed.map(Measures::error), 4),
        number(row.whole.as_ref().map(Measures::error), 4),
        number(claimed.map(|m| m.radiance.mean_ratio), 4),
        number(
            claimed
                .and_then(|m| m.radiance.block_z)
                .map(|z| z.deviation),
            2
        ),
        number(claimed.map(|m| m.ldr_flip), 4),
        number(claimed.map(|m| m.radiance.hdr_flip), 4),
        if row.pareto_claimed { "claim " } else { "" },
        if row.pareto_whole { "whole" } else { "" },
        if row.non_finite > 0 {
            format!(" {} NOT FINITE", row.non_finite)
        } else {
            String::new()
        },
    )
    .unwrap_or_default();
    line
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::row::tests::row;

    #[test]
    fn efficiency_is_compared_with_mitsuba_of_the_same_claim() {
        let rows = [
            row("reference", 9.0, 0.9),
            row("reference", 1.0, 0.1),
            row("mitsuba_volpath", 2.0, 0.1),
        ];
        let found = efficiencies(&rows);
        assert_eq!(found.len(), 2);
        let ratio = found[0].of_peer.unwrap();
        assert!((ratio - 2.0).abs() < 1e-6, "{ratio}");
    }
}
