//! The figure of a run: what stands in which panel. `python/sliding_contact/_figure.py` draws it with matplotlib, for the command and in
//! Python.

use super::measured::Measured;
use super::quantity::Shown;
use super::rig::{Rig, interpolated, reversals};
use super::run::{Channel, Profiles, Recording, energy_residual};
use crate::curve::{CONTACT_POINTS, monotone_cubic};
use serde::Serialize;

/// Points of a curve over time at most: more cannot be seen.
const POINTS: usize = 4000;

/// Markers of a measured curve at most: a record of noise is a cloud of its own density.
const MARKERS: usize = 600;

/// Range of a quantity over its largest value up to which it is constant: told in words, not drawn.
const CONSTANT: f64 = 1e-3;

/// Half-strokes of a run above which two strokes are drawn in full beside its whole course.
const MANY: usize = 100;

/// Fraction of the largest value of a panel below which a curve is left out: it is the axis.
const VISIBLE: f64 = 1e-2;

/// Range of a worn depth over its largest value below which its shape is drawn without the mean.
const FLAT: f64 = 0.2;

/// The same below which the shape is rounding, and not drawn.
const FLAT_SHAPE: f64 = 1e-9;

/// A curve.
#[derive(Clone, PartialEq, Debug, Serialize)]
pub struct Series {
    /// Name in the legend.
    pub name: String,
    /// Index of the colour.
    pub colour: usize,
    /// Points instead of a line.
    pub measured: bool,
    /// Abscissas.
    pub x: Vec<f64>,
    /// Ordinates.
    pub y: Vec<f64>,
}

/// Curves over the same axes.
#[derive(Clone, PartialEq, Debug, Serialize)]
pub struct Panel {
    /// Label of the abscissa.
    pub x: String,
    /// Label of the ordinate.
    pub y: String,
    /// Curves.
    pub series: Vec<Series>,
    /// Of a run over many strokes: the last two strokes in full.
    pub strokes: Vec<Series>,
}

/// The figure of a run.
#[derive(Clone, PartialEq, Debug, Serialize)]
pub struct Figure {
    /// Title.
    pub title: String,
    /// Quantities that are constant, each with its value.
    pub constants: Vec<String>,
    /// Panels over the time.
    pub courses: Vec<Panel>,
    /// Panels of a test rig, one row: worn volume over distance, friction loop.
    pub rig: Vec<Panel>,
    /// Panels over the contact, one row.
    pub profiles: Vec<Panel>,
}

/// Panels over the time: label, and variables with their names in the legend.
const COURSES: &[(&str, &[(&str, &str)])] = &[
    ("sliding velocity", &[("sliding_velocity", "")]),
    ("angular velocity", &[("angular_velocity", "")]),
    ("normal load", &[("normal_load", "")]),
    ("ambient temperature offset", &[("ambient_temperature_offset", "")]),
    ("cooling velocity", &[("cooling_velocity", "")]),
    ("external temperature", &[("strip.external_temperature", "strip"), ("punch.external_temperature", "punch")]),
    (
        "temperature",
        &[
            ("contact_temperature_max", "hottest point"),
            ("contact_temperature", "mean of both surfaces"),
            ("punch.mean_temperature", "punch, mean"),
            ("strip.mean_temperature", "strip, mean"),
        ],
    ),
    ("worn depth", &[("wear_depth_punch", "punch"), ("wear_depth_strip", "strip")]),
    ("friction force", &[("friction_force", "")]),
    ("friction coefficient", &[("friction_coefficient", "")]),
    ("pressure", &[("pressure_max", "highest"), ("pressure_mean", "mean")]),
    (
        "energy",
        &[
            ("dissipated_energy", "friction heat"),
            ("stored_heat", "stored"),
            ("heat_lost_ambient", "lost: air"),
            ("heat_lost_punch_top", "lost: punch top"),
            ("heat_lost_strip_base", "lost: strip base"),
        ],
    ),
];

/// Panels that are drawn also where their values are 0 throughout.
const ALWAYS: [&str; 4] = ["sliding velocity", "normal load", "worn depth", "energy"];

impl Figure {
    /// Of a run of a scene beside a measured record.
    pub fn new(scene: &str, recording: &Recording, measured: &[Measured]) -> Self {
        let residual = power(energy_residual(recording));
        let title = format!("{scene}, level {}; energy balance closes to {residual}", recording.level);
        let constants: Vec<(&str, String)> = COURSES
            .iter()
            .filter_map(|(label, variables)| Some((*label, constant(label, variables, recording, measured)?)))
            .collect();
        let mut courses: Vec<Panel> = COURSES
            .iter()
            .filter(|(label, _)| !constants.iter().any(|(constant, _)| constant == label))
            .filter_map(|course| panel(course.0, course.1, recording, measured))
            .collect();
        let drawn = |name: &str| COURSES.iter().any(|(_, variables)| variables.iter().any(|(own, _)| *own == name));
        // A record may have every variable of the FMU; what is constant on both sides shows nothing.
        let others = measured.iter().filter(|own| !drawn(&own.name) && varies(own, recording));
        courses.extend(
            others
                .filter_map(|own| panel(&own.name.replace('_', " "), &[(own.name.as_str(), "")], recording, measured)),
        );
        let constants = constants.into_iter().map(|(_, text)| text).filter(|text| !text.is_empty()).collect();
        Self { title, constants, courses, rig: rig(recording, measured), profiles: profiles(recording) }
    }
}

/// Name and value of a quantity that no record has and that is constant over the run, the same of all its variables; empty where it is 0
/// and need not be told.
fn constant(label: &str, variables: &[(&str, &str)], recording: &Recording, measured: &[Measured]) -> Option<String> {
    if variables.iter().any(|(name, _)| measured.iter().any(|own| own.name == *name)) {
        return None;
    }
    let channels: Vec<&Channel> = variables.iter().filter_map(|(name, _)| recording.channel(name)).collect();
    let (first, ranges) = (channels.first()?, channels.iter().map(|channel| extremes(&channel.values)));
    let (low, high) = ranges.reduce(|one, other| (one.0.min(other.0), one.1.max(other.1)))?;
    let most = low.abs().max(high.abs());
    if high - low > CONSTANT * most {
        return None;
    }
    let shown = Shown::of(first.name, first.unit, most);
    let value = format!("{label} {}", significant(&shown, 0.5 * (low + high)));
    let turns = recording.channel("angular_velocity").is_some_and(|own| own.values.iter().any(|value| *value != 0.0));
    Some(if most == 0.0 && (turns && label == ALWAYS[0] || !ALWAYS.contains(&label)) { String::new() } else { value })
}

/// Four significant digits at most, with the unit.
fn significant(shown: &Shown, value: f64) -> String {
    format!("{} {}", rounded_to_four(shown.value(value)), shown.unit).trim_end().to_owned()
}

fn rounded_to_four(value: f64) -> f64 {
    format!("{value:.3e}").parse().unwrap_or(value)
}

/// Rows of the last two strokes of a run over many: between three reversals of the sliding velocity, the last one of the same sense.
fn last_strokes(recording: &Recording) -> Option<std::ops::Range<usize>> {
    let reversals = reversals(recording);
    let last = reversals.len().checked_sub(1).filter(|_| reversals.len() > MANY)?;
    // Two strokes there and back are four half-strokes.
    Some(reversals[last - 4]..reversals[last])
}

/// Whether a measured quantity changes, or differs from its calculated course.
fn varies(own: &Measured, recording: &Recording) -> bool {
    let calculated = recording.channel(&own.name).into_iter().flat_map(|channel| channel.values.iter().copied());
    let mut values = own.points.iter().map(|point| point.1).chain(calculated);
    values.next().is_some_and(|first| values.any(|value| value != first))
}

/// A small number in the mathematical text of matplotlib: `2e-15` as 2 times a power of ten.
fn power(number: f64) -> String {
    match format!("{number:.0e}").split_once('e') {
        Some((digit, exponent)) if number != 0.0 => format!("${digit}\\times 10^{{{exponent}}}$"),
        _ => "0".into(),
    }
}

/// The panel of some variables over the time; `None` where there is nothing to see.
fn panel(label: &str, variables: &[(&str, &str)], recording: &Recording, measured: &[Measured]) -> Option<Panel> {
    let found: Vec<_> = variables
        .iter()
        .filter_map(|(name, legend)| {
            let own = measured.iter().find(|own| own.name == *name);
            Some((recording.channel(name)?, *legend, own))
        })
        .collect();
    let size = |values: &[f64]| values.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
    let size_of = |at: usize| {
        let (channel, _, own) = &found[at];
        let points = own.map_or(0.0, |own| own.points.iter().fold(0.0_f64, |most, point| most.max(point.1.abs())));
        size(&channel.values).max(points)
    };
    let sizes: Vec<f64> = (0..found.len()).map(size_of).collect();
    let most = size(&sizes);
    let (first, _, _) = found.first()?;
    if most == 0.0 && !ALWAYS.contains(&label) {
        return None;
    }
    let shown = Shown::of(first.name, first.unit, most);
    let rows = last_strokes(recording);
    let (mut series, mut strokes, mut twins) = (Vec::new(), Vec::new(), false);
    for (colour, (channel, legend, own)) in found.iter().enumerate() {
        let visible = colour == 0 || sizes[colour] > VISIBLE * most;
        // Curves that lie on each other are one.
        let twin = found[..colour].iter().any(|(before, ..)| before.values == channel.values);
        twins |= twin;
        if own.is_none() && (!visible || twin) {
            continue;
        }
        let values: Vec<f64> = channel.values.iter().map(|value| shown.value(*value)).collect();
        let (x, y) = thinned(&recording.times, &values, POINTS);
        series.push(Series { name: (*legend).to_owned(), colour, measured: false, x, y });
        if let Some(rows) = &rows {
            let (x, y) = (recording.times[rows.clone()].to_vec(), values[rows.clone()].to_vec());
            strokes.push(Series { name: (*legend).to_owned(), colour, measured: false, x, y });
        }
        if let Some(own) = own {
            let (x, y): (Vec<f64>, Vec<f64>) =
                own.points.iter().map(|(time, value)| (*time, shown.value(*value))).unzip();
            let points = |x: &[f64], y: &[f64]| {
                let (x, y) = sampled(x, y, MARKERS);
                Series { name: String::new(), colour, measured: true, x, y }
            };
            if let Some(rows) = &rows {
                let from = x.partition_point(|time| *time < recording.times[rows.start]);
                let to = x.partition_point(|time| *time < recording.times[rows.end]);
                strokes.push(points(&x[from..to], &y[from..to]));
            }
            series.push(points(&x, &y));
        }
    }
    // The label of the axis says what a single curve is, unless it is of several that coincide.
    let mut label = label.to_owned();
    match &mut series[..] {
        [only] => {
            let name = std::mem::take(&mut only.name);
            if !name.is_empty() && !twins {
                label = format!("{label}, {name}");
            }
        }
        [simulated, measured] if measured.measured && simulated.name.is_empty() => simulated.name = "simulated".into(),
        _ => {}
    }
    Some(Panel { x: "time (s)".into(), y: shown.label(&label), series, strokes })
}

/// Worn volume over distance with the end of running-in, and the friction loop; of a run that is one of a rig.
fn rig(recording: &Recording, measured: &[Measured]) -> Vec<Panel> {
    let Some(own) = Rig::of(recording, measured) else { return Vec::new() };
    let line = |name: &str, colour, (x, y)| Series { name: name.to_owned(), colour, measured: false, x, y };
    let distance = recording.values("sliding_distance");
    let along = Shown::of_difference("m", crate::largest(distance.iter().copied()));
    let worn = ["punch", "strip"].map(|body| recording.values(&format!("wear_volume_{body}")));
    let most = crate::largest(worn.iter().flat_map(|volume| volume.iter().copied()));
    let volume = Shown::of_difference("m3", most);
    let x: Vec<f64> = distance.iter().map(|own| along.value(*own)).collect();
    let mut series = Vec::new();
    for (colour, (name, worn)) in ["punch", "strip"].into_iter().zip(worn).enumerate() {
        if most > 0.0 && crate::largest(worn.iter().copied()) > VISIBLE * most {
            let y: Vec<f64> = worn.iter().map(|own| volume.value(*own)).collect();
            series.push(line(name, colour, thinned(&x, &y, POINTS)));
        }
    }
    if let Some([_, end]) = own.running_in.filter(|[_, end]| *end > 0.0) {
        let end = along.value(end);
        series.push(line("running-in ends", 2, (vec![end; 2], vec![0.0, volume.value(most)])));
    }
    let (x, y) = (along.label("sliding distance"), volume.label("worn volume"));
    let mut panels = vec![Panel { x, y, series, strokes: Vec::new() }];
    panels.retain(|panel| !panel.series.is_empty());
    if let Some(own) = own.friction_loop {
        let (displacement, force) =
            (&recording.displacement[own.rows.clone()], &recording.values("friction_force")[own.rows.clone()]);
        let along = Shown::of_difference("m", 0.5 * own.stroke);
        let across = Shown::of("friction_force", "N", crate::largest(force.iter().copied()));
        let (low, high) = extremes(displacement);
        let middle = 0.5 * (low + high);
        let x = displacement.iter().map(|x| along.value(x - middle)).collect();
        let y = force.iter().map(|force| across.value(*force)).collect();
        let mut series = vec![line("", 0, (x, y))];
        let points = measured.iter().find(|own| own.name == "friction_force").map_or(&[][..], |own| &own.points);
        let times = &recording.times[own.rows.clone()];
        let within = points.iter().filter(|(time, _)| (times[0]..=times[times.len() - 1]).contains(time));
        let at = |time: f64| along.value(interpolated(times, displacement, time) - middle);
        let (x, y): (Vec<f64>, Vec<f64>) = within.map(|(time, force)| (at(*time), across.value(*force))).unzip();
        if !x.is_empty() {
            series.push(Series { measured: true, ..line("", 0, sampled(&x, &y, MARKERS)) });
        }
        let (x, y) = (along.label("displacement"), across.label("friction force"));
        panels.push(Panel { x, y, series, strokes: Vec::new() });
    }
    panels
}

/// Panels over the contact; none of a run without profiles.
fn profiles(recording: &Recording) -> Vec<Panel> {
    let all = &recording.profiles;
    if all.is_empty() {
        return Vec::new();
    }
    let along = if recording.radial { "radius less the mean one" } else { "x, sliding direction" };
    let half_width = all[0].x[all[0].x.len() - 1].abs();
    let position = Shown::of_difference("m", half_width.clamp(1e-3, 0.5));
    let draw = |label: &str, name: &str, unit: &str, of: &dyn Fn(&Profiles) -> Vec<f64>| {
        let most = all.iter().flat_map(of).fold(0.0_f64, |most, value| most.max(value.abs()));
        let shown = Shown::of(name, unit, most);
        let series = all.iter().enumerate().map(|(colour, own)| {
            let (x, y) = monotone_cubic(&own.x, &of(own), CONTACT_POINTS);
            Series {
                name: format!("{} s", rounded_to_four(own.time)),
                colour,
                measured: false,
                x: x.iter().map(|x| position.value(*x)).collect(),
                y: y.iter().map(|y| shown.value(*y)).collect(),
            }
        });
        let series = series.collect();
        Panel { x: position.label(along), y: shown.label(label), series, strokes: Vec::new() }
    };
    let mut panels = vec![
        draw("pressure", "profile.pressure", "Pa", &|own| own.pressure.to_vec()),
        draw("surfaces' mean temperature", "profile.temperature", "K", &|own| own.temperature.to_vec()),
    ];
    for (body, name) in ["punch", "strip"].into_iter().enumerate() {
        let range = |own: &Profiles| {
            let (low, high) = extremes(&own.worn[body]);
            high - low
        };
        let most = all.iter().fold(0.0_f64, |most, own| most.max(extremes(&own.worn[body]).1));
        if all.iter().all(|own| range(own) <= FLAT_SHAPE * most) {
            continue;
        }
        if all.iter().all(|own| range(own) < FLAT * most) {
            let label = format!("worn depth of the {name} less its mean");
            panels.push(draw(&label, "wear", "m", &|own| {
                let mean = own.worn[body].iter().sum::<f64>() / own.worn[body].len() as f64;
                own.worn[body].iter().map(|depth| depth - mean).collect()
            }));
        } else {
            panels.push(draw(&format!("worn depth of the {name}"), "wear", "m", &|own| own.worn[body].to_vec()));
        }
    }
    panels
}

fn extremes(values: &[f64]) -> (f64, f64) {
    values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| (low.min(*value), high.max(*value)))
}

/// At most about `most` points: of every group the first, the extremes and the last, so that the drawn curve is the same.
fn thinned(x: &[f64], y: &[f64], most: usize) -> (Vec<f64>, Vec<f64>) {
    if x.len() <= most {
        return (x.to_vec(), y.to_vec());
    }
    let group = x.len().div_ceil(most / 4);
    let mut kept: Vec<usize> = Vec::with_capacity(most + 4);
    for begin in (0..x.len()).step_by(group) {
        let end = (begin + group).min(x.len());
        let by = |one: &usize, other: &usize| y[*one].total_cmp(&y[*other]);
        let (low, high) = ((begin..end).min_by(by), (begin..end).max_by(by));
        let mut of_group = [begin, low.unwrap_or(begin), high.unwrap_or(begin), end - 1];
        of_group.sort_unstable();
        kept.extend(of_group);
    }
    kept.dedup();
    kept.iter().map(|&row| (x[row], y[row])).unzip()
}

/// At most `most` points, equally far apart by their number, the first and the last among them: of noise, its extremes alone would look
/// like two bands.
fn sampled(x: &[f64], y: &[f64], most: usize) -> (Vec<f64>, Vec<f64>) {
    if x.len() <= most {
        return (x.to_vec(), y.to_vec());
    }
    (0..most).map(|point| point * (x.len() - 1) / (most - 1)).map(|row| (x[row], y[row])).unzip()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::shipped;

    #[test]
    fn a_sampled_record_keeps_its_scatter() {
        let x: Vec<f64> = (0..100_000).map(f64::from).collect();
        // A fixed sequence that fills the interval from 0 to 1 evenly.
        let y: Vec<f64> = x.iter().map(|x| (0.618_033_988_749_895 * x).fract()).collect();
        let (times, values) = sampled(&x, &y, MARKERS);
        assert_eq!((times.len(), times[0], times[MARKERS - 1]), (MARKERS, 0.0, 99_999.0));
        let inner = values.iter().filter(|value| (0.25..0.75).contains(*value)).count();
        assert!((0.45..0.55).contains(&(inner as f64 / MARKERS as f64)), "{inner} of {MARKERS}");
        assert_eq!(sampled(&x[..5], &y[..5], MARKERS).0, x[..5]);
    }

    #[test]
    fn two_of_hundreds_of_strokes_are_drawn_in_full() {
        let mut file = shipped("reciprocating_punch");
        for assignment in ["solver.fidelity=lumped", "nominal.duration=60 s"] {
            scene_file::assign(&mut file, assignment).unwrap();
        }
        let scene = scene::Scene::new(&file.packaged.starts, None).unwrap();
        let trajectory = super::super::trajectory::Trajectory::nominal(&file, &scene, None).unwrap();
        let recording = super::super::run::run(&file, &trajectory, &[], &mut |_| ()).unwrap();
        let figure = Figure::new("strokes", &recording, &[]);
        let velocity = figure.courses.iter().find(|panel| panel.y.starts_with("sliding velocity")).unwrap();
        let drawn = &velocity.strokes[0];
        let length = drawn.x[drawn.x.len() - 1] - drawn.x[0];
        // Two strokes there and back of nominal.stroke each way at the nominal mean speed.
        let expected = 4.0 * scene.nominal_stroke / scene.nominal_velocity;
        assert!((length / expected - 1.0).abs() < 0.1 && drawn.x[0] > 55.0, "{length} {expected}");
        let reversals = drawn.y.windows(2).filter(|pair| pair[0] * pair[1] < 0.0).count();
        assert!((3..=4).contains(&reversals), "{reversals}");
        // Highest and mean pressure are one at this level.
        for told in ["normal load 10 kN", "pressure 16.67 MPa"] {
            assert!(figure.constants.contains(&told.to_owned()), "{:?}", figure.constants);
        }
    }

    #[test]
    fn thinning_keeps_extremes_ends_and_order() {
        let x: Vec<f64> = (0..100_000).map(f64::from).collect();
        let mut y: Vec<f64> = x.iter().map(|x| (0.001 * x).sin()).collect();
        y[54_321] = 7.0;
        y[77_777] = -7.0;
        let (times, values) = thinned(&x, &y, POINTS);
        assert!(times.len() <= POINTS && times.windows(2).all(|pair| pair[0] < pair[1]));
        assert_eq!((times[0], times[times.len() - 1]), (0.0, 99_999.0));
        assert!(values.contains(&7.0) && values.contains(&-7.0));
    }
}
