//! Rules that join parameters. They are checked when initialisation ends, because importers set
//! parameters in any order.

use super::message::{self, Number, Quantity};
use super::variables::{COUNT, STARTS, ValueReference, find, lookup};
use super::{
    Constraint, FRICTION_POINTS, Fidelity, Geometry, InitialShape, MechanicalBody, PROPERTY_POINTS, Path, Scene,
};

/// A rule that the parameters break: names the variables, their values and the limit.
#[derive(Clone, PartialEq, Debug)]
pub struct BrokenRule(pub String);

impl std::fmt::Display for BrokenRule {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.write_str(&self.0)
    }
}

impl std::error::Error for BrokenRule {}

/// Relative rounding tolerance for the equality of lengths.
const SAME_LENGTH: f64 = 1e-9;

/// Fewest cells of a contact line: a uniform, a linear and a quadratic pressure component.
const FEWEST_CELLS: usize = 3;

pub(super) fn check(scene: &Scene, values: &[f64]) -> Result<(), BrokenRule> {
    check_chosen(values)?;
    friction_table(scene, values)?;
    property_tables(scene)?;
    path(scene)?;
    holder(scene)?;
    heat(scene)?;
    wear(scene)?;
    shape(scene)?;
    tables(scene)?;
    level(scene)
}

fn broken<T>(text: String) -> Result<T, BrokenRule> {
    Err(BrokenRule(text))
}

/// Checks that temperatures which differ from the table's start values are also chosen to act.
fn check_chosen(values: &[f64]) -> Result<(), BrokenRule> {
    let of = |name: &str| find(name).map(|reference| (values[reference as usize], STARTS[reference as usize]));
    for (name, choice, acts, only_where_held) in [
        ("punch.initial_temperature", "punch.initial_at_ambient", false, None),
        ("strip.initial_temperature", "strip.initial_at_ambient", false, None),
        ("punch.top_temperature", "punch.top_at_ambient", false, Some("punch.top_thermal")),
        ("strip.base_temperature", "strip.base_at_ambient", false, Some("strip.base_thermal")),
        ("contact.temperature_limit", "contact.temperature_limited", true, None),
    ] {
        let held = only_where_held
            .and_then(of)
            .is_none_or(|(item, _)| super::ThermalBoundary::from_item(item) == super::ThermalBoundary::Held);
        if let (Some((temperature, start)), Some((choice_made, _))) = (of(name), of(choice))
            && held
            && temperature != start
            && (choice_made != 0.0) != acts
        {
            return broken(format!(
                "{name} = {} has no effect while {choice} = {}; set {choice} = {acts}",
                Quantity(temperature, "K"),
                !acts
            ));
        }
    }
    Ok(())
}

fn path(scene: &Scene) -> Result<(), BrokenRule> {
    let (width, length, radius) = (scene.width, scene.length, scene.mean_radius);
    if scene.path == Path::Closed && length <= 0.0 {
        return broken("strip.path = closed needs strip.length > 0 m or contact.mean_radius > 0 m; both are 0".into());
    }
    match scene.geometry {
        Geometry::Annular => {
            if scene.path != Path::Closed {
                return broken("contact.geometry = annular needs strip.path = closed; it is straight".into());
            }
            if radius <= 0.5 * width {
                return broken(format!(
                    "contact.mean_radius = {radius} m must be above punch.width/2 = {} m in annular geometry",
                    Number(0.5 * width),
                    radius = Number(radius)
                ));
            }
            let around = 2.0 * std::f64::consts::PI * radius;
            if scene.count * scene.depth > around * (1.0 + SAME_LENGTH) {
                return broken(format!(
                    "punch.count x depth = {} m is above the circumference 2 pi contact.mean_radius = {around} m",
                    Number(scene.count * scene.depth),
                    around = Number(around)
                ));
            }
            if (length - around).abs() > 1e-6 * around {
                let [length, around] = message::apart([length, around], "m");
                return broken(format!(
                    "strip.length = {length} differs from 2 pi contact.mean_radius = {around} in annular geometry; 0 takes it"
                ));
            }
        }
        Geometry::Periodic => {
            if scene.path != Path::Closed || (width - length).abs() > SAME_LENGTH * length || scene.count != 1.0 {
                return broken(format!(
                    "contact.geometry = periodic needs strip.path = closed, punch.count = 1 and punch.width = strip.length; \
                     punch.width = {width} m, strip.length = {length} m, punch.count = {}",
                    scene.count,
                    width = Number(width),
                    length = Number(length)
                ));
            }
            if scene.constraint == Constraint::TranslateAndRotate {
                return broken(
                    "contact.geometry = periodic has no edges, so holder.constraint must be translate".into(),
                );
            }
        }
        Geometry::Line => {
            if scene.path == Path::Closed && scene.count * width > length * (1.0 + SAME_LENGTH) {
                return broken(format!(
                    "punch.count x punch.width = {} m is above strip.length = {length} m",
                    Number(scene.count * width),
                    length = Number(length)
                ));
            }
        }
    }
    if scene.path == Path::Straight && scene.count != 1.0 {
        return broken(format!("punch.count = {} needs strip.path = closed", scene.count));
    }
    if scene.path == Path::Straight && length > 0.0 && length < width + scene.nominal_stroke {
        return broken(format!(
            "strip.length = {length} m is below punch.width + nominal.stroke = {} m",
            Number(width + scene.nominal_stroke),
            length = Number(length)
        ));
    }
    Ok(())
}

fn holder(scene: &Scene) -> Result<(), BrokenRule> {
    if scene.constraint == Constraint::TranslateAndRotate && scene.geometry == Geometry::Line {
        let coefficients =
            scene.friction_table.iter().flat_map(|table| table.coefficient.into_iter().take(table.points));
        let highest = coefficients.fold(scene.friction_coefficient, f64::max);
        let (lever, half_width) = (highest * scene.pivot_height, 0.5 * scene.width);
        if lever >= half_width {
            return broken(format!(
                "the punch tips over: contact.friction_coefficient x holder.pivot_height = {lever} m must be below \
                 punch.width/2 = {half_width} m",
                lever = Number(lever),
                half_width = Number(half_width)
            ));
        }
    }
    Ok(())
}

/// Rules of insulators, of the contact conductance and of heat paths.
pub(super) fn heat(scene: &Scene) -> Result<(), BrokenRule> {
    let insulators = [scene.punch.conductivity, scene.strip.conductivity].map(|conductivity| conductivity == 0.0);
    let friction = scene.friction_coefficient > 0.0;
    if friction && insulators == [true, true] {
        return broken(format!(
            "punch.conductivity = 0 and strip.conductivity = 0 with contact.friction_coefficient = {}: \
             neither body can conduct the friction heat; at least one must be > 0 W/(m.K)",
            scene.friction_coefficient
        ));
    }
    if friction && insulators.contains(&true) && scene.conductance == 0.0 {
        return broken(
            "contact.conductance = 0 sends half of the friction heat into each body, but one body has conductivity 0; \
             contact.conductance must be > 0 W/(m2.K)"
                .into(),
        );
    }
    neighbours(scene)
}

/// Rules of the heat paths to neighbours.
fn neighbours(scene: &Scene) -> Result<(), BrokenRule> {
    for (name, face, body) in [("punch", "top", &scene.punch), ("strip", "base", &scene.strip)] {
        if body.external_conductance == 0.0 {
            continue;
        }
        let given = format!("{name}.external_conductance = {} W/K", Number(body.external_conductance));
        if body.far_is_prescribed() {
            return broken(format!(
                "{given} needs {name}.{face}_thermal = insulated or convecting: the temperature of the face is prescribed"
            ));
        }
        if body.conductivity == 0.0 {
            return broken(format!("{given} needs {name}.conductivity > 0 W/(m.K); it is 0"));
        }
        if name == "strip" && scene.path == Path::Straight {
            return broken(format!(
                "{given} needs strip.path = closed: it belongs to the whole strip, and that of a track is open"
            ));
        }
    }
    Ok(())
}

fn wear(scene: &Scene) -> Result<(), BrokenRule> {
    for (name, body) in [("punch", &scene.punch), ("strip", &scene.strip)] {
        if body.initial_wear >= body.height {
            return broken(format!(
                "{name}.initial_wear = {} m must be below {name}.height = {} m",
                Number(body.initial_wear),
                Number(body.height)
            ));
        }
    }
    if scene.initial_shape == InitialShape::RunIn
        && scene.punch.wear_coefficient == 0.0
        && scene.strip.wear_coefficient == 0.0
    {
        return broken(
            "contact.initial_shape = run_in needs a body that wears; punch.wear_coefficient and strip.wear_coefficient are 0"
                .into(),
        );
    }
    Ok(())
}

fn shape(scene: &Scene) -> Result<(), BrokenRule> {
    if scene.initial_shape == InitialShape::Parabolic(0.0) {
        return broken("contact.initial_shape = parabolic needs contact.initial_radius > 0 m; it is 0".into());
    }
    Ok(())
}

fn tables(scene: &Scene) -> Result<(), BrokenRule> {
    for (name, table) in [
        ("contact.friction_fade", &scene.friction_fade),
        ("punch.wear_fade", &scene.punch.wear_fade),
        ("strip.wear_fade", &scene.strip.wear_fade),
    ] {
        if let Some(index) = table.disorder() {
            return broken(format!(
                "{name}.temperature[{}] = {} K must be above {name}.temperature[{index}] = {} K",
                index + 1,
                Number(table.temperature[index]),
                Number(table.temperature[index - 1])
            ));
        }
    }
    Ok(())
}

/// Rules of the table of the friction coefficient over sliding speed.
fn friction_table(scene: &Scene, values: &[f64]) -> Result<(), BrokenRule> {
    const NAME: &str = "contact.friction_table";
    let points = scene.friction_table.map_or(0, |table| table.points);
    for row in ["speed", "coefficient"] {
        let Some(first) = find(&format!("{NAME}.{row}[1]")).map(|reference| reference as usize) else { continue };
        if let Some(point) = (points..FRICTION_POINTS).find(|point| values[first + point] != STARTS[first + point]) {
            return broken(format!(
                "{NAME}.{row}[{}] = {} has no effect while {NAME}.points = {points}",
                point + 1,
                Number(values[first + point])
            ));
        }
    }
    let Some(table) = &scene.friction_table else { return Ok(()) };
    if table.points < 2 {
        return broken(format!("{NAME}.points = {} must be 0 (no table) or at least 2", table.points));
    }
    if table.speed[0] != 0.0 {
        return broken(format!("{NAME}.speed[1] = {} m/s must be 0 m/s", Number(table.speed[0])));
    }
    if let Some(index) = super::disorder(&table.speed[..table.points]) {
        let [speed, before] = message::apart([table.speed[index], table.speed[index - 1]], "m/s");
        return broken(format!("{NAME}.speed[{}] = {speed} must be above {NAME}.speed[{index}] = {before}", index + 1));
    }
    if scene.static_friction_ratio != 1.0 {
        return broken(format!(
            "contact.static_friction_ratio = {} and {NAME}.points = {} are both given: set contact.static_friction_ratio = 1 \
             with a table, whose first coefficient is that at standstill",
            Number(scene.static_friction_ratio),
            table.points
        ));
    }
    if scene.friction_coefficient == 0.0 {
        return broken(format!(
            "contact.friction_coefficient = 0 with {NAME}.points = {}: it scales the table and must be > 0",
            table.points
        ));
    }
    Ok(())
}

/// Rules of the tables of conductivity and specific heat over temperature.
fn property_tables(scene: &Scene) -> Result<(), BrokenRule> {
    for (name, body) in [("punch", &scene.punch), ("strip", &scene.strip)] {
        let Some(table) = &body.properties else { continue };
        if table.points < 2 {
            return broken(format!(
                "{name}.property_table.points = {} must be 0 (constants) or at least 2",
                table.points
            ));
        }
        if let Some(index) = super::disorder(&table.temperature[..table.points]) {
            let [next, before] = message::apart([table.temperature[index], table.temperature[index - 1]], "K");
            return broken(format!(
                "{name}.property_table.temperature[{}] = {next} must be above {name}.property_table.temperature[{index}] = {before}",
                index + 1
            ));
        }
    }
    Ok(())
}

/// The first value that differs from `base` without effect, and what to set instead: a constant of a body with a property table, a
/// value behind the last point of one. `base` is what the scene gives by itself, whose table `points` = 0 switches off.
pub fn without_effect(values: &[f64; COUNT], base: &[f64; COUNT]) -> Option<String> {
    ["punch", "strip"].into_iter().find_map(|body| {
        let of = |name: &str| find(&format!("{body}.{name}")).map(|reference| reference as usize);
        let points = values[of("property_table.points")?];
        let differs = |at: &usize| values[*at] != base[*at];
        let constant =
            ["conductivity", "specific_heat"].into_iter().filter_map(of).find(differs).filter(|_| points > 0.0);
        let behind = |row| of(row).and_then(|first| (first + points as usize..first + PROPERTY_POINTS).find(differs));
        let rows =
            ["property_table.temperature[1]", "property_table.conductivity[1]", "property_table.specific_heat[1]"];
        let at = constant.or_else(|| rows.into_iter().find_map(behind))?;
        let (row, element) = lookup(at as ValueReference)?;
        let remedy = constant.map_or(String::new(), |_| format!("; set {body}.property_table.points = 0"));
        let (name, value) = (row.element_name(element), Number(values[at]));
        Some(format!("{name} = {value} has no effect while {body}.property_table.points = {points}{remedy}"))
    })
}

fn level(scene: &Scene) -> Result<(), BrokenRule> {
    let rigid = [scene.punch.mechanical, scene.strip.mechanical] == [MechanicalBody::Rigid; 2];
    if rigid && scene.fidelity == Fidelity::Line {
        return broken(
            "punch.body = rigid on strip.body = rigid can only be lumped; set solver.fidelity to lumped or auto".into(),
        );
    }
    if scene.fidelity != Fidelity::Lumped && (1..FEWEST_CELLS).contains(&scene.cells) {
        return broken(format!(
            "solver.cells = {} must be 0 (automatic) or at least {FEWEST_CELLS}: fewer cells cannot represent a pressure \
             distribution; solver.fidelity = lumped has a uniform pressure",
            scene.cells
        ));
    }
    Ok(())
}
