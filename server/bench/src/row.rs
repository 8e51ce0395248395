//! One setting's figures: seconds and error in one row.

use serde::Serialize;

use crate::ladder::Claim;
use crate::measures::Measures;
use crate::statistics::Summary;

/// One setting's figures.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LadderRow {
    /// Preset or file.
    pub scene: String,
    /// Hash of its description.
    pub scene_hash: String,
    /// JSON name of the technique, or the peer's.
    pub technique: String,
    /// March steps a ray, if it marches.
    pub steps: Option<u32>,
    /// Samples a pixel that were taken.
    pub samples: u32,
    /// The time was up before all samples were taken.
    pub cut_short: bool,
    /// Unit: pixel.
    pub width: u32,
    /// Unit: pixel.
    pub height: u32,
    /// Seed of every random number.
    pub seed: u64,
    /// Which paths the picture claims to show.
    pub claim: Claim,
    /// Wall time of all samples. Unit: s.
    pub seconds: f64,
    /// CPU time of all threads over the same work. Unit: s.
    pub cpu_seconds: Option<f64>,
    /// Wall time of a frame. Unit: ms.
    pub frame_millis: Option<Summary>,
    /// Device time of each pass. Unit: ms.
    pub pass_millis: Vec<(String, Summary)>,
    /// Against all paths.
    pub whole: Option<Measures>,
    /// Against the paths that the technique claims.
    pub claimed: Option<Measures>,
    /// The truth's own relative error, trimmed: no error below it is known.
    pub truth_error: Option<f64>,
    /// Samples that were not finite.
    pub non_finite: u64,
    /// Resident memory of the process afterwards. Unit: byte.
    pub resident_bytes: Option<u64>,
    /// Memory allocated on the device, as its allocator reports it. Unit: byte.
    pub device_bytes: Option<u64>,
    /// No other row of the scene is both faster and closer to the whole.
    pub pareto_whole: bool,
    /// No other row of the same claim is both faster and closer to it.
    pub pareto_claimed: bool,
    /// What produced it.
    pub device: String,
    /// Version of that.
    pub driver: String,
    /// Commit of this program.
    pub commit: String,
}

impl LadderRow {
    /// The setting in short.
    pub fn setting(&self) -> String {
        let cut = if self.cut_short { ", cut" } else { "" };
        match self.steps {
            Some(steps) => format!("{steps} steps, {} spp{cut}", self.samples),
            None => format!("{} spp{cut}", self.samples),
        }
    }

    /// 1/(seconds × relative variance), against what the row claims: twice as efficient is the same
    /// error in half the time. Unit: s⁻¹.
    pub fn efficiency(&self) -> Option<f64> {
        let error = self.claimed.as_ref()?.error();
        (error > 0.0 && self.seconds > 0.0).then(|| 1.0 / (self.seconds * error * error))
    }
}

/// Marks the rows that no other row of their scene beats in both time and error.
pub(crate) fn mark_pareto(rows: &mut [LadderRow]) {
    let points: Vec<_> = rows
        .iter()
        .map(|row| {
            let error = |measures: &Option<Measures>| measures.as_ref().map(Measures::error);
            (
                row.scene.clone(),
                row.claim,
                row.seconds,
                error(&row.whole),
                error(&row.claimed),
            )
        })
        .collect();
    for (i, row) in rows.iter_mut().enumerate() {
        let (scene, claim, seconds, whole, claimed) = &points[i];
        let beaten = |error: f64, other: Option<f64>, at: f64| {
            other.is_some_and(|other| {
                at <= *seconds && other <= error && (at < *seconds || other < error)
            })
        };
        let rivals = || points.iter().filter(|point| point.0 == *scene);
        row.pareto_whole = whole.is_some_and(|error| !rivals().any(|p| beaten(error, p.3, p.2)));
        row.pareto_claimed = claimed
            .is_some_and(|error| !rivals().any(|p| p.1 == *claim && beaten(error, p.4, p.2)));
    }
}

/// Rows as CSV, one line each, numbers in full.
pub fn csv(rows: &[LadderRow]) -> String {
    let mut text = String::from(
        "scene,scene_hash,technique,steps,samples,cut_short,width,height,seed,claim,seconds,cpu_seconds,\
         frame_millis_median,frame_millis_p95,pass_millis_median_sum",
    );
    for truth in ["whole", "claimed"] {
        for name in NAMES {
            text += &format!(",{truth}_{name}");
        }
    }
    text += ",truth_error,efficiency,non_finite,resident_bytes,device_bytes,pareto_whole,\
             pareto_claimed,device,driver,commit\n";
    for row in rows {
        let mut fields = vec![
            row.scene.clone(),
            row.scene_hash.clone(),
            row.technique.clone(),
            optional(row.steps),
            row.samples.to_string(),
            row.cut_short.to_string(),
            row.width.to_string(),
            row.height.to_string(),
            row.seed.to_string(),
            row.claim.label().to_owned(),
            row.seconds.to_string(),
            optional(row.cpu_seconds),
            optional(row.frame_millis.map(|frame| frame.median)),
            optional(row.frame_millis.map(|frame| frame.p95)),
            row.pass_millis
                .iter()
                .map(|(_, pass)| pass.median)
                .sum::<f64>()
                .to_string(),
        ];
        for measures in [&row.whole, &row.claimed] {
            match measures {
                Some(measures) => fields.extend(values(measures).map(optional)),
                None => fields.extend(NAMES.iter().map(|_| String::new())),
            }
        }
        fields.extend([
            optional(row.truth_error),
            optional(row.efficiency()),
            row.non_finite.to_string(),
            optional(row.resident_bytes),
            optional(row.device_bytes),
            row.pareto_whole.to_string(),
            row.pareto_claimed.to_string(),
            row.device.clone(),
            row.driver.clone(),
            row.commit.clone(),
        ]);
        let quoted: Vec<String> = fields.iter().map(|field| quote(field)).collect();
        text += &quoted.join(",");
        text.push('\n');
    }
    text
}

/// Measures in the order of [`values`].
const NAMES: [&str; 13] = [
    "relative_rmse",
    "relative_rmse_debiased",
    "relative_rmse_trim",
    "relative_rmse_trim_debiased",
    "relative_mse",
    "relative_mse_trim",
    "mean_ratio",
    "block_z_mean",
    "block_z_deviation",
    "block_z_max",
    "block_z_outside_3",
    "ldr_flip",
    "hdr_flip",
];

fn values(measures: &Measures) -> [Option<f64>; 13] {
    let m = &measures.radiance;
    [
        Some(m.relative_rmse),
        m.relative_rmse_debiased,
        Some(m.relative_rmse_trim),
        m.relative_rmse_trim_debiased,
        Some(m.relative_mse),
        Some(m.relative_mse_trim),
        Some(m.mean_ratio),
        m.block_z.map(|z| z.mean),
        m.block_z.map(|z| z.deviation),
        m.block_z.map(|z| z.max),
        m.block_z.map(|z| z.outside_3 as f64),
        Some(measures.ldr_flip),
        Some(m.hdr_flip),
    ]
}

fn optional(value: Option<impl std::fmt::Display>) -> String {
    value.map(|value| value.to_string()).unwrap_or_default()
}

fn quote(field: &str) -> String {
    if field.contains([',', '"', '\n']) {
        format!("\"{}\"", field.replace('"', "\"\""))
    } else {
        field.to_owned()
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use tyndall_quality::Image;

    pub(crate) fn row(technique: &str, seconds: f64, error: f32) -> LadderRow {
        let image = |value: f32| Image::new(8, 8, vec![[value; 3]; 64]).unwrap();
        let measures = Measures::of(&image(1.0 + error), &image(1.0), 0.0).unwrap();
        LadderRow {
            scene: "s".into(),
            scene_hash: "0".into(),
            technique: technique.into(),
            steps: Some(8),
            samples: 1,
            cut_short: false,
            width: 8,
            height: 8,
            seed: 0,
            claim: Claim::Whole,
            seconds,
            cpu_seconds: None,
            frame_millis: None,
            pass_millis: Vec::new(),
            whole: Some(measures.clone()),
            claimed: Some(measures),
            truth_error: Some(0.001),
            non_finite: 0,
            resident_bytes: None,
            device_bytes: None,
            pareto_whole: false,
            pareto_claimed: false,
            device: "d, \"e\"".into(),
            driver: String::new(),
            commit: String::new(),
        }
    }

    #[test]
    fn the_front_holds_what_nothing_beats_in_both() {
        let mut rows = vec![
            row("a", 1.0, 0.5),
            row("b", 2.0, 0.25),
            row("c", 3.0, 0.5),
            row("d", 2.0, 0.5),
        ];
        mark_pareto(&mut rows);
        let front: Vec<bool> = rows.iter().map(|row| row.pareto_whole).collect();
        assert_eq!(front, [true, true, false, false]);
    }

    #[test]
    fn efficiency_is_one_over_time_times_square_error() {
        let efficiency = row("a", 2.0, 0.5).efficiency().unwrap();
        assert!((efficiency - 2.0).abs() < 1e-6, "{efficiency}");
    }

    #[test]
    fn every_csv_line_has_every_column() {
        let text = csv(&[row("a", 1.0, 0.5)]);
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines.len(), 2);
        assert!(lines[1].contains("\"d, \"\"e\"\"\""), "{}", lines[1]);
        // The quoted field holds one comma.
        let columns = |line: &str| line.matches(',').count();
        assert_eq!(columns(lines[0]) + 1, columns(lines[1]));
    }
}
