//! modelDescription.xml of a scene, made from the variable table.

use scene::slot::Packaged;
use scene::variables::types::{RealType, TYPES};
use scene::variables::units::{UNITS, Unit};
use scene::variables::{
    COUNT, Causality, Depends, EnumerationType, Initial, Kind, OUTPUT_DERIVATIVE_ORDER, Row, TABLE, ValueReference,
    Variability, lookup,
};

use crate::xml::{Attribute, Xml, number, numeric, text};

/// FMI model identifier: the name of the library, and of everything else that must not change with the scene.
pub const MODEL_IDENTIFIER: &str = "SlidingContact";

pub(crate) const SUMMARY: &str = "Wear, heat and friction in a sliding contact of a punch on a strip";

/// Authors, as the licences name them.
const AUTHOR: &str = "The sliding-contact authors";

/// Line of the licences.
pub(crate) const COPYRIGHT: &str = "Copyright (c) 2026 The sliding-contact authors";

/// Categories under which the library logs; it uses no others.
const LOG_CATEGORIES: [(&str, &str); 3] = [
    ("logStatusWarning", "Conditions that do not end the simulation"),
    ("logStatusError", "Reasons of refused or failed calls"),
    ("logEvents", "Choices made at initialisation, limits reached, changes of the contact"),
];

/// Capabilities of the library beyond the standard's defaults. `canNotUseMemoryManagementFunctions` says that it
/// allocates by itself and ignores the importer's callbacks for that.
const CAPABILITIES: [&str; 6] = [
    "canHandleVariableCommunicationStepSize",
    "canInterpolateInputs",
    "canNotUseMemoryManagementFunctions",
    "canGetAndSetFMUstate",
    "canSerializeFMUstate",
    "providesDirectionalDerivative",
];

/// Writes the model description of a scene.
pub fn write(scene: &Packaged, description: &str) -> String {
    let mut xml = Xml::new();
    let model_name = format!("{MODEL_IDENTIFIER}.{}", scene.name);
    let guid = scene.guid();
    xml.open(
        "fmiModelDescription",
        &[
            text("fmiVersion", "2.0"),
            text("modelName", &model_name),
            text("guid", &guid),
            text("description", if description.is_empty() { SUMMARY } else { description }),
            text("author", AUTHOR),
            text("version", env!("CARGO_PKG_VERSION")),
            text("copyright", COPYRIGHT),
            text("license", env!("CARGO_PKG_LICENSE")),
            text("generationTool", concat!("fmu-build ", env!("CARGO_PKG_VERSION"))),
            text("variableNamingConvention", "structured"),
            text("numberOfEventIndicators", "0"),
        ],
    );
    let mut attributes = vec![text("modelIdentifier", MODEL_IDENTIFIER)];
    attributes.extend(CAPABILITIES.map(|name| text(name, "true")));
    let order = OUTPUT_DERIVATIVE_ORDER.to_string();
    attributes.push(text("maxOutputDerivativeOrder", &order));
    xml.empty("CoSimulation", &attributes);
    units(&mut xml);
    types(&mut xml);
    xml.open("LogCategories", &[]);
    for (name, description) in LOG_CATEGORIES {
        xml.empty("Category", &[text("name", name), text("description", description)]);
    }
    xml.close();
    let experiment = scene.experiment;
    xml.empty(
        "DefaultExperiment",
        &[
            numeric("startTime", experiment.start),
            numeric("stopTime", experiment.stop),
            numeric("tolerance", experiment.tolerance),
            numeric("stepSize", experiment.step),
        ],
    );
    xml.open("ModelVariables", &[]);
    for (reference, &start) in scene.starts.iter().enumerate() {
        variable(&mut xml, reference as ValueReference, start);
    }
    xml.close();
    structure(&mut xml);
    xml.close();
    xml.finish()
}

fn units(xml: &mut Xml) {
    xml.open("UnitDefinitions", &[]);
    for unit in UNITS {
        unit_definition(xml, unit);
    }
    xml.close();
}

fn unit_definition(xml: &mut Xml, unit: &Unit) {
    xml.open("Unit", &[text("name", unit.name)]);
    let exponents = [("kg", unit.kg), ("m", unit.m), ("s", unit.s), ("K", unit.kelvin), ("rad", unit.rad)]
        .map(|(name, exponent)| (name, exponent.to_string().into()));
    let used: Vec<Attribute> = exponents.into_iter().filter(|(_, exponent)| exponent != "0").collect();
    xml.empty("BaseUnit", &used);
    for display in unit.display {
        let mut attributes = vec![text("name", display.name), numeric("factor", display.factor)];
        if display.offset != 0.0 {
            attributes.push(numeric("offset", display.offset));
        }
        xml.empty("DisplayUnit", &attributes);
    }
    xml.close();
}

/// The enumerations of the table in the order of their first use.
pub(crate) fn enumerations() -> Vec<&'static EnumerationType> {
    let mut found: Vec<&'static EnumerationType> = Vec::new();
    for row in TABLE {
        if let Kind::Enumeration(kind) = row.kind
            && !found.iter().any(|known| known.name == kind.name)
        {
            found.push(kind);
        }
    }
    found
}

fn types(xml: &mut Xml) {
    xml.open("TypeDefinitions", &[]);
    let used = |kind: &&RealType| TABLE.iter().filter_map(Row::real_type).any(|other| other.name == kind.name);
    for kind in TYPES.iter().filter(used) {
        xml.open("SimpleType", &[text("name", kind.name)]);
        let mut attributes = Vec::new();
        if !kind.quantity.is_empty() {
            attributes.push(text("quantity", kind.quantity));
        }
        attributes.push(text("unit", kind.unit.name));
        if !kind.display.is_empty() {
            attributes.push(text("displayUnit", kind.display));
        }
        if kind.is_difference {
            attributes.push(text("relativeQuantity", "true"));
        }
        xml.empty("Real", &attributes);
        xml.close();
    }
    for kind in enumerations() {
        xml.open("SimpleType", &[text("name", kind.name), text("description", kind.description)]);
        xml.open("Enumeration", &[]);
        for (index, (name, description)) in kind.items.iter().enumerate() {
            let value = (index + 1).to_string();
            xml.empty("Item", &[text("name", name), text("value", &value), text("description", description)]);
        }
        xml.close();
        xml.close();
    }
    xml.close();
}

fn variable(xml: &mut Xml, reference: ValueReference, start: f64) {
    let (row, element) = lookup(reference).expect("every reference below COUNT has a row");
    let name = row.element_name(element);
    let value_reference = reference.to_string();
    let mut attributes = vec![
        text("name", &name),
        text("valueReference", &value_reference),
        text("description", row.description),
        text("causality", causality(row)),
        text("variability", variability(row)),
    ];
    match row.initial {
        Some(Initial::Exact) => attributes.push(text("initial", "exact")),
        Some(Initial::Calculated) => attributes.push(text("initial", "calculated")),
        None => {}
    }
    xml.open("ScalarVariable", &attributes);
    let (kind, mut attributes) = type_attributes(row);
    if row.start_of(element).is_some() {
        let start = if matches!(row.kind, Kind::Boolean) { (start != 0.0).to_string() } else { number(start) };
        attributes.push(("start", start.into()));
    }
    xml.empty(kind, &attributes);
    xml.close();
}

fn type_attributes(row: &Row) -> (&'static str, Vec<Attribute<'static>>) {
    let mut attributes = Vec::new();
    let kind = match row.kind {
        Kind::Real { unit, display, nominal, .. } => {
            attributes.extend(row.real_type().map(|kind| text("declaredType", kind.name)));
            attributes.push(text("unit", unit.name));
            if !display.is_empty() {
                attributes.push(text("displayUnit", display));
            }
            if row.is_difference() {
                attributes.push(text("relativeQuantity", "true"));
            }
            attributes.push(numeric("nominal", nominal));
            "Real"
        }
        Kind::Integer { .. } => "Integer",
        Kind::Boolean => return ("Boolean", attributes),
        Kind::Enumeration(kind) => {
            attributes.push(text("declaredType", kind.name));
            "Enumeration"
        }
    };
    let (min, max) = row.bounds();
    attributes.extend(min.map(|min| numeric("min", min)));
    attributes.extend(max.map(|max| numeric("max", max)));
    (kind, attributes)
}

/// Causality as the standard spells it.
pub(crate) fn causality(row: &Row) -> &'static str {
    match row.causality {
        Causality::Parameter => "parameter",
        Causality::Input => "input",
        Causality::Output => "output",
        Causality::Local => "local",
    }
}

/// Variability as the standard spells it.
pub(crate) fn variability(row: &Row) -> &'static str {
    match row.variability {
        Variability::Fixed => "fixed",
        Variability::Tunable => "tunable",
        Variability::Discrete => "discrete",
        Variability::Continuous => "continuous",
    }
}

/// Whether an output is an integral or a worn depth, which is 0 when initialisation ends whatever is set.
fn starts_at_zero(row: &Row) -> bool {
    matches!(row.depends, Depends::OnStates)
        && matches!(row.kind, Kind::Real { unit, .. } if unit.name != "K" && unit.name != "1")
}

/// Outputs with their dependencies. At a communication point these are the inputs, at frozen states. In
/// initialisation mode the states themselves follow from the parameters and the inputs.
fn structure(xml: &mut Xml) {
    let indices = |wanted: &[Causality]| {
        (0..COUNT as ValueReference)
            .filter(|&reference| lookup(reference).is_some_and(|(row, _)| wanted.contains(&row.causality)))
            .map(|reference| (reference + 1).to_string())
            .collect::<Vec<_>>()
    };
    let outputs = indices(&[Causality::Output]);
    let inputs = indices(&[Causality::Input]).join(" ");
    let knowns = indices(&[Causality::Input, Causality::Parameter]).join(" ");
    let row_of = |index: &String| {
        let reference = index.parse::<ValueReference>().expect("made from a number") - 1;
        lookup(reference).expect("made from a reference").0
    };
    xml.open("ModelStructure", &[]);
    xml.open("Outputs", &[]);
    for index in &outputs {
        let dependencies = if row_of(index).depends == Depends::OnInputs { inputs.as_str() } else { "" };
        xml.empty("Unknown", &[text("index", index), text("dependencies", dependencies)]);
    }
    xml.close();
    xml.open("InitialUnknowns", &[]);
    for index in &outputs {
        let dependencies = if starts_at_zero(row_of(index)) { "" } else { knowns.as_str() };
        xml.empty("Unknown", &[text("index", index), text("dependencies", dependencies)]);
    }
    xml.close();
    xml.close();
}

#[cfg(test)]
mod tests {
    use std::collections::HashMap;

    use quick_xml::Reader;
    use quick_xml::events::{BytesStart, Event};

    use super::*;

    /// Every element in the order of the file: name and attributes.
    fn elements(xml: &str) -> Vec<(String, HashMap<String, String>)> {
        let mut reader = Reader::from_str(xml);
        let mut found = Vec::new();
        let read = |element: &BytesStart| {
            let attributes = element.attributes().map(|attribute| {
                let attribute = attribute.unwrap();
                let value = attribute.normalized_value(quick_xml::XmlVersion::Explicit1_0).unwrap();
                (attribute.key.as_ref().to_owned(), value.into_owned())
            });
            (element.name().as_ref().to_owned(), attributes.collect())
        };
        loop {
            match reader.read_event().unwrap() {
                Event::Start(element) | Event::Empty(element) => found.push(read(&element)),
                Event::Eof => return found,
                _ => {}
            }
        }
    }

    #[test]
    fn every_row_is_there_in_order_with_its_start() {
        let mut scene = Packaged::stock();
        for (reference, start) in scene.starts.iter_mut().enumerate() {
            if matches!(lookup(reference as u32).unwrap().0.kind, Kind::Real { .. }) {
                *start = reference as f64 / 7.0;
            }
        }
        let elements = elements(&write(&scene, ""));
        let variables: Vec<usize> = (0..elements.len()).filter(|&at| elements[at].0 == "ScalarVariable").collect();
        assert_eq!(variables.len(), COUNT);
        for (reference, at) in variables.into_iter().enumerate() {
            let (row, element) = lookup(reference as u32).unwrap();
            let attributes = &elements[at].1;
            assert_eq!(attributes["name"], row.element_name(element));
            assert_eq!(attributes["valueReference"], reference.to_string());
            assert_eq!(attributes["description"], row.description);
            let (kind, attributes) = &elements[at + 1];
            let start = attributes.get("start");
            assert_eq!(start.is_some(), row.start_of(element).is_some(), "{}", row.name);
            match row.kind {
                Kind::Real { unit, .. } => {
                    assert_eq!((kind.as_str(), attributes["unit"].as_str()), ("Real", unit.name));
                    assert_eq!(attributes["declaredType"], row.real_type().unwrap().name);
                    let absolute = unit.name == "K" && !row.is_difference();
                    assert!(!absolute || attributes["displayUnit"] == "degC", "{}", row.name);
                    if let Some(start) = start {
                        assert_eq!(start.parse(), Ok(scene.starts[reference]), "{}", row.name);
                    }
                }
                Kind::Integer { .. } => assert_eq!(kind, "Integer"),
                Kind::Boolean => {
                    assert_eq!(kind, "Boolean");
                    assert!(start.is_none_or(|start| start == "true" || start == "false"));
                }
                Kind::Enumeration(of) => {
                    assert_eq!((kind.as_str(), attributes["declaredType"].as_str()), ("Enumeration", of.name));
                }
            }
        }
    }

    #[test]
    fn every_declared_type_is_defined_with_the_unit_of_its_variables() {
        let elements = elements(&write(&Packaged::stock(), ""));
        let unit_of = |name: &str| {
            let at =
                elements.iter().position(|element| element.0 == "SimpleType" && element.1["name"] == name).unwrap();
            assert_eq!(elements[at + 1].0, "Real", "{name}");
            elements[at + 1].1["unit"].clone()
        };
        let mut seen = 0;
        for (kind, attributes) in &elements {
            if kind == "Real" && attributes.contains_key("declaredType") {
                assert_eq!(unit_of(&attributes["declaredType"]), attributes["unit"]);
                seen += 1;
            }
        }
        assert!(seen > 100);
        assert_eq!(unit_of("Temperature"), "K");
        let root = &elements[0].1;
        assert!(root.contains_key("author") && root.contains_key("copyright") && root.contains_key("license"));
    }

    #[test]
    fn the_structure_lists_outputs_ascending_and_never_a_local() {
        let elements = elements(&write(&Packaged::stock(), ""));
        let at = |name: &str| elements.iter().position(|element| element.0 == name).unwrap();
        let indices = |from: usize, to: usize| {
            elements[from + 1..to].iter().map(|element| element.1["index"].parse::<u32>().unwrap()).collect::<Vec<_>>()
        };
        let outputs = indices(at("Outputs"), at("InitialUnknowns"));
        assert_eq!(outputs, indices(at("InitialUnknowns"), elements.len()));
        assert!(outputs.is_sorted_by(|one, next| one < next));
        let expected =
            (0..COUNT as u32).filter(|&reference| lookup(reference).unwrap().0.causality == Causality::Output);
        assert_eq!(outputs, expected.map(|reference| reference + 1).collect::<Vec<_>>());
        let dependencies = |from: usize, name: &str| {
            let index = (scene::variables::find(name).unwrap() + 1).to_string();
            elements[from..].iter().find(|element| element.1.get("index") == Some(&index)).unwrap().1["dependencies"]
                .clone()
        };
        assert_eq!(dependencies(at("Outputs"), "friction_force"), "1 2 3 4 5 6 7");
        assert_eq!(dependencies(at("Outputs"), "strip.mean_temperature"), "");
        assert_eq!(dependencies(at("InitialUnknowns"), "wear_depth"), "");
        assert!(dependencies(at("InitialUnknowns"), "strip.mean_temperature").starts_with("1 2 3 4 5 6 7 "));
    }

    #[test]
    fn the_committed_model_description_is_up_to_date() {
        let path = crate::root().join("modelDescription/modelDescription.xml");
        let committed = std::fs::read_to_string(&path).unwrap();
        assert!(
            committed == write(&Packaged::stock(), ""),
            "{} is not what the variable table says; run `cargo fmu package --write-description`",
            path.display()
        );
    }
}
