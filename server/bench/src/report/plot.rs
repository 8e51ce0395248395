//! Run time against error, both logarithmic, as inline SVG.

use super::escape::escape;
use crate::row::LadderRow;

const WIDTH: f64 = 560.0;
const HEIGHT: f64 = 380.0;
/// Left, right, top and bottom margins.
const MARGINS: [f64; 4] = [62.0, 16.0, 14.0, 46.0];
/// Told apart by people with any colour vision (Okabe and Ito 2008).
const COLORS: [&str; 7] = [
    "#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#7f7f7f",
];

/// A plot of all rows for which `value` knows an error and whether it lies on the front; empty
/// without any.
pub(super) fn plot(
    title: &str,
    rows: &[LadderRow],
    value: &dyn Fn(&LadderRow) -> Option<(f64, bool)>,
) -> String {
    let points: Vec<Point<'_>> = rows
        .iter()
        .filter_map(|row| {
            let (error, front) = value(row)?;
            (error > 0.0 && row.seconds > 0.0).then_some(Point { row, error, front })
        })
        .collect();
    if points.is_empty() {
        return String::new();
    }
    let mut techniques: Vec<&str> = Vec::new();
    for point in &points {
        if !techniques.contains(&point.row.technique.as_str()) {
            techniques.push(&point.row.technique);
        }
    }
    let color = |technique: &str| {
        let index = techniques.iter().position(|name| *name == technique);
        COLORS[index.unwrap_or_default() % COLORS.len()]
    };
    let [left, right, top, bottom] = MARGINS;
    let x = Axis::of(points.iter().map(|p| p.row.seconds), left, WIDTH - right);
    let y = Axis::of(points.iter().map(|p| p.error), HEIGHT - bottom, top);
    let mut svg = format!(
        "<div class=\"plot\"><h3>{}</h3><svg viewBox=\"0 0 {WIDTH} {HEIGHT}\" role=\"img\" aria-label=\"{}\">\n",
        escape(title),
        escape(title)
    );
    for (at, label) in x.ticks() {
        svg += &format!(
            "<path d=\"M{at:.1} {top}V{:.1}\" stroke=\"var(--line)\"/><text x=\"{at:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{label}</text>\n",
            HEIGHT - bottom,
            HEIGHT - bottom + 17.0
        );
    }
    for (at, label) in y.ticks() {
        svg += &format!(
            "<path d=\"M{left} {at:.1}H{:.1}\" stroke=\"var(--line)\"/><text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\">{label}</text>\n",
            WIDTH - right,
            left - 6.0,
            at + 4.0
        );
    }
    svg += &format!(
        "<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\">seconds</text><text x=\"4\" y=\"12\">error</text>\n",
        WIDTH - right,
        HEIGHT - 6.0
    );
    svg += &lines(&points, &x, &y, &color);
    for point in &points {
        let (px, py) = (x.place(point.row.seconds), y.place(point.error));
        let color = color(&point.row.technique);
        svg += &format!(
            "<g><title>{}, {}: error {:.4} in {:.3} s</title><circle cx=\"{px:.1}\" cy=\"{py:.1}\" r=\"4\" fill=\"{color}\"/>",
            escape(&point.row.technique),
            point.row.setting(),
            point.error,
            point.row.seconds
        );
        if point.front {
            svg += &format!(
                "<circle cx=\"{px:.1}\" cy=\"{py:.1}\" r=\"8\" fill=\"none\" stroke=\"currentColor\" stroke-width=\"1.5\"/>"
            );
        }
        svg += "</g>\n";
    }
    svg += "</svg><ul class=\"legend\">";
    for technique in &techniques {
        svg += &format!(
            "<li><i style=\"background:{}\"></i>{}</li>",
            color(technique),
            escape(technique)
        );
    }
    svg + "<li>◯ Pareto front</li></ul></div>\n"
}

struct Point<'a> {
    row: &'a LadderRow,
    error: f64,
    front: bool,
}

/// Lines between rows that differ in samples only.
fn lines(points: &[Point<'_>], x: &Axis, y: &Axis, color: &dyn Fn(&str) -> &'static str) -> String {
    let mut text = String::new();
    for (i, a) in points.iter().enumerate() {
        // A peer's rows alternate with its denoised ones.
        let same =
            |b: &&Point<'_>| b.row.technique == a.row.technique && b.row.steps == a.row.steps;
        if let Some(b) = points[i + 1..].iter().find(same) {
            text += &format!(
                "<path d=\"M{:.1} {:.1}L{:.1} {:.1}\" stroke=\"{}\" stroke-opacity=\".45\" stroke-width=\"1.5\"/>\n",
                x.place(a.row.seconds),
                y.place(a.error),
                x.place(b.row.seconds),
                y.place(b.error),
                color(&a.row.technique)
            );
        }
    }
    text
}

/// A logarithmic axis.
struct Axis {
    /// Decimal logarithms of the ends.
    range: (f64, f64),
    from: f64,
    to: f64,
}

impl Axis {
    fn of(values: impl Iterator<Item = f64>, from: f64, to: f64) -> Self {
        let (low, high) = values.fold((f64::MAX, f64::MIN), |(low, high), value| {
            (low.min(value.log10()), high.max(value.log10()))
        });
        let pad = 0.06 * (high - low).max(0.5);
        Self {
            range: (low - pad, high + pad),
            from,
            to,
        }
    }

    fn place(&self, value: f64) -> f64 {
        let share = (value.log10() - self.range.0) / (self.range.1 - self.range.0);
        self.from + share * (self.to - self.from)
    }

    /// Decades, and 2 and 5 between them where there is room.
    fn ticks(&self) -> Vec<(f64, String)> {
        let decades = self.range.1 - self.range.0;
        let factors: &[f64] = if decades < 2.2 {
            &[1.0, 2.0, 5.0]
        } else {
            &[1.0]
        };
        let first = self.range.0.floor() as i32;
        let last = self.range.1.ceil() as i32;
        let mut ticks = Vec::new();
        for decade in first..=last {
            for factor in factors {
                let value = factor * 10.0_f64.powi(decade);
                if (self.range.0..=self.range.1).contains(&value.log10()) {
                    let digits = usize::try_from(-decade).unwrap_or(0);
                    ticks.push((self.place(value), format!("{value:.digits$}")));
                }
            }
        }
        ticks
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::row::tests::row;

    #[test]
    fn a_plot_holds_every_point_and_marks_the_front() {
        let rows = [row("a", 0.01, 0.5), row("b", 10.0, 0.001)];
        let svg = plot("t", &rows, &|row| Some((row.whole.as_ref()?.error(), true)));
        assert_eq!(svg.matches("r=\"4\"").count(), 2);
        assert_eq!(svg.matches("r=\"8\"").count(), 2);
        assert!(!svg.contains("NaN") && !svg.contains("inf"), "{svg}");
        assert!(plot("t", &rows, &|_| None).is_empty());
    }
}
