//! Which quantity a header names: by its own name, or by the words that rigs write together with the unit.

use super::Column;
use crate::unit_names::canonical;
use crate::{nearest, quantity};
use scene::message::Quoted;
use scene::variables::TABLE;
use scene::variables::units::ONE;
use std::borrow::Cow;

/// Most columns that a message lists.
const LISTED: usize = 12;

/// Least length of a name whose mistyped form is recognised.
const LEAST_LENGTH: usize = 4;

/// Words of rigs for the words of names below.
const SYNONYMS: &[(&str, &str)] = &[
    ("temp", "temperature"),
    ("velocity", "speed"),
    ("frictional", "friction"),
    ("tangential", "friction"),
    ("coeff", "coefficient"),
    ("coef", "coefficient"),
    ("disc", "strip"),
    ("disk", "strip"),
    ("rotor", "strip"),
    ("pad", "punch"),
    ("pin", "punch"),
    ("ball", "punch"),
    ("block", "punch"),
    ("stift", "punch"),
    ("belag", "punch"),
    ("scheibe", "strip"),
    ("loss", "wear"),
    ("verschlei\u{df}", "wear"),
    ("verschleiss", "wear"),
    ("temperatur", "temperature"),
    ("worn", "wear"),
    ("weight", "mass"),
    ("braking", "brake"),
];

/// Names of rigs, their words written together, and the quantities that they may be; the unit decides between these.
const NAMES: &[(&[&str], &[&str])] = &[
    (
        &[
            "t",
            "zeit",
            "elapsedtime",
            "testtime",
            "timestamp",
            "runtime",
            "datetime",
            "uhrzeit",
            "datumuhrzeit",
            "zeitstempel",
            "versuchszeit",
            "laufzeit",
        ],
        &["time"],
    ),
    (
        &[
            "v",
            "speed",
            "slidingspeed",
            "stripspeed",
            "surfacespeed",
            "rotationalspeed",
            "rotationspeed",
            "shaftspeed",
            "geschwindigkeit",
            "gleitgeschwindigkeit",
            "drehzahl",
        ],
        &["sliding_velocity", "angular_velocity", "speed"],
    ),
    (&["rpm"], &["angular_velocity"]),
    (
        &[
            "load",
            "normalload",
            "normalforce",
            "fn",
            "fz",
            "appliedload",
            "clampingforce",
            "normalkraft",
            "anpresskraft",
            "last",
        ],
        &["normal_load", "load"],
    ),
    (&["friction", "reibung"], &["friction_force", "friction_torque", "friction_coefficient"]),
    (&["ff", "reibkraft", "reibungskraft"], &["friction_force"]),
    (&["torque", "braketorque", "reibmoment", "bremsmoment"], &["friction_torque"]),
    (
        &["coefficientoffriction", "cof", "mu", "\u{b5}", "\u{3bc}", "reibwert", "reibungszahl"],
        &["friction_coefficient"],
    ),
    (
        &["wear", "linearwear", "totalwear", "wearvolume", "volumewear", "volume", "wearmass", "masswear"],
        &["wear_depth", "wear_volume_punch", "wear_volume_strip", "wear_mass_punch", "wear_mass_strip"],
    ),
    (
        &[
            "punchwear",
            "wearpunch",
            "stiftverschlei\u{df}",
            "belagverschlei\u{df}",
            "punchweardepth",
            "punchwearvolume",
            "punchwearmass",
            "punchmasswear",
            "punchvolumewear",
        ],
        &["wear_depth_punch", "wear_volume_punch", "wear_mass_punch"],
    ),
    (
        &[
            "stripwear",
            "wearstrip",
            "scheibenverschlei\u{df}",
            "stripweardepth",
            "stripwearvolume",
            "stripwearmass",
            "stripmasswear",
            "stripvolumewear",
        ],
        &["wear_depth_strip", "wear_volume_strip", "wear_mass_strip"],
    ),
    (&["temperature", "frictiontemperature"], &["contact_temperature"]),
    (&["striptemperature", "scheibentemperatur"], &["strip.mean_temperature"]),
    (&["punchtemperature", "stifttemperatur", "belagtemperatur"], &["punch.mean_temperature"]),
    (&["distance", "slidingdistance", "weg", "gleitweg", "reibweg"], &["sliding_distance", "distance"]),
    (&["vehiclespeed", "linearspeed", "carspeed", "roadspeed"], &["speed"]),
    (&["tripnumber", "tripno", "tripnr", "tripid"], &["trip"]),
];

/// What a header is found to be.
pub(super) enum Match<'a> {
    /// A column with the sign of its unit.
    Known(&'a Column, Cow<'a, str>),
    /// As `Known`, by words and unit.
    Meant(&'a Column, Cow<'a, str>),
    /// None; what it may have been meant as, for the message.
    Unknown(String),
}

/// Finds the column of a header.
pub(super) fn find<'a>(header: &'a str, known: &[&'a Column]) -> Result<Match<'a>, String> {
    if let Some((column, said)) = known.iter().find_map(|column| Some((*column, column.unit_of(header)?))) {
        return match said {
            Said::Nothing if column.unit_required => {
                Err(format!("{} does not say its unit; accepted is {}", Quoted(header), column.headers()))
            }
            Said::Nothing => Ok(Match::Known(column, column.unit.name.into())),
            Said::Symbol(symbol) => match quantity::in_si(0.0, symbol, column.unit, column.absolute) {
                Ok(_) => Ok(Match::Known(column, symbol.into())),
                Err(wrong) => Err(format!("{}: {wrong}", Quoted(header))),
            },
        };
    }
    let (name, symbol) = split(header);
    let own = words(name);
    let named = NAMES.iter().filter(|(names, _)| names.contains(&own.as_str())).flat_map(|(_, quantities)| *quantities);
    let named: Vec<&str> = named.copied().collect();
    let is_candidate = |column: &&Column| words(&column.name) == own || named.contains(&column.name.as_str());
    let candidates: Vec<&Column> = known.iter().copied().filter(is_candidate).collect();
    let near = near(name, known);
    if candidates.is_empty() && !near.is_empty() {
        return Err(format!(
            "{} is not a known quantity with a known unit; {}{near}",
            Quoted(header),
            alternatives(known)
        ));
    }
    let fits = |column: &&Column| match symbol {
        Some(symbol) => quantity::in_si(0.0, symbol, column.unit, column.absolute).is_ok(),
        None => !column.unit_required,
    };
    let mut fitting: Vec<&Column> = candidates.iter().copied().filter(fits).collect();
    // The very words of one say more than what they may also mean.
    if let Some(same) = fitting.iter().copied().find(|column| words(&column.name) == own) {
        fitting = vec![same];
    }
    match (fitting.as_slice(), candidates.as_slice()) {
        ([only], _) => Ok(Match::Meant(only, symbol.unwrap_or(only.unit.name).into())),
        ([], []) if TABLE.iter().any(|row| row.name == name) => {
            Ok(Match::Unknown(" (a parameter, which the scene sets)".into()))
        }
        ([], []) => Ok(Match::Unknown(symbol.map_or_else(String::new, |symbol| of_unit(symbol, known)))),
        ([], [first, ..]) => Ok(Match::Unknown(match symbol {
            Some(symbol) => format!(" ({} is no known unit of {})", Quoted(symbol), first.with_units()),
            None => format!(" (with a unit it may be {})", first.with_units()),
        })),
        (several, _) => {
            let names: Vec<&str> = several.iter().map(|column| column.name.as_str()).collect();
            Ok(Match::Unknown(format!(" ({}?)", names.join(" or "))))
        }
    }
}

/// The quantities of rigs that have this unit, for a name that says nothing.
fn of_unit(symbol: &str, known: &[&Column]) -> String {
    let fits = |column: &&&Column| {
        column.unit.name != ONE.name
            && NAMES.iter().any(|(_, quantities)| quantities.contains(&column.name.as_str()))
            && quantity::in_si(0.0, symbol, column.unit, column.absolute).is_ok()
    };
    let names: Vec<&str> = known.iter().filter(fits).map(|column| column.name.as_str()).collect();
    if names.is_empty() { String::new() } else { format!(" ({}?)", names.join(" or ")) }
}

/// Name and unit of a header: `Force [N]`, `Force (N)`, `Force / N`.
pub(super) fn split(header: &str) -> (&str, Option<&str>) {
    let pair = |open, close| header.strip_suffix(close)?.split_once(open);
    match pair('[', ']').or_else(|| pair('(', ')')).or_else(|| header.split_once(" / ")) {
        Some((name, symbol)) => (name.trim_end(), Some(symbol.trim())),
        None => (header, None),
    }
}

/// The words of a name in one, with the words that names have: `strip.temperature`, `Disc Temp.` and `discTemperature` are the same.
fn words(name: &str) -> String {
    let mut words = vec![String::new()];
    let mut before = ' ';
    for character in name.chars() {
        if !character.is_alphanumeric() || (before.is_lowercase() && character.is_uppercase()) {
            words.push(String::new());
        }
        if character.is_alphanumeric() {
            words.last_mut().into_iter().for_each(|word| word.extend(character.to_lowercase()));
        }
        before = character;
    }
    let meant =
        |word: &String| SYNONYMS.iter().find(|(own, _)| own == word).map_or(word.clone(), |(_, meant)| (*meant).into());
    words.iter().map(meant).collect()
}

/// The names that a name is a slip of; nothing where it is another word.
fn near(name: &str, known: &[&Column]) -> String {
    let tolerated = if name.chars().count() < 2 * LEAST_LENGTH { 1 } else { 2 };
    let slip = |own: &&&Column| {
        own.name.len() >= LEAST_LENGTH
            && own.name.len().abs_diff(name.len()) <= tolerated
            && strsim::levenshtein(&own.name, name) <= tolerated
    };
    let slips: Vec<&str> = known.iter().filter(slip).map(|column| column.name.as_str()).collect();
    nearest(name, slips.into_iter())
}

/// The accepted headers, or two of many.
pub(super) fn alternatives(known: &[&Column]) -> String {
    let taken: Vec<String> = known.iter().filter(|column| column.taken).map(|column| column.headers()).collect();
    if taken.len() <= LISTED {
        return format!("accepted are {}", taken.join(", "));
    }
    format!("accepted are the time, inputs and outputs of the FMU by their names, as {}", taken[..2].join(", "))
}

impl Column {
    /// The headers that are accepted, for messages.
    pub(super) fn headers(&self) -> String {
        if self.unit_required { self.with_units() } else { format!("{} or {}", self.name, self.with_units()) }
    }

    /// Its name with all units.
    fn with_units(&self) -> String {
        let others = quantity::units(self.unit, self.absolute).map(|display| display.name);
        let units: Vec<&str> = std::iter::once(self.unit.name).chain(others).collect();
        format!("{} [{}]", self.name, units.join(" or "))
    }

    /// The unit that a header says of this quantity; `None` where it is another quantity's header.
    fn unit_of<'a>(&self, header: &'a str) -> Option<Said<'a>> {
        let rest = header.strip_prefix(self.name.as_str())?;
        if rest.is_empty() {
            return Some(Said::Nothing);
        }
        if let (name, Some(symbol)) = split(header)
            && name == self.name
        {
            // Several columns that nothing separates are none.
            return if symbol.contains(['[', ']']) { None } else { Some(Said::Symbol(symbol)) };
        }
        let spelled = rest.strip_prefix('_')?;
        let others = quantity::units(self.unit, self.absolute).map(|display| display.name);
        std::iter::once(self.unit.name)
            .chain(others)
            .find(|symbol| spell(symbol) == spelled || *symbol == canonical(spelled))
            .map(Said::Symbol)
    }
}

/// Unit given in a header.
enum Said<'a> {
    Nothing,
    Symbol(&'a str),
}

/// A unit as part of a name: `m_per_s` for `m/s`.
fn spell(symbol: &str) -> String {
    symbol.replace('/', "_per_").replace('.', "_").replace(['(', ')'], "")
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The quantity of a header of a record, `-` of an ignored one with its candidates.
    fn meant(header: &str) -> String {
        let time = Column::optional("time", &scene::variables::units::SECOND);
        let columns = Column::record();
        let known: Vec<&Column> = std::iter::once(&time).chain(&columns).collect();
        match find(header, &known) {
            Ok(Match::Known(column, unit) | Match::Meant(column, unit)) => format!("{} {unit}", column.name),
            Ok(Match::Unknown(candidates)) => format!("-{candidates}"),
            Err(told) => told,
        }
    }

    #[test]
    fn names_of_rigs_are_mapped_by_word_and_unit() {
        for (header, name) in [
            ("Time (s)", "time s"),
            ("Friction force [N]", "friction_force N"),
            ("Frictional Force (kN)", "friction_force kN"),
            ("FrictionForce / N", "friction_force N"),
            ("Friction [Nm]", "friction_torque Nm"),
            ("Wear [um]", "wear_depth um"),
            ("wear (µm)", "wear_depth µm"),
            ("Pin wear [mm3]", "wear_volume_punch mm3"),
            ("Temp. [degC]", "contact_temperature degC"),
            ("Temp. [°C]", "contact_temperature °C"),
            ("Disc temp. [°C]", "strip.mean_temperature °C"),
            ("COF", "friction_coefficient 1"),
            ("COF [-]", "friction_coefficient -"),
            ("µ", "friction_coefficient 1"),
            ("Speed [rpm]", "angular_velocity rpm"),
            ("Speed (m/s)", "sliding_velocity m/s"),
            ("Normal Load [N]", "normal_load N"),
            ("Zeit [s]", "time s"),
            ("Date/Time", "time s"),
            ("Datum/Uhrzeit", "time s"),
            ("Versuchszeit (min)", "time min"),
            ("Geschwindigkeit [m/s]", "sliding_velocity m/s"),
            ("Drehzahl [1/min]", "angular_velocity 1/min"),
            ("Normalkraft [kN]", "normal_load kN"),
            ("Anpresskraft [N]", "normal_load N"),
            ("Reibkraft [N]", "friction_force N"),
            ("Reibwert", "friction_coefficient 1"),
            ("Verschlei\u{df} [\u{b5}m]", "wear_depth \u{b5}m"),
            ("Temperatur [\u{b0}C]", "contact_temperature \u{b0}C"),
            ("Belagtemperatur [C]", "punch.mean_temperature C"),
            ("Stiftverschlei\u{df} [mm\u{b3}]", "wear_volume_punch mm\u{b3}"),
            ("Fn [N]", "normal_load N"),
            ("friction_force_kN", "friction_force kN"),
        ] {
            assert_eq!(meant(header), name, "{header}");
        }
    }

    #[test]
    fn what_is_not_sure_is_left_with_its_candidates_and_a_slip_is_refused() {
        assert_eq!(meant("Humidity [%]"), "-");
        assert_eq!(meant("Force [N]"), "- (normal_load or friction_force?)");
        assert_eq!(meant("Bremsdruck [bar]"), "-");
        assert_eq!(meant("Wear [mg]"), "- (wear_mass_punch or wear_mass_strip?)");
        assert_eq!(meant("Load"), "- (with a unit it may be normal_load [N or kN or mN])");
        assert_eq!(meant("ambient_temperature [K]"), "- (a parameter, which the scene sets)");
        assert_eq!(meant("Speed [kph]"), "sliding_velocity kph");
        assert_eq!(meant("Load (lbs)"), "- (\"lbs\" is no known unit of normal_load [N or kN or mN])");
        assert!(meant("Temp. 2 [degC]").starts_with('-'));
        assert!(meant("normal_laod [N]").ends_with("; did you mean normal_load?"), "{}", meant("normal_laod [N]"));
        assert!(meant("wear_dept [um]").contains("did you mean wear_depth?"));
    }
}
