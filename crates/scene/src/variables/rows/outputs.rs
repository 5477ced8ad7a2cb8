//! Outputs and profiles.

use super::super::units::*;
use super::super::{Depends, Kind, Variability};
use super::{Row, boolean, integer, real};

/// Stations of every profile, spread evenly from edge to edge.
const STATIONS: u32 = 33;

const ON_INPUTS: Depends = Depends::OnInputs;
const ON_STATES: Depends = Depends::OnStates;

const fn limit_reached() -> Row {
    let row = integer(
        "limit_reached",
        0,
        7,
        0,
        "Sum of 1: wear_limit_reached, 2: temperature_limit_exceeded, 4: validity_exceeded; each logged once",
    );
    discrete(Row { kind: Kind::Integer { min: None, max: None }, ..row.output(ON_INPUTS) })
}

/// A calculated row that changes at events only.
const fn discrete(row: Row) -> Row {
    Row { variability: Variability::Discrete, ..row }
}

pub(crate) const ROWS: &[Row] = &[
    // Main outputs.
    real("wear_depth", &METRE, 1e-6, "Mean loss of height in the contact zone, both bodies together")
        .shown("um")
        .output(ON_STATES),
    real(
        "contact_temperature",
        &KELVIN,
        400.0,
        "Mean over the contact zone of the mean of both surfaces' temperatures",
    )
    .shown("degC")
    .output(ON_INPUTS),
    real(
        "friction_force",
        &NEWTON,
        1e3,
        "Friction force of all faces with the sign of the velocity; a brake equation is m dv/dt = ... - friction_force",
    )
    .shown("kN")
    .output(ON_INPUTS),
    // Friction.
    real(
        "friction_torque",
        &NEWTON_METRE,
        100.0,
        "Friction torque of all faces: integral of mu p r; for line geometry the force times contact.mean_radius",
    )
    .output(ON_INPUTS),
    real("effective_radius", &METRE, 0.1, "Friction torque over friction coefficient times load; contact.mean_radius for line geometry")
        .shown("mm")
        .local(),
    real("friction_power", &WATT, 1e3, "Friction force times velocity, all faces").of_type("Power").shown("kW").output(ON_INPUTS),
    real("friction_coefficient", &ONE, 0.3, "Present friction coefficient, including fade and Stribeck effect").of_type("CoefficientOfFriction")
        .local(),
    real("friction_force_kinetic", &NEWTON, 1e3, "Magnitude of the friction force while sliding, >= 0, all faces")
        .shown("kN")
        .output(ON_INPUTS),
    real(
        "friction_force_limit",
        &NEWTON,
        1e3,
        "Static friction limit: largest friction force in stick, >= 0, all faces",
    )
    .shown("kN")
    .output(ON_INPUTS),
    real(
        "friction_slope",
        &NEWTON_SECOND_PER_METRE,
        1e3,
        "Derivative of the friction force by the velocity; an explicit master needs a step below 2 mass / friction_slope. \
         While a bristle sticks it is contact.stick_damping",
    )
    .local(),
    real("critical_speed", &METRE_PER_SECOND, 10.0, "Speed above which the scene is thermoelastically unstable; 0: none")
        .local(),
    real("bristle_deflection", &METRE, 1e-6, "Bristle deflection of the friction model in stick (contact.stick_stiffness > 0)")
        .shown("um")
        .local(),
    real("bristle_energy", &JOULE, 1e-3, "Elastic energy in the bristles of all faces: integral of friction_power minus dissipated_energy")
        .local(),
    discrete(
        boolean(
            "sticking",
            false,
            "Whether the contact sticks: closed, and the bristle below its sliding limit; without contact.stick_stiffness, \
             the velocity is 0",
        )
        .output(ON_INPUTS),
    ),
    // Contact.
    real("pressure_mean", &PASCAL, 1e6, "Mean contact pressure").shown("MPa").local(),
    real("pressure_max", &PASCAL, 1e6, "Highest contact pressure").shown("MPa").local(),
    real("contact_fraction", &ONE, 1.0, "Fraction of the contact zone in contact").local(),
    real("tilt", &RADIAN, 1e-4, "Rotation of the punch; positive lowers the edge at +x").shown("deg").output(ON_INPUTS),
    real("approach", &METRE, 1e-6, "Approach of the bodies from first touch, positive when pressed together or worn")
        .shown("um")
        .output(ON_INPUTS),
    // Heat.
    real("contact_temperature_max", &KELVIN, 400.0, "Highest temperature of the contact, on the hotter side: largest mean over a 32nd of the width")
        .shown("degC")
        .output(ON_INPUTS),
    real("heat_flow_punch", &WATT, 1e3, "Friction heat that enters the punches, all faces").shown("kW").local(),
    real("heat_flow_strip", &WATT, 1e3, "Friction heat that enters the strips, all faces").shown("kW").local(),
    real("heat_flow_punch_top", &WATT, 100.0, "Heat that leaves through the punches' tops, all faces").local(),
    real("heat_flow_strip_base", &WATT, 100.0, "Heat that leaves through the strips' bases, all faces").local(),
    real(
        "heat_flow_ambient",
        &WATT,
        100.0,
        "Heat that leaves to the ambient air by convection and radiation from the cooled surfaces, all faces",
    )
    .output(ON_INPUTS),
    real(
        "heat_flow_punch_external",
        &WATT,
        100.0,
        "Heat that flows out of the punches' tops to their neighbour at punch.external_temperature; part of heat_flow_punch_top",
    )
    .output(ON_INPUTS),
    real(
        "heat_flow_strip_external",
        &WATT,
        100.0,
        "Heat that flows out of the strips' bases to their neighbour at strip.external_temperature; part of heat_flow_strip_base",
    )
    .output(ON_INPUTS),
    real("heat_lost_punch_top", &JOULE, 1e4, "Integral of heat_flow_punch_top").of_type("Heat").shown("kJ").local(),
    real("heat_lost_strip_base", &JOULE, 1e4, "Integral of heat_flow_strip_base").of_type("Heat").shown("kJ").local(),
    real("heat_lost_ambient", &JOULE, 1e4, "Integral of heat_flow_ambient").of_type("Heat").shown("kJ").local(),
    real("heat_lost_punch_external", &JOULE, 1e4, "Integral of heat_flow_punch_external: over a step, exactly what the neighbour receives")
        .of_type("Heat")
        .shown("kJ")
        .local(),
    real("heat_lost_strip_external", &JOULE, 1e4, "Integral of heat_flow_strip_external: over a step, exactly what the neighbour receives")
        .of_type("Heat")
        .shown("kJ")
        .local(),
    real("heat_received_punch", &JOULE, 1e4, "Integral of heat_flow_punch").of_type("Heat").shown("kJ").local(),
    real("heat_received_strip", &JOULE, 1e4, "Integral of heat_flow_strip").of_type("Heat").shown("kJ").local(),
    real("punch.mean_temperature", &KELVIN, 400.0, "Mean temperature of the punch").shown("degC").output(ON_STATES),
    real("strip.mean_temperature", &KELVIN, 400.0, "Mean temperature of the strip (of a straight one: along the track)")
        .shown("degC")
        .output(ON_STATES),
    real("stored_heat", &JOULE, 1e4, "Heat stored in all bodies since initialisation").of_type("Heat").shown("kJ").local(),
    // Wear.
    real("wear_depth_punch", &METRE, 1e-6, "Mean worn depth of the punch over the present contact zone")
        .shown("um")
        .output(ON_STATES),
    real(
        "wear_depth_strip",
        &METRE,
        1e-6,
        "Mean worn depth of the strip over the present contact zone; on a straight path not monotone, the volume is",
    )
    .shown("um")
    .output(ON_STATES),
    real("wear_volume_punch", &CUBIC_METRE, 1e-9, "Volume worn off the punches, all faces").shown("mm3").local(),
    real("wear_volume_strip", &CUBIC_METRE, 1e-9, "Volume worn off the strips, all faces").shown("mm3").local(),
    real(
        "wear_dissipation_power",
        &WATT,
        1e3,
        "Power dissipated by wear, the functional of Paczelt and Mroz: integral of pressure times wear rate of both bodies, all faces",
    ).of_type("Power")
    .local(),
    real("remaining_life", &ONE, 1.0, "Remaining fraction of the wear limit, the lower of both bodies; 1 without a limit")
        .shown("%")
        .output(ON_STATES),
    // Bookkeeping.
    real("sliding_distance", &METRE, 1e3, "Distance slid").of_type("Distance").shown("km").local(),
    real("dissipated_energy", &JOULE, 1e4, "Friction heat since initialisation, all faces").shown("kJ").local(),
    real("estimated_error", &ONE, 1e-3, "Relative error of wear depth, temperature rise and friction force so far, measured against a coarser run; 1: not known")
        .output(ON_STATES),
    real("estimated_step_error", &ONE, 1e-3, "Estimated relative error by the reduction of the bodies and the time steps alone; not a bound")
        .local(),
    limit_reached(),
    discrete(boolean("wear_limit_reached", false, "Whether a wear limit is reached").local()),
    discrete(boolean("temperature_limit_exceeded", false, "Whether contact.temperature_limit has been exceeded").local()),
    discrete(boolean("validity_exceeded", false, "Whether the run has left the model's validity").local()),
    // Masses.
    real("wear_mass_punch", &KILOGRAM, 1e-6, "Mass worn off the punches, all faces: density times wear_volume_punch")
        .shown("mg")
        .output(ON_STATES),
    real("wear_mass_strip", &KILOGRAM, 1e-6, "Mass worn off the strips, all faces: density times wear_volume_strip")
        .shown("mg")
        .output(ON_STATES),
    real("wear_mass_airborne", &KILOGRAM, 1e-6, "Mass of airborne wear particles: airborne_fraction of both bodies times their worn mass")
        .shown("mg")
        .output(ON_STATES),
    // Shape.
    real(
        "wear_taper_punch",
        &METRE,
        1e-6,
        "Taper of the worn punch: its worn depth at the +x edge less that at the -x edge, on the straight line of least squares through it; \
         annular: outer less inner edge",
    )
    .shown("um")
    .output(ON_STATES),
];

pub(crate) const PROFILES: &[Row] = &[
    Row {
        variability: Variability::Fixed,
        ..real(
            "profile.x",
            &METRE,
            1e-2,
            "Position of the station along the sliding direction, from the contact's middle",
        )
        .of_type("Position")
        .shown("mm")
        .array(STATIONS)
        .local()
    },
    real("profile.pressure", &PASCAL, 1e6, "Contact pressure, mean over the station's interval")
        .shown("MPa")
        .array(STATIONS)
        .local(),
    real(
        "profile.temperature",
        &KELVIN,
        400.0,
        "Contact temperature (mean of both surfaces), mean over the station's interval",
    )
    .shown("degC")
    .array(STATIONS)
    .local(),
    real("profile.wear_punch", &METRE, 1e-6, "Worn depth of the punch, mean over the station's interval")
        .shown("um")
        .array(STATIONS)
        .local(),
    real("profile.wear_strip", &METRE, 1e-6, "Worn depth of the strip under the station, mean over its interval")
        .shown("um")
        .array(STATIONS)
        .local(),
];
