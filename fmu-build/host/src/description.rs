//! The parts of `modelDescription.xml` required to run an FMU: its identity and its variables.

use crate::error::Failure;
use quick_xml::events::{BytesStart, Event};
use quick_xml::{Reader, XmlVersion};
use scene::message::{Clipped, Quoted};
use std::collections::HashMap;

/// Type of a variable.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum Kind {
    /// `fmi2Real`
    Real,
    /// `fmi2Integer`
    Integer,
    /// `fmi2Boolean`: 0 or 1.
    Boolean,
    /// An enumeration: its items, with their numbers. Set and read as `fmi2Integer`.
    Enumeration(Vec<(String, i32)>),
    /// `fmi2String`: can be neither set nor recorded here.
    String,
}

/// Role of a variable.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Causality {
    /// Set once for a run.
    Parameter,
    /// Set at every communication point.
    Input,
    /// Read.
    Output,
    /// Everything else; can be read.
    Other,
}

/// One scalar variable.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Variable {
    /// Its name.
    pub name: String,
    /// Value reference, unique within its type.
    pub reference: u32,
    /// Its type.
    pub kind: Kind,
    /// Its role.
    pub causality: Causality,
    /// Its unit; empty where it has none.
    pub unit: String,
    /// Its start value as the file has it; empty where it has none.
    pub start: String,
}

impl Variable {
    /// A value from text: a number, `true` or `false`, or the name of an enumeration's item.
    pub fn parse(&self, text: &str) -> Result<f64, Failure> {
        let text = text.trim();
        let value = match (&self.kind, text) {
            (Kind::Boolean, "true") => Some(1.0),
            (Kind::Boolean, "false") => Some(0.0),
            (Kind::Enumeration(items), _) => {
                items.iter().find(|(item, _)| item == text).map(|&(_, number)| f64::from(number))
            }
            _ => None,
        };
        value.or_else(|| text.parse().ok()).ok_or_else(|| {
            let wanted = match &self.kind {
                Kind::Enumeration(items) => {
                    format!("one of {}", items.iter().map(|(item, _)| item.as_str()).collect::<Vec<_>>().join(", "))
                }
                Kind::Boolean => "true or false".to_owned(),
                _ => "a number".to_owned(),
            };
            Failure::request(format!("{} = {} is not {wanted}", self.name, Quoted(text)))
        })
    }

    /// The value as a whole number, for the types that are.
    pub(crate) fn whole(&self, value: f64) -> Result<i32, Failure> {
        let (low, high) =
            if self.kind == Kind::Boolean { (0.0, 1.0) } else { (f64::from(i32::MIN), f64::from(i32::MAX)) };
        if value.fract() == 0.0 && (low..=high).contains(&value) {
            Ok(value as i32)
        } else {
            Err(Failure::request(format!("{} = {value} must be a whole number from {low} to {high}", self.name)))
        }
    }
}

/// Identity and variables of an FMU.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Description {
    /// `modelName`
    pub model_name: String,
    /// `guid`: the library must agree to it.
    pub guid: String,
    /// Name of the library, without its ending.
    pub model_identifier: String,
    /// Whether inputs may be given with their derivatives.
    pub takes_input_derivatives: bool,
    /// Communication step of the default experiment, as the file has it; empty where it has none.
    pub step_size: String,
    variables: Vec<Variable>,
    by_name: HashMap<String, usize>,
}

impl Description {
    /// Reads the text of `modelDescription.xml`.
    ///
    /// # Errors
    /// Where it is no XML, not of FMI 2.0, not for co-simulation, or a required attribute is missing.
    pub fn parse(text: &str) -> Result<Self, Failure> {
        let broken = |reason: String| Failure::library(format!("modelDescription.xml: {reason}"));
        let mut description = Self {
            model_name: String::new(),
            guid: String::new(),
            model_identifier: String::new(),
            takes_input_derivatives: false,
            step_size: String::new(),
            variables: Vec::new(),
            by_name: HashMap::new(),
        };
        let mut types: HashMap<String, Vec<(String, i32)>> = HashMap::new();
        let mut current_type = String::new();
        let mut pending: Option<(String, u32, Causality)> = None;
        let mut reader = Reader::from_str(text);
        loop {
            let event = reader.read_event().map_err(|error| broken(error.to_string()))?;
            let element = match &event {
                Event::Start(element) | Event::Empty(element) => element,
                Event::Eof => break,
                _ => continue,
            };
            let attributes = Attributes::of(element).map_err(broken)?;
            match element.name().as_ref() {
                "fmiModelDescription" => {
                    let version = attributes.required("fmiVersion").map_err(broken)?;
                    if version != "2.0" {
                        return Err(broken(format!("fmiVersion is {}, this host runs 2.0", Quoted(&version))));
                    }
                    description.model_name = attributes.required("modelName").map_err(broken)?;
                    description.guid = attributes.required("guid").map_err(broken)?;
                }
                "CoSimulation" => {
                    description.model_identifier = attributes.required("modelIdentifier").map_err(broken)?;
                    description.takes_input_derivatives = attributes.get("canInterpolateInputs") == Some("true");
                }
                "DefaultExperiment" => {
                    description.step_size = attributes.get("stepSize").unwrap_or_default().to_owned();
                }
                "SimpleType" => current_type = attributes.required("name").map_err(broken)?,
                "Item" => {
                    let number = attributes.number("value").map_err(broken)?;
                    let name = attributes.required("name").map_err(broken)?;
                    types.entry(current_type.clone()).or_default().push((name, number));
                }
                "ScalarVariable" => {
                    let causality = match attributes.get("causality") {
                        Some("parameter") => Causality::Parameter,
                        Some("input") => Causality::Input,
                        Some("output") => Causality::Output,
                        _ => Causality::Other,
                    };
                    let name = attributes.required("name").map_err(broken)?;
                    pending = Some((name, attributes.number("valueReference").map_err(broken)?, causality));
                }
                kind => {
                    // A type stands in a SimpleType too, and there it is none of a variable.
                    let kind = match kind {
                        "Real" => Kind::Real,
                        "Integer" => Kind::Integer,
                        "Boolean" => Kind::Boolean,
                        "String" => Kind::String,
                        "Enumeration" => {
                            let declared = attributes.get("declaredType").unwrap_or_default();
                            Kind::Enumeration(types.get(declared).cloned().unwrap_or_default())
                        }
                        _ => continue,
                    };
                    let Some((name, reference, causality)) = pending.take() else { continue };
                    let unit = attributes.get("unit").unwrap_or_default().to_owned();
                    let start = attributes.get("start").unwrap_or_default().to_owned();
                    if description.by_name.insert(name.clone(), description.variables.len()).is_some() {
                        return Err(broken(format!("the variable {name} stands twice")));
                    }
                    description.variables.push(Variable { name, reference, kind, causality, unit, start });
                }
            }
        }
        if description.guid.is_empty() || description.model_identifier.is_empty() {
            return Err(broken("this is no FMU for co-simulation".to_owned()));
        }
        Ok(description)
    }

    /// All variables, in the order of the file.
    pub fn variables(&self) -> &[Variable] {
        &self.variables
    }

    /// The variable of this name.
    ///
    /// # Errors
    /// Where there is none; the message names the closest.
    pub fn find(&self, name: &str) -> Result<&Variable, Failure> {
        if let Some(&index) = self.by_name.get(name) {
            return Ok(&self.variables[index]);
        }
        let most = 2.max(name.len() / 4);
        let away = |known: &str| match known.strip_suffix(name) {
            // The right name without its component.
            Some(component) if component.ends_with('.') => 1,
            // Nothing is nearer than the lengths are apart; a name may be of any length.
            _ if known.len().abs_diff(name.len()) > most => usize::MAX,
            _ => strsim::levenshtein(name, known),
        };
        let closest = self.variables.iter().map(|variable| (away(&variable.name), &variable.name)).min();
        let hint = match closest {
            Some((away, closest)) if away <= most => format!("; did you mean {closest}?"),
            _ => String::new(),
        };
        Err(Failure::request(format!("{} has no variable {}{hint}", self.model_name, Quoted(name))))
    }

    /// The variable of this name where it has this role.
    ///
    /// # Errors
    /// As [`Self::find`], and where the role is another.
    pub fn find_as(&self, name: &str, causality: Causality) -> Result<&Variable, Failure> {
        let variable = self.find(name)?;
        if variable.causality == causality {
            return Ok(variable);
        }
        let role = match causality {
            Causality::Parameter => "parameter",
            Causality::Input => "input",
            Causality::Output => "output",
            Causality::Other => "local variable",
        };
        Err(Failure::request(format!("{} is no {role} of {}", Clipped(name), self.model_name)))
    }
}

struct Attributes(Vec<(String, String)>);

impl Attributes {
    fn of(element: &BytesStart) -> Result<Self, String> {
        let mut attributes = Vec::new();
        for attribute in element.attributes() {
            let attribute = attribute.map_err(|error| error.to_string())?;
            let value = attribute.normalized_value(XmlVersion::Explicit1_0).map_err(|error| error.to_string())?;
            attributes.push((attribute.key.as_ref().to_owned(), value.into_owned()));
        }
        Ok(Self(attributes))
    }

    fn get(&self, name: &str) -> Option<&str> {
        self.0.iter().find(|(key, _)| key == name).map(|(_, value)| value.as_str())
    }

    fn required(&self, name: &str) -> Result<String, String> {
        self.get(name).map(str::to_owned).ok_or_else(|| format!("the attribute {name} is missing"))
    }

    fn number<T: std::str::FromStr>(&self, name: &str) -> Result<T, String> {
        let text = self.required(name)?;
        text.parse().map_err(|_| format!("{name} = {} is no number", Quoted(&text)))
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    pub(crate) const BRAKE: &str = r#"<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="2.0" modelName="Contact.brake" guid="{1-2}">
  <CoSimulation modelIdentifier="Contact" canInterpolateInputs="true"/>
  <TypeDefinitions>
    <SimpleType name="Level"><Enumeration><Item name="auto" value="1"/><Item name="lumped" value="2"/></Enumeration></SimpleType>
  </TypeDefinitions>
  <ModelVariables>
    <ScalarVariable name="sliding_velocity" valueReference="0" causality="input"><Real unit="m/s" start="0"/></ScalarVariable>
    <ScalarVariable name="punch.width" valueReference="7" causality="parameter"><Real unit="m" start="0.1"/></ScalarVariable>
    <ScalarVariable name="level" valueReference="3" causality="parameter"><Enumeration declaredType="Level" start="1"/></ScalarVariable>
    <ScalarVariable name="faces" valueReference="4" causality="parameter"><Integer start="1"/></ScalarVariable>
    <ScalarVariable name="coupled" valueReference="5" causality="parameter"><Boolean start="true"/></ScalarVariable>
    <ScalarVariable name="wear" valueReference="9" causality="output"><Real unit="m"/></ScalarVariable>
  </ModelVariables>
</fmiModelDescription>"#;

    #[test]
    fn variables_are_read_with_their_roles_and_units() {
        let description = Description::parse(BRAKE).unwrap();
        assert_eq!((description.guid.as_str(), description.model_identifier.as_str()), ("{1-2}", "Contact"));
        assert!(description.takes_input_derivatives);
        assert_eq!(description.variables().len(), 6);
        let width = description.find_as("punch.width", Causality::Parameter).unwrap();
        assert_eq!((width.reference, &width.kind, width.unit.as_str()), (7, &Kind::Real, "m"));
        assert_eq!((width.start.as_str(), description.find("wear").unwrap().start.as_str()), ("0.1", ""));
        let level = description.find("level").unwrap();
        assert_eq!(level.kind, Kind::Enumeration(vec![("auto".into(), 1), ("lumped".into(), 2)]));
    }

    #[test]
    fn values_are_read_as_their_type_asks() {
        let description = Description::parse(BRAKE).unwrap();
        let parse = |name: &str, text: &str| description.find(name).unwrap().parse(text);
        assert_eq!(parse("level", " lumped ").unwrap(), 2.0);
        assert_eq!(parse("level", "1").unwrap(), 1.0);
        assert_eq!(parse("coupled", "false").unwrap(), 0.0);
        assert_eq!(parse("punch.width", "9.5e-2").unwrap(), 0.095);
        assert!(parse("level", "line").unwrap_err().reason.contains("one of auto, lumped"));
        assert!(parse("punch.width", "wide").unwrap_err().reason.contains("punch.width = \"wide\""));
        let whole = |name: &str, value: f64| description.find(name).unwrap().whole(value);
        assert_eq!(whole("faces", 2.0).unwrap(), 2);
        assert!(whole("faces", 2.5).unwrap_err().reason.contains("faces = 2.5"));
        assert!(whole("faces", f64::NAN).is_err());
        assert!(whole("coupled", 2.0).is_err());
    }

    #[test]
    fn a_wrong_name_or_role_is_told() {
        let description = Description::parse(BRAKE).unwrap();
        let unknown = description.find("punch.widht").unwrap_err().reason;
        assert!(unknown.contains("did you mean punch.width?"), "{unknown}");
        assert!(!description.find("temperature_of_the_moon").unwrap_err().reason.contains("did you mean"));
        assert!(description.find_as("wear", Causality::Parameter).unwrap_err().reason.contains("no parameter"));
    }

    #[test]
    fn what_is_no_co_simulation_fmu_is_refused() {
        let reason = |text: &str| Description::parse(text).unwrap_err().reason;
        assert!(reason(&BRAKE.replace("fmiVersion=\"2.0\"", "fmiVersion=\"3.0\"")).contains("\"3.0\""));
        assert!(reason(&BRAKE.replace("CoSimulation", "ModelExchange")).contains("no FMU for co-simulation"));
        assert!(reason(&BRAKE.replace("valueReference=\"7\"", "valueReference=\"seven\"")).contains("seven"));
        assert!(reason(&BRAKE.replace("name=\"faces\"", "name=\"level\"")).contains("twice"));
        assert!(reason("<fmiModelDescription").contains("modelDescription.xml"));
    }
}
