//! `cargo fmu steady --law`: influence of heat on the steady pressures against cycle length.

use crate::output;
use crate::plot::{Axis, Figure, Mark, Panel, Series};
use anyhow::{Context, Result};
use elasticity::discretization::{cells_for, compliances};
use fmu_build::progress::bar;
use scene::Scene;
use serde_json::{Value, json};
use std::fmt::Write as _;
use std::fs;
use std::path::Path;
use steady::thermal::law::{Differences, LawPoint, endless_cycles, law};

/// log10 of the shortest and the longest cycle over the thermal time, and points in a decade.
const DECADES: [i32; 2] = [-3, 2];
const PER_DECADE: i32 = 3;

pub(crate) struct Law {
    name: String,
    points: Vec<LawPoint>,
    endless: Differences,
}

impl Law {
    /// Computes it, with a progress bar.
    pub(crate) fn new(name: &str, scene: &Scene, count: usize) -> Result<Law> {
        let cells = cells_for(scene, count)?;
        let bodies = compliances(scene, &cells)?;
        let endless = endless_cycles(scene, &cells, &bodies).with_context(|| format!("the scene {name}"))?;
        let exponents: Vec<i32> = (DECADES[0] * PER_DECADE..=DECADES[1] * PER_DECADE).collect();
        let bar = bar(exponents.len(), "{pos}/{len} cycle lengths");
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

    pub(crate) fn record(&self) -> Value {
        let point = |point: &LawPoint| {
            json!({
                "cycle_time_over_thermal_time": point.ratio,
                "difference_of_means_inside": point.inside,
                "difference_of_means": point.everywhere,
                "difference_at_ends_inside": point.ends,
                "swing_of_temperature": point.swing,
            })
        };
        json!({
            "scene": self.name,
            "points": self.points.iter().map(point).collect::<Vec<_>>(),
            "endless_cycles": {
                "difference_of_means_inside": self.endless.inside,
                "difference_of_means": self.endless.everywhere,
            },
        })
    }

    pub(crate) fn table(&self) -> String {
        let mut text = format!(
            "{}: pressures with heat less those without, rms over the mean pressure\n{:>13}  {:>13}  {:>13}  {:>13}  {:>13}\n",
            self.name, "cycle/thermal", "means, inside", "means, all", "ends, inside", "swing of T"
        );
        for LawPoint { ratio, inside, everywhere, ends, swing } in &self.points {
            let _ =
                writeln!(text, "{ratio:>13.3e}  {inside:>13.3e}  {everywhere:>13.3e}  {ends:>13.3e}  {swing:>13.3e}");
        }
        let Differences { inside, everywhere } = self.endless;
        let _ = writeln!(text, "{:>13}  {inside:>13.3e}  {everywhere:>13.3e}", "endless");
        text
    }

    fn csv(&self) -> String {
        let mut text = "cycle_time_over_thermal_time,difference_of_means_inside,difference_of_means,\
                        difference_at_ends_inside,swing_of_temperature\n"
            .to_owned();
        for LawPoint { ratio, inside, everywhere, ends, swing } in &self.points {
            let _ = writeln!(text, "{ratio:.6e},{inside:.6e},{everywhere:.6e},{ends:.6e},{swing:.6e}");
        }
        let _ = writeln!(text, "inf,{:.6e},{:.6e},,", self.endless.inside, self.endless.everywhere);
        text
    }

    fn figure(&self) -> Figure {
        let series = |value: &dyn Fn(&LawPoint) -> f64| -> Vec<(f64, f64)> {
            self.points.iter().map(|point| (point.ratio, value(point))).collect()
        };
        let (first, last) = (self.points[0], self.points[self.points.len() - 1]);
        // Through the point at 0.05, above what the stroke does and below where half-strokes settle.
        let slope = |value: &dyn Fn(&LawPoint) -> f64, exponent: f64| -> Vec<(f64, f64)> {
            let near = |point: &&LawPoint| (point.ratio.log10() - 0.05_f64.log10()).abs();
            let through = self.points.iter().min_by(|a, b| near(a).total_cmp(&near(b))).unwrap_or(&first);
            let at = |ratio: f64| (ratio, value(through) * (ratio / through.ratio).powf(exponent));
            vec![at(first.ratio), at(0.3)]
        };
        let ratio = || Axis::logarithmic("cycle time / thermal time of the contact");
        let level = |name: &str, value: f64| {
            Series::line(name, vec![(0.3, value), (last.ratio, value)]).with(Mark::Dashes).coloured(6)
        };
        let inside = |point: &LawPoint| point.inside;
        let everywhere = |point: &LawPoint| point.everywhere;
        let pressures = vec![
            Series::line("means, |x| < .7 a", series(&inside)).with(Mark::LineAndPoints).coloured(0),
            Series::line("means, all of the contact", series(&everywhere)).with(Mark::LineAndPoints).coloured(2),
            Series::line("ends of half-strokes, |x| < .7 a", series(&|p| p.ends)).with(Mark::LineAndPoints).coloured(1),
            Series::line("theory: slope 3/2", slope(&inside, 1.5)).with(Mark::Dashes).coloured(0),
            Series::line("theory: slope 3/4", slope(&everywhere, 0.75)).with(Mark::Dashes).coloured(2),
            level("theory: endless cycles", self.endless.inside),
            level("", self.endless.everywhere),
        ];
        let swings = vec![
            Series::line("hotter surface, rms", series(&|p| p.swing)).with(Mark::LineAndPoints).coloured(0),
            Series::line("theory: slope 1/2", slope(&|p| p.swing, 0.5)).with(Mark::Dashes).coloured(0),
        ];
        let panels = vec![
            Panel::new(
                "Steady pressures with heat less those without",
                ratio(),
                Axis::logarithmic("rms difference / mean pressure"),
                pressures,
            ),
            Panel::new("Temperature", ratio(), Axis::logarithmic("range in a cycle / mean rise"), swings),
        ];
        Figure::new(format!("What heat changes in the steady cycle of {}", self.name), panels).with_header(vec![
            "the heat capacities of both bodies vary; load, friction heat, stroke and steady distortion stay".into(),
        ])
    }

    /// Writes the figure, and the numbers beside it.
    pub(crate) fn write(&self, path: &Path) -> Result<()> {
        let csv = path.with_extension("csv");
        output::make_above(&csv)?;
        fs::write(&csv, self.csv()).with_context(|| format!("writing {}", csv.display()))?;
        self.figure().write(path)
    }
}
