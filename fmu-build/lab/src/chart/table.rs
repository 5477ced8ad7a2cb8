//! The CSV file beside a chart.

use super::Chart;
use std::fmt::Write as _;
use verification::drives::Quantity;

/// Everything that was measured, one row per run, under a header of comments.
pub(crate) fn of(chart: &Chart) -> String {
    let mut text = String::new();
    for line in header(chart) {
        let _ = writeln!(text, "# {line}");
    }
    for omission in &chart.omissions {
        let _ = writeln!(text, "# left out: {}", omission.replace('\n', " "));
    }
    text += "family,setting,initialisation_s,total_s,internal_steps,error_wear_depth,error_contact_temperature,\
             error_friction_force,error_peak_pressure,part_done,failure\n";
    for point in &chart.points {
        let errors = Quantity::ALL.map(|quantity| {
            let error = point.errors.of(quantity);
            if error.is_nan() { String::new() } else { format!("{error:.3e}") }
        });
        let (failure, part) = point.failure.as_ref().map_or(("", 1.0), |(text, part)| (text.as_str(), *part));
        let _ = writeln!(
            text,
            "{},{},{:.4e},{:.4e},{},{},{part:.4},{}",
            quoted(&point.family),
            quoted(&point.setting),
            point.seconds[0],
            point.seconds[1],
            point.steps,
            errors.join(","),
            quoted(failure)
        );
    }
    text
}

/// Title, data, truth, and where it was measured.
pub(crate) fn header(chart: &Chart) -> Vec<String> {
    let problem = &chart.problem;
    vec![
        chart.data.clone(),
        format!("Truth: {}; {}.", chart.how, problem.reason),
        chart.measured.clone(),
        "Errors: largest over the samples, relative to the largest value (temperature: to the peak rise); drawn at 1e-8 at least.".into(),
    ]
}

fn quoted(text: &str) -> String {
    format!("\"{}\"", text.replace('"', "'").replace('\n', " "))
}
