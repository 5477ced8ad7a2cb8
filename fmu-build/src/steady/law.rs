//! `cargo fmu steady --law`: when heat leaves the steady pressures alone.

use crate::plot::{Axis, Figure, Legend, Mark, Panel, Series};
use anyhow::{Context, Result};
use indicatif::{ProgressBar, ProgressStyle};
use serde_json::{Value, json};
use sliding_contact::elastic::scene::{cells_for, compliances};
use sliding_contact::scene::Scene;
use sliding_contact::steady::thermal::law::{LawPoint, endless_cycles, law};
use std::fmt::Write as _;
use std::fs;
use std::path::Path;

/// log10 of the shortest and the longest cycle over the thermal time, and points in a decade.
const DECADES: [i32; 2] = [-3, 2];
const PER_DECADE: i32 = 3;

/// The law of a scene.
pub struct Law {
    name: String,
    points: Vec<LawPoint>,
    endless: f64,
}

impl Law {
    /// Computes it, with a progress bar.
    pub fn new(name: &str, scene: &Scene, count: usize) -> Result<Law> {
        let cells = cells_for(scene, count)?;
        let bodies = compliances(scene, &cells)?;
        let endless = endless_cycles(scene, &cells, &bodies).with_context(|| format!("the scene {name}"))?;
        let exponents: Vec<i32> = (DECADES[0] * PER_DECADE..=DECADES[1] * PER_DECADE).collect();
        let style = ProgressStyle::with_template("{bar:30} {pos}/{len} cycle lengths")?;
        let bar = ProgressBar::new(exponents.len() as u64).with_style(style);
        let mut points = Vec::new();
        for exponent in exponents {
            let ratio = 10f64.powf(f64::from(exponent) / f64::from(PER_DECADE));
            let point = law(scene, &cells, &bodies, ratio);
            points.push(point.with_context(|| format!("{name}, cycle time {ratio:.3e} of the thermal time"))?);
            bar.inc(1);
        }
        bar.finish_and_clear();
        Ok(Law { name: name.to_owned(), points, endless })
    }

    /// As JSON.
    pub fn record(&self) -> Value {
        let point = |point: &LawPoint| {
            json!({
                "cycle_time_over_thermal_time": point.ratio,
                "difference_of_means": point.means,
                "difference_at_ends": point.ends,
                "swing_of_mean_temperature": point.swing,
                "swing_of_local_temperature": point.local_swing,
            })
        };
        json!({
            "scene": self.name,
            "points": self.points.iter().map(point).collect::<Vec<_>>(),
            "difference_for_endless_cycles": self.endless,
        })
    }

    /// As a table.
    pub fn table(&self) -> String {
        let mut text = format!(
            "{}: pressures with heat less those without, over the mean pressure\n{:>12}  {:>12}  {:>12}  {:>12}\n",
            self.name, "cycle/thermal", "means", "at ends", "swing of T"
        );
        for point in &self.points {
            let LawPoint { ratio, means, ends, local_swing, .. } = point;
            let _ = writeln!(text, "{ratio:>12.3e}  {means:>12.3e}  {ends:>12.3e}  {local_swing:>12.3e}");
        }
        let _ = writeln!(text, "endless cycles, from the steady distortion: {:.3e}", self.endless);
        text
    }

    fn csv(&self) -> String {
        let mut text = "cycle_time_over_thermal_time,difference_of_means,difference_at_ends,\
                        swing_of_mean_temperature,swing_of_local_temperature\n"
            .to_owned();
        for point in &self.points {
            let LawPoint { ratio, means, ends, swing, local_swing } = point;
            let _ = writeln!(text, "{ratio:.6e},{means:.6e},{ends:.6e},{swing:.6e},{local_swing:.6e}");
        }
        let _ = writeln!(text, "inf,{:.6e},,,", self.endless);
        text
    }

    fn figure(&self) -> Figure {
        let series = |value: &dyn Fn(&LawPoint) -> f64| -> Vec<(f64, f64)> {
            self.points.iter().map(|point| (point.ratio, value(point))).collect()
        };
        let (first, last) = (self.points[0], self.points[self.points.len() - 1]);
        let slope = |value: f64, exponent: f64| -> Vec<(f64, f64)> {
            let reach = 1.0 / first.ratio;
            vec![(first.ratio, value), (1.0, value * reach.powf(exponent))]
        };
        let ratio = || Axis::logarithmic("cycle time / thermal time of the contact, 1");
        let pressures = vec![
            Series::line("means of the half-strokes", series(&|p| p.means)).with(Mark::LineAndPoints).coloured(0),
            Series::line("at the ends of the half-strokes", series(&|p| p.ends)).with(Mark::LineAndPoints).coloured(1),
            Series::line("slope 3/2", slope(first.means, 1.5)).with(Mark::Dashes).coloured(0),
            Series::line("endless cycles", vec![(0.1, self.endless), (last.ratio, self.endless)])
                .with(Mark::Dashes)
                .coloured(6),
        ];
        let swings = vec![
            Series::line("surfaces", series(&|p| p.local_swing)).with(Mark::LineAndPoints).coloured(0),
            Series::line("mean of the contact", series(&|p| p.swing)).with(Mark::LineAndPoints).coloured(1),
            Series::line("slope 1/2", slope(first.local_swing, 0.5)).with(Mark::Dashes).coloured(0),
        ];
        let panels = vec![
            Panel::new(
                "Steady pressures with heat less those without",
                ratio(),
                Axis::logarithmic("rms difference / mean pressure, 1"),
                pressures,
            )
            .with_legend(Legend::LowerRight),
            Panel::new("Temperature", ratio(), Axis::logarithmic("range in a cycle / mean rise, 1"), swings)
                .with_legend(Legend::LowerRight),
        ];
        Figure::new(format!("What heat changes in the steady cycle of {}", self.name), panels).with_header(vec![
            "the heat capacities of both bodies vary; load, friction heat, stroke and steady distortion stay".into(),
        ])
    }

    /// Writes the figure, and the numbers beside it.
    pub fn write(&self, path: &Path) -> Result<()> {
        self.figure().write(path)?;
        let csv = path.with_extension("csv");
        fs::write(&csv, self.csv()).with_context(|| format!("writing {}", csv.display()))
    }
}
