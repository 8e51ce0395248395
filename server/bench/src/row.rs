//! One setting's figures: seconds and error in one row.

use serde::Serialize;

use crate::claim::Claim;
use crate::error::BenchError;
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
    /// Errors against the truth of all paths.
    pub whole: Option<Measures>,
    /// Errors against the truth of the paths that the technique claims.
    pub claimed: Option<Measures>,
    /// Relative error of the truth itself, estimated from its variance without the worst 0.1 % of pixels:
    /// smaller errors of the row can't be told from it.
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
    /// Adapter, or the CPU that the peer ran on.
    pub device: String,
    /// Version of the driver, or of the peer.
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
///
/// # Errors
/// [`BenchError::Csv`] if a line has more or fewer fields than there are columns.
pub fn csv(rows: &[LadderRow]) -> Result<String, BenchError> {
    let mut lines = csv::Writer::from_writer(Vec::new());
    lines.write_record(columns())?;
    for row in rows {
        lines.write_record(fields(row))?;
    }
    let bytes = lines
        .into_inner()
        .map_err(|error| csv::Error::from(error.into_error()))?;
    Ok(String::from_utf8_lossy(&bytes).into_owned())
}

/// Names of the columns, in the order of [`fields`].
fn columns() -> Vec<String> {
    let of = |truth: &str| NAMES.map(|name| format!("{truth}_{name}"));
    let mut columns = [
        "scene",
        "scene_hash",
        "technique",
        "steps",
        "samples",
        "cut_short",
        "width",
        "height",
        "seed",
        "claim",
        "seconds",
        "cpu_seconds",
        "frame_millis_median",
        "frame_millis_p95",
        "pass_millis_median_sum",
    ]
    .map(str::to_owned)
    .to_vec();
    columns.extend(of("whole"));
    columns.extend(of("claimed"));
    columns.extend(
        [
            "truth_error",
            "efficiency",
            "non_finite",
            "resident_bytes",
            "device_bytes",
            "pareto_whole",
            "pareto_claimed",
            "device",
            "driver",
            "commit",
        ]
        .map(str::to_owned),
    );
    columns
}

/// A row's values; what is not known is empty.
fn fields(row: &LadderRow) -> Vec<String> {
    // The sum of nothing is −0, which becomes 0.
    let passes = row
        .pass_millis
        .iter()
        .map(|(_, pass)| pass.median)
        .sum::<f64>()
        + 0.0;
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
        passes.to_string(),
    ];
    for measures in [&row.whole, &row.claimed] {
        match measures {
            Some(measures) => fields.extend(values(measures).map(optional)),
            None => fields.extend(NAMES.map(|_| String::new())),
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
    fields
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
    fn csv_has_a_value_in_every_column_that_is_known_and_quotes_where_it_must() {
        let text = csv(&[row("a", 1.5, 0.5)]).unwrap();
        assert!(text.starts_with("scene,scene_hash,technique,steps,samples,cut_short,width,"));
        assert!(
            text.contains("\ns,0,a,8,1,false,8,8,0,whole,1.5,,,,0,0.5,"),
            "{text}"
        );
        assert!(
            text.ends_with(",false,false,\"d, \"\"e\"\"\",,\n"),
            "{text}"
        );
        let mut table = csv::Reader::from_reader(text.as_bytes());
        let columns = table.headers().unwrap().clone();
        let lines: Vec<_> = table.records().map(Result::unwrap).collect();
        assert_eq!(lines.len(), 1);
        let value = |name: &str| &lines[0][columns.iter().position(|c| c == name).unwrap()];
        for (name, expected) in [
            ("whole_relative_rmse", "0.5"),
            ("claimed_relative_rmse", "0.5"),
            ("claimed_relative_rmse_debiased", ""),
            ("claimed_mean_ratio", "1.5"),
            ("truth_error", "0.001"),
            ("pareto_claimed", "false"),
            ("device", "d, \"e\""),
        ] {
            assert_eq!(value(name), expected, "{name}");
        }
    }
}
