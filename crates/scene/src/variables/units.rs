//! Units of the interface: SI base exponents and display units.

/// A unit another is shown in: `shown = factor * value + offset`, `value` in the SI unit.
#[derive(Debug)]
pub struct DisplayUnit {
    /// Modelica spelling.
    pub name: &'static str,
    /// Multiplier from the SI unit.
    pub factor: f64,
    /// Added after the multiplication.
    pub offset: f64,
}

/// A unit in Modelica spelling with the exponents of the SI base units.
#[derive(Debug)]
pub struct Unit {
    /// Modelica spelling, such as `W/(m2.K)`; `1` for dimensionless.
    pub name: &'static str,
    /// Exponent of kg.
    pub kg: i8,
    /// Exponent of m.
    pub m: i8,
    /// Exponent of s.
    pub s: i8,
    /// Exponent of K.
    pub kelvin: i8,
    /// Exponent of rad.
    pub rad: i8,
    /// Display units, also accepted in a scene file.
    pub display: &'static [DisplayUnit],
}

const fn shown(name: &'static str, factor: f64) -> DisplayUnit {
    DisplayUnit { name, factor, offset: 0.0 }
}

const fn unit(name: &'static str, base: [i8; 5], display: &'static [DisplayUnit]) -> Unit {
    let [kg, m, s, kelvin, rad] = base;
    Unit { name, kg, m, s, kelvin, rad, display }
}

/// Every unit of the table, in the order in which the XML lists them.
pub static UNITS: &[&Unit] = &[
    &ONE,
    &METRE,
    &SQUARE_METRE,
    &CUBIC_METRE,
    &SECOND,
    &METRE_PER_SECOND,
    &RADIAN,
    &RADIAN_PER_SECOND,
    &NEWTON,
    &NEWTON_METRE,
    &NEWTON_PER_METRE,
    &NEWTON_SECOND_PER_METRE,
    &PASCAL,
    &PASCAL_PER_METRE,
    &SQUARE_METRE_PER_NEWTON,
    &KELVIN,
    &PER_KELVIN,
    &JOULE,
    &WATT,
    &CONDUCTIVITY,
    &HEAT_TRANSFER,
    &CONDUCTANCE,
    &SPECIFIC_HEAT,
    &DENSITY,
    &KILOGRAM,
];

//                                                                 kg  m  s  K rad
/// A number.
pub static ONE: Unit = unit("1", [0, 0, 0, 0, 0], &[DisplayUnit { name: "%", factor: 100.0, offset: 0.0 }]);
/// Length.
pub static METRE: Unit = unit("m", [0, 1, 0, 0, 0], &[shown("mm", 1e3), shown("um", 1e6), shown("km", 1e-3)]);
/// Area.
pub static SQUARE_METRE: Unit = unit("m2", [0, 2, 0, 0, 0], &[shown("cm2", 1e4)]);
/// Volume.
pub static CUBIC_METRE: Unit = unit("m3", [0, 3, 0, 0, 0], &[shown("mm3", 1e9), shown("cm3", 1e6)]);
/// Time.
pub static SECOND: Unit = unit("s", [0, 0, 1, 0, 0], &[shown("min", 1.0 / 60.0), shown("h", 1.0 / 3600.0)]);
/// Velocity.
pub static METRE_PER_SECOND: Unit = unit("m/s", [0, 1, -1, 0, 0], &[shown("km/h", 3.6), shown("mm/s", 1e3)]);
/// Angle.
pub(crate) static RADIAN: Unit = unit("rad", [0, 0, 0, 0, 1], &[shown("deg", 180.0 / std::f64::consts::PI)]);
/// Angular velocity.
pub static RADIAN_PER_SECOND: Unit = unit("rad/s", [0, 0, -1, 0, 1], &[shown("rev/min", 30.0 / std::f64::consts::PI)]);
/// Force.
pub static NEWTON: Unit = unit("N", [1, 1, -2, 0, 0], &[shown("kN", 1e-3)]);
/// Torque.
pub(crate) static NEWTON_METRE: Unit = unit("N.m", [1, 2, -2, 0, 0], &[shown("kN.m", 1e-3)]);
/// Stiffness.
pub(crate) static NEWTON_PER_METRE: Unit = unit("N/m", [1, 0, -2, 0, 0], &[shown("kN/mm", 1e-6)]);
/// Damping.
pub(crate) static NEWTON_SECOND_PER_METRE: Unit = unit("N.s/m", [1, 0, -1, 0, 0], &[shown("kN.s/m", 1e-3)]);
/// Pressure.
pub(crate) static PASCAL: Unit = unit("Pa", [1, -1, -2, 0, 0], &[shown("MPa", 1e-6), shown("GPa", 1e-9)]);
/// Stiffness of a foundation.
pub(crate) static PASCAL_PER_METRE: Unit = unit("Pa/m", [1, -2, -2, 0, 0], &[shown("MPa/mm", 1e-9)]);
/// Wear coefficient: depth per sliding distance and pressure.
pub(crate) static SQUARE_METRE_PER_NEWTON: Unit = unit("m2/N", [-1, 1, 2, 0, 0], &[shown("mm3/(N.m)", 1e9)]);
/// Temperature.
pub static KELVIN: Unit = unit("K", [0, 0, 0, 1, 0], &[DisplayUnit { name: "degC", factor: 1.0, offset: -273.15 }]);
/// Thermal expansion.
pub(crate) static PER_KELVIN: Unit = unit("1/K", [0, 0, 0, -1, 0], &[shown("um/(m.K)", 1e6)]);
/// Energy.
pub(crate) static JOULE: Unit = unit("J", [1, 2, -2, 0, 0], &[shown("kJ", 1e-3), shown("MJ", 1e-6)]);
/// Power.
pub(crate) static WATT: Unit = unit("W", [1, 2, -3, 0, 0], &[shown("kW", 1e-3)]);
/// Thermal conductivity.
pub(crate) static CONDUCTIVITY: Unit = unit("W/(m.K)", [1, 1, -3, -1, 0], &[]);
/// Heat transfer coefficient.
pub(crate) static HEAT_TRANSFER: Unit = unit("W/(m2.K)", [1, 0, -3, -1, 0], &[]);
/// Thermal conductance.
pub(crate) static CONDUCTANCE: Unit = unit("W/K", [1, 2, -3, -1, 0], &[]);
/// Specific heat.
pub(crate) static SPECIFIC_HEAT: Unit = unit("J/(kg.K)", [0, 2, -2, -1, 0], &[]);
/// Mass.
pub static KILOGRAM: Unit = unit("kg", [1, 0, 0, 0, 0], &[shown("g", 1e3), shown("mg", 1e6)]);
/// Density.
pub(crate) static DENSITY: Unit = unit("kg/m3", [1, -3, 0, 0, 0], &[shown("g/cm3", 1e-3)]);
