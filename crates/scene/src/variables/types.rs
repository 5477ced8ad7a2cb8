//! Types of the Real variables, named and with the quantities of Modelica.Units.SI wherever that has them.

use super::check::same;
use super::units::*;

/// A type of Real variables.
#[derive(Debug)]
pub struct RealType {
    /// Name, as it stands in the XML.
    pub name: &'static str,
    /// Physical quantity, as in Modelica; empty: none.
    pub quantity: &'static str,
    /// Unit of every variable of the type.
    pub unit: &'static Unit,
    /// Display unit of variables that choose none; empty: none.
    pub display: &'static str,
    /// Whether the value is a difference, to which the offset of a display unit must not be applied.
    pub is_difference: bool,
}

const fn named(name: &'static str, unit: &'static Unit) -> RealType {
    RealType { name, quantity: name, unit, display: "", is_difference: false }
}

const fn of(name: &'static str, quantity: &'static str, unit: &'static Unit) -> RealType {
    RealType { quantity, ..named(name, unit) }
}

/// Every type. The first of a unit is that of variables which name none.
pub static TYPES: &[RealType] = &[
    of("DimensionlessRatio", "", &ONE),
    named("CoefficientOfFriction", &ONE),
    of("PoissonNumber", "PoissonNumber", &ONE),
    named("Emissivity", &ONE),
    named("Length", &METRE),
    of("Distance", "Length", &METRE),
    of("Position", "Length", &METRE),
    named("Area", &SQUARE_METRE),
    named("Volume", &CUBIC_METRE),
    named("Time", &SECOND),
    named("Velocity", &METRE_PER_SECOND),
    named("Angle", &RADIAN),
    named("AngularVelocity", &RADIAN_PER_SECOND),
    named("Force", &NEWTON),
    named("Torque", &NEWTON_METRE),
    named("TranslationalSpringConstant", &NEWTON_PER_METRE),
    named("TranslationalDampingConstant", &NEWTON_SECOND_PER_METRE),
    named("Pressure", &PASCAL),
    of("ModulusOfElasticity", "Stress", &PASCAL),
    of("FoundationModulus", "", &PASCAL_PER_METRE),
    of("WearCoefficient", "", &SQUARE_METRE_PER_NEWTON),
    RealType { display: "degC", ..of("Temperature", "ThermodynamicTemperature", &KELVIN) },
    RealType { is_difference: true, ..of("TemperatureDifference", "ThermodynamicTemperature", &KELVIN) },
    named("LinearExpansionCoefficient", &PER_KELVIN),
    named("Energy", &JOULE),
    of("Heat", "Energy", &JOULE),
    of("HeatFlowRate", "Power", &WATT),
    named("Power", &WATT),
    named("ThermalConductivity", &CONDUCTIVITY),
    named("CoefficientOfHeatTransfer", &HEAT_TRANSFER),
    named("ThermalConductance", &CONDUCTANCE),
    named("SpecificHeatCapacity", &SPECIFIC_HEAT),
    named("Density", &DENSITY),
    named("Mass", &KILOGRAM),
];

/// The type of this name, or the first with this unit where the name is empty; `None` where there is none of this unit.
pub(crate) const fn find(name: &str, unit: &Unit) -> Option<&'static RealType> {
    let mut index = 0;
    while index < TYPES.len() {
        let known = &TYPES[index];
        if same(known.unit.name, unit.name) && (name.is_empty() || same(known.name, name)) {
            return Some(known);
        }
        index += 1;
    }
    None
}

/// Display unit of the type that [`find`] returns; empty: none.
pub(crate) const fn display(name: &str, unit: &Unit) -> &'static str {
    match find(name, unit) {
        Some(kind) => kind.display,
        None => "",
    }
}
