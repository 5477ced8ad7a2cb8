//! terminalsAndIcons.xml: groups of inputs and outputs, for tools that connect by terminals.
//!
//! The format is that of FMI 3.0, which keeps the same folder and which importers read from FMI 2.0 files too.

use crate::xml::{Xml, numeric, text};

/// A group of variables that connect to the same neighbouring model.
struct Terminal {
    name: &'static str,
    description: &'static str,
    /// Name within the terminal and of the variable.
    members: &'static [(&'static str, &'static str)],
    /// Middle of its icon on the model's, which spans -100 to 100 in both directions.
    at: (f64, f64),
}

const TERMINALS: [Terminal; 6] = [
    Terminal {
        name: "sliding",
        description: "Body that slides: velocity in, friction force out",
        members: &[("v", "sliding_velocity"), ("f", "friction_force")],
        at: (-100.0, 0.0),
    },
    Terminal {
        name: "rotation",
        description: "Shaft that turns: angular velocity in, friction torque out",
        members: &[("w", "angular_velocity"), ("tau", "friction_torque")],
        at: (100.0, 0.0),
    },
    Terminal {
        name: "actuator",
        description: "What presses the bodies together: load in, approach out",
        members: &[("f", "normal_load"), ("s", "approach")],
        at: (0.0, 100.0),
    },
    Terminal {
        name: "air",
        description: "Ambient air: temperature and speed in, heat flow out",
        members: &[("dT", "ambient_temperature_offset"), ("v", "cooling_velocity"), ("Q_flow", "heat_flow_ambient")],
        at: (-60.0, 100.0),
    },
    Terminal {
        name: "punch_top",
        description: "Neighbour at the punch's top: temperature in, heat flow out",
        members: &[("T", "punch.external_temperature"), ("Q_flow", "heat_flow_punch_external")],
        at: (60.0, 100.0),
    },
    Terminal {
        name: "strip_base",
        description: "Neighbour at the strip's base: temperature in, heat flow out",
        members: &[("T", "strip.external_temperature"), ("Q_flow", "heat_flow_strip_external")],
        at: (0.0, -100.0),
    },
];

pub(crate) fn write() -> String {
    let mut xml = Xml::new();
    xml.open("fmiTerminalsAndIcons", &[text("fmiVersion", "3.0")]);
    xml.open("GraphicalRepresentation", &[]);
    let corners = corners((0.0, 0.0), 100.0);
    let mut coordinates = corners.to_vec();
    coordinates.push(numeric("suggestedScalingFactorTo_mm", 0.1));
    xml.empty("CoordinateSystem", &coordinates);
    xml.empty("Icon", &corners);
    xml.close();
    xml.open("Terminals", &[]);
    for terminal in &TERMINALS {
        xml.open(
            "Terminal",
            &[text("name", terminal.name), text("matchingRule", "plug"), text("description", terminal.description)],
        );
        for (member, variable) in terminal.members {
            let attributes =
                [text("variableName", variable), text("memberName", member), text("variableKind", "signal")];
            xml.empty("TerminalMemberVariable", &attributes);
        }
        let mut attributes = vec![text("iconBaseName", "terminal"), text("defaultConnectionColor", "21 101 192")];
        attributes.extend(self::corners(terminal.at, 10.0));
        xml.empty("TerminalGraphicalRepresentation", &attributes);
        xml.close();
    }
    xml.close();
    xml.close();
    xml.finish()
}

/// Lower left and upper right corner of a square.
fn corners((x, y): (f64, f64), half: f64) -> [crate::xml::Attribute<'static>; 4] {
    [numeric("x1", x - half), numeric("y1", y - half), numeric("x2", x + half), numeric("y2", y + half)]
}

#[cfg(test)]
mod tests {
    use scene::variables::{Causality, TABLE, find, lookup};

    use super::*;

    #[test]
    fn every_member_is_an_input_or_output_and_every_input_has_a_terminal() {
        let members: Vec<&str> =
            TERMINALS.iter().flat_map(|terminal| terminal.members.iter().map(|member| member.1)).collect();
        for name in &members {
            let row = lookup(find(name).expect(name)).unwrap().0;
            assert!(matches!(row.causality, Causality::Input | Causality::Output), "{name}");
        }
        for row in TABLE.iter().filter(|row| row.causality == Causality::Input) {
            let uses = members.iter().filter(|&&name| name == row.name).count();
            assert_eq!(uses, 1, "{} must stand in one terminal", row.name);
        }
    }
}
