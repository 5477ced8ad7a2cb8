//! A scene as an SSP parameter set (System Structure Parameter Values 1.0), for the stock FMU.

use scene::variables::units::{UNITS, Unit};
use scene::variables::{Kind, lookup};
use scene_file::SceneFile;

use crate::description::{SUMMARY, enumerations};
use crate::xml::{Xml, number, text};

/// Writes what the scene sets; everything else keeps the start value of the stock FMU.
pub fn write(scene: &SceneFile) -> String {
    let mut xml = Xml::new();
    xml.open(
        "ssv:ParameterSet",
        &[
            text("xmlns:ssv", "http://ssp-standard.org/SSP1/SystemStructureParameterValues"),
            text("xmlns:ssc", "http://ssp-standard.org/SSP1/SystemStructureCommon"),
            text("version", "1.0"),
            text("name", &scene.packaged.name),
            text("description", if scene.description.is_empty() { SUMMARY } else { &scene.description }),
            text("generationTool", concat!("fmu-build ", env!("CARGO_PKG_VERSION"))),
        ],
    );
    xml.open("ssv:Parameters", &[]);
    let mut used_units: Vec<&str> = Vec::new();
    let mut used_types: Vec<&str> = Vec::new();
    for &reference in &scene.given {
        let (row, element) = lookup(reference).expect("a scene file sets existing variables only");
        let value = scene.packaged.starts[reference as usize];
        xml.open("ssv:Parameter", &[text("name", &row.element_name(element))]);
        let shown = number(value);
        match row.kind {
            Kind::Real { unit, .. } => {
                used_units.push(unit.name);
                xml.empty("ssv:Real", &[text("value", &shown), text("unit", unit.name)]);
            }
            Kind::Integer { .. } => xml.empty("ssv:Integer", &[text("value", &shown)]),
            Kind::Boolean => {
                xml.empty("ssv:Boolean", &[text("value", if value == 0.0 { "false" } else { "true" })]);
            }
            Kind::Enumeration(kind) => {
                used_types.push(kind.name);
                let item = kind.items[value as usize - 1].0;
                xml.empty("ssv:Enumeration", &[text("value", item), text("name", kind.name)]);
            }
        }
        xml.close();
    }
    xml.close();
    if !used_types.is_empty() {
        xml.open("ssv:Enumerations", &[]);
        for kind in enumerations().into_iter().filter(|kind| used_types.contains(&kind.name)) {
            xml.open("ssc:Enumeration", &[text("name", kind.name)]);
            for (index, (item, _)) in kind.items.iter().enumerate() {
                xml.empty("ssc:Item", &[text("name", item), text("value", &(index + 1).to_string())]);
            }
            xml.close();
        }
        xml.close();
    }
    if !used_units.is_empty() {
        xml.open("ssv:Units", &[]);
        for unit in UNITS.iter().filter(|unit| used_units.contains(&unit.name)) {
            unit_definition(&mut xml, unit);
        }
        xml.close();
    }
    xml.close();
    xml.finish()
}

fn unit_definition(xml: &mut Xml, unit: &Unit) {
    xml.open("ssc:Unit", &[text("name", unit.name)]);
    let exponents = [("kg", unit.kg), ("m", unit.m), ("s", unit.s), ("K", unit.kelvin), ("rad", unit.rad)];
    let used: Vec<_> = exponents
        .into_iter()
        .filter(|&(_, exponent)| exponent != 0)
        .map(|(name, exponent)| (name, exponent.to_string().into()))
        .collect();
    xml.empty("ssc:BaseUnit", &used);
    xml.close();
}

#[cfg(test)]
mod tests {
    use quick_xml::Reader;
    use quick_xml::events::Event;

    use super::*;

    #[test]
    fn what_the_scene_sets_is_in_the_set_and_nothing_else() {
        let scene = scene_file::parse(
            "name = \"bench\"\npunch.width = \"60 mm\"\ncontact.faces = 3\ncontact.shear_coupling = false\n\
             strip.path = \"straight\"\ncontact.friction_fade.factor = [1, 1, 1, 1, 1, 1, 1, 0.25]",
        )
        .unwrap();
        let xml = write(&scene);
        let mut reader = Reader::from_str(&xml);
        let (mut name, mut values) = (String::new(), Vec::new());
        loop {
            match reader.read_event().unwrap() {
                Event::Start(element) | Event::Empty(element) => {
                    let attribute = |wanted: &str| {
                        let found = element.try_get_attribute(wanted).unwrap();
                        found.map(|attribute| {
                            attribute.normalized_value(quick_xml::XmlVersion::Explicit1_0).unwrap().into_owned()
                        })
                    };
                    match element.name().as_ref() {
                        "ssv:Parameter" => name = attribute("name").unwrap(),
                        "ssv:Real" | "ssv:Integer" | "ssv:Boolean" | "ssv:Enumeration" => {
                            values.push((name.clone(), attribute("value").unwrap()));
                        }
                        _ => {}
                    }
                }
                Event::Eof => break,
                _ => {}
            }
        }
        let find = |wanted: &str| values.iter().find(|(name, _)| name == wanted).map(|(_, value)| value.as_str());
        assert_eq!(values.len(), 12);
        assert_eq!(find("punch.width"), Some("0.06"));
        assert_eq!(find("contact.faces"), Some("3"));
        assert_eq!(find("contact.shear_coupling"), Some("false"));
        assert_eq!(find("strip.path"), Some("straight"));
        assert_eq!(find("contact.friction_fade.factor[8]"), Some("0.25"));
        assert!(xml.contains("<ssc:Unit name=\"m\">") && !xml.contains("<ssc:Unit name=\"K\">"));
        assert!(xml.contains("<ssc:Enumeration name=\"Path\">") && !xml.contains("name=\"Scheme\""));
    }
}
