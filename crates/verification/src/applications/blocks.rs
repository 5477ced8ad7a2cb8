//! Blocks, pins and seals: reciprocating, unidirectional, on discs.

use super::Family;
use super::courses::{duty_cycle, held, reciprocating, run_up};

pub(super) static FAMILIES: &[Family] = &[
    // A reciprocating block, as in a tribometer or a hinge.
    Family {
        name: "sinusoid",
        file: SINUSOID,
        columns: &[
            "punch.width",
            "depth",
            "punch.height",
            "strip.height",
            "punch.wear_coefficient",
            "contact.friction_coefficient",
            "period",
            "cycles",
            "pulse",
            "V",
            "F",
            "nominal.load",
            "nominal.velocity",
            "nominal.stroke",
            "nominal.duration",
        ],
        rows: &[
            &[0.017, 0.011, 0.019, 0.027, 8.9e-14, 0.12, 1.4, 12.0, 0.8, 0.011, 410.0, 290.0, 0.007, 0.005, 17.0],
            &[0.0086, 0.017, 0.0078, 0.032, 9.3e-15, 0.54, 0.39, 30.0, 0.0, 0.093, 250.0, 250.0, 0.059, 0.012, 12.0],
            &[0.0045, 0.028, 0.032, 0.039, 6.5e-14, 0.47, 0.11, 80.0, 0.8, 0.051, 160.0, 80.0, 0.032, 0.0018, 8.8],
            &[0.04, 0.0059, 0.013, 0.046, 6.7e-15, 0.39, 1.9, 200.0, 0.4, 0.0066, 240.0, 170.0, 0.0042, 0.004, 380.0],
            &[0.021, 0.0094, 0.055, 0.055, 4.7e-14, 0.31, 0.53, 200.0, 0.0, 0.056, 150.0, 180.0, 0.036, 0.0094, 110.0],
            &[0.011, 0.015, 0.023, 0.0066, 4.9e-15, 0.23, 0.15, 4.0, 0.4, 0.46, 97.0, 48.0, 0.29, 0.022, 0.6],
            &[0.0056, 0.024, 0.0093, 0.0078, 3.4e-14, 0.16, 2.6, 12.0, 0.0, 0.0041, 62.0, 62.0, 0.0026, 0.0034, 31.0],
            &[0.05, 0.005, 0.039, 0.0093, 3.5e-15, 0.58, 0.73, 30.0, 0.4, 0.033, 2800.0, 3400.0, 0.021, 0.0076, 22.0],
            &[0.026, 0.008, 0.016, 0.011, 2.4e-14, 0.5, 0.21, 30.0, 0.0, 0.26, 1700.0, 1200.0, 0.17, 0.018, 6.3],
        ],
        course: |v| reciprocating(v("V"), v("F"), v("period"), v("cycles"), v("pulse")),
    },
    // Unidirectional on a fresh track: a planing cut, a rail shoe.
    Family {
        name: "straight",
        file: STRAIGHT,
        columns: &[
            "punch.width",
            "depth",
            "punch.height",
            "strip.height",
            "punch.wear_coefficient",
            "strip.wear_coefficient",
            "contact.friction_coefficient",
            "V",
            "time",
            "F",
            "nominal.load",
            "nominal.velocity",
            "nominal.duration",
        ],
        rows: &[
            &[0.019, 0.015, 0.021, 0.033, 1.7e-13, 0.0, 0.33, 2.5, 15.0, 160.0, 190.0, 2.5, 15.0],
            &[0.012, 0.028, 0.012, 0.046, 2e-14, 0.0, 0.48, 0.78, 40.0, 1200.0, 1400.0, 0.78, 40.0],
            &[0.0079, 0.0069, 0.0065, 0.0077, 2.4e-15, 0.0, 0.24, 0.24, 100.0, 60.0, 72.0, 0.24, 100.0],
            &[0.0052, 0.013, 0.024, 0.011, 2.9e-14, 1e-14, 0.39, 0.077, 4.4, 480.0, 580.0, 0.077, 4.4],
            &[0.0033, 0.024, 0.013, 0.015, 3.4e-15, 1e-14, 0.15, 0.024, 11.0, 170.0, 85.0, 0.024, 11.0],
        ],
        course: |v| held(v("V"), v("F"), v("time"), 60),
    },
    // Rounded pins that wear flat.
    Family {
        name: "growing",
        file: GROWING,
        columns: &[
            "punch.width",
            "depth",
            "punch.height",
            "strip.height",
            "contact.initial_radius",
            "punch.wear_coefficient",
            "contact.friction_coefficient",
            "contact.mean_radius",
            "V",
            "time",
            "F",
            "nominal.load",
            "nominal.velocity",
            "nominal.duration",
        ],
        rows: &[
            &[0.024, 0.014, 0.022, 0.029, 0.034, 7.1e-14, 0.39, 0.018, 0.56, 48.0, 1400.0, 1400.0, 0.56, 48.0],
            &[0.02, 0.0043, 0.015, 0.01, 0.58, 8.9e-14, 0.18, 0.058, 1.7, 1200.0, 29.0, 17.0, 1.7, 1200.0],
            &[0.016, 0.009, 0.01, 0.014, 0.098, 1.1e-13, 0.36, 0.051, 0.13, 290.0, 76.0, 76.0, 0.13, 290.0],
            &[0.013, 0.019, 0.0072, 0.019, 1.7, 1.4e-13, 0.15, 0.043, 0.42, 69.0, 210.0, 130.0, 0.42, 69.0],
            &[0.011, 0.0058, 0.025, 0.026, 0.29, 1.8e-13, 0.33, 0.036, 1.3, 1700.0, 83.0, 100.0, 1.3, 1700.0],
            &[0.009, 0.012, 0.017, 0.0093, 0.048, 2.2e-13, 0.12, 0.029, 0.1, 410.0, 230.0, 140.0, 0.1, 410.0],
        ],
        course: |v| held(v("V"), v("F"), v("time"), 60),
    },
    // Wear laws that are not linear in pressure and velocity.
    Family {
        name: "exponents",
        file: EXPONENTS,
        columns: &[
            "punch.width",
            "depth",
            "punch.height",
            "punch.wear_pressure_exponent",
            "punch.wear_velocity_exponent",
            "punch.wear_coefficient",
            "contact.friction_coefficient",
            "contact.mean_radius",
            "contact.initial_shape",
            "contact.initial_radius",
            "V",
            "time",
            "F",
            "nominal.load",
            "nominal.velocity",
            "nominal.duration",
        ],
        rows: &[
            &[0.0022, 0.018, 0.019, 0.3, 1.0, 1.7e-14, 0.54, 0.022, 2.0, 0.79, 0.12, 520.0, 75.0, 75.0, 0.12, 520.0],
            &[0.0027, 0.0053, 0.015, 1.4, 0.7, 2.7e-14, 0.31, 0.019, 1.0, 0.42, 0.27, 120.0, 33.0, 43.0, 0.27, 120.0],
            &[0.0034, 0.015, 0.012, 2.2, 1.6, 4.2e-14, 0.58, 0.016, 2.0, 3.6, 0.63, 1300.0, 140.0, 140.0, 0.63, 1300.0],
            &[0.0041, 0.0044, 0.01, 0.3, 1.0, 3.4e-15, 0.35, 0.013, 2.0, 1.9, 1.5, 290.0, 58.0, 75.0, 1.5, 290.0],
            &[0.0051, 0.013, 0.0081, 0.6, 0.3, 5.3e-15, 0.12, 0.049, 1.0, 0.99, 3.5, 64.0, 250.0, 120.0, 3.5, 64.0],
            &[0.0063, 0.0037, 0.0065, 2.2, 1.6, 8.5e-15, 0.39, 0.046, 2.0, 0.52, 0.2, 710.0, 110.0, 140.0, 0.2, 710.0],
            &[0.0077, 0.011, 0.0053, 3.0, 1.0, 1.3e-14, 0.16, 0.043, 1.0, 4.5, 0.48, 160.0, 47.0, 24.0, 0.48, 160.0],
        ],
        course: |v| held(v("V"), v("F"), v("time"), 60),
    },
    // A block that rotates about a pivot.
    Family {
        name: "tilt",
        file: TILT,
        columns: &[
            "punch.width",
            "depth",
            "punch.height",
            "contact.friction_coefficient",
            "holder.pivot_height",
            "punch.wear_coefficient",
            "contact.mean_radius",
            "V",
            "time",
            "F",
            "nominal.load",
            "nominal.velocity",
            "nominal.duration",
        ],
        rows: &[
            &[0.012, 0.0093, 0.0096, 0.21, 0.0074, 7.4e-14, 0.033, 0.63, 270.0, 120.0, 120.0, 0.63, 270.0],
            &[0.016, 0.019, 0.0085, 0.36, 0.0036, 1.7e-13, 0.089, 0.84, 63.0, 240.0, 240.0, 0.84, 63.0],
            &[0.022, 0.01, 0.038, 0.12, 0.044, 1e-14, 0.054, 1.1, 220.0, 130.0, 130.0, 1.1, 220.0],
            &[0.03, 0.021, 0.033, 0.27, 0.022, 2.4e-14, 0.11, 1.5, 51.0, 270.0, 270.0, 1.5, 51.0],
        ],
        course: |v| held(v("V"), v("F"), v("time"), 60),
    },
    // A seal of a soft polymer on steel.
    Family {
        name: "polymer",
        file: POLYMER,
        columns: &[
            "punch.width",
            "depth",
            "punch.height",
            "punch.wear_coefficient",
            "contact.friction_coefficient",
            "contact.mean_radius",
            "V",
            "on",
            "off",
            "count",
            "idle",
            "F",
            "nominal.load",
            "nominal.velocity",
            "nominal.duration",
        ],
        rows: &[
            &[0.006, 0.09, 0.004, 3e-13, 0.09, 0.03, 1.4, 6.0, 3.0, 6.0, 0.2, 260.0, 280.0, 1.4, 36.0],
            &[0.02, 0.03, 0.012, 8e-14, 0.14, 0.055, 0.35, 25.0, 10.0, 3.0, 0.5, 900.0, 500.0, 0.35, 80.0],
        ],
        course: |v| duty_cycle(v("V"), v("F"), v("on"), v("off"), v("count"), v("idle")),
    },
    // An insulating, ceramic-like block.
    Family {
        name: "insulator",
        file: INSULATOR,
        columns: &[
            "punch.width",
            "depth",
            "punch.height",
            "punch.wear_coefficient",
            "contact.friction_coefficient",
            "contact.mean_radius",
            "V",
            "time",
            "F",
            "nominal.load",
            "nominal.velocity",
            "nominal.duration",
        ],
        rows: &[
            &[0.012, 0.008, 0.01, 4e-15, 0.35, 0.04, 0.9, 60.0, 150.0, 160.0, 0.9, 60.0],
            &[0.03, 0.02, 0.02, 2e-14, 0.25, 0.08, 4.0, 20.0, 700.0, 400.0, 3.0, 20.0],
        ],
        course: |v| held(v("V"), v("F"), v("time"), 60),
    },
    // Contacts without wear.
    Family {
        name: "no_wear",
        file: NO_WEAR,
        columns: &[
            "punch.width",
            "depth",
            "punch.height",
            "contact.friction_coefficient",
            "contact.mean_radius",
            "V",
            "time",
            "F",
            "nominal.load",
            "nominal.velocity",
            "nominal.duration",
        ],
        rows: &[
            &[0.008, 0.006, 0.008, 0.12, 0.03, 2.5, 40.0, 200.0, 200.0, 2.5, 40.0],
            &[0.025, 0.012, 0.02, 0.4, 0.06, 0.6, 150.0, 800.0, 1000.0, 0.6, 150.0],
        ],
        course: |v| run_up(v("V"), v("F"), v("time")),
    },
];

const SINUSOID: &str = r#"
name = "sinusoid"
depth = "5 mm"
ambient_temperature = "22 degC"
[punch]
material = "structural_steel"
top_thermal = "held"
convection = 15.0
[strip]
height = "10 mm"
material = "bearing_steel"
path = "straight"
base = "bonded"
base_thermal = "held"
wear_coefficient = 0.0
convection = 15.0
convection_forced = 0.0
[contact]
geometry = "line"
faces = 1
conductance = 30e3
[holder]
constraint = "translate"
"#;

const STRAIGHT: &str = r#"
name = "straight"
depth = "5 mm"
ambient_temperature = "22 degC"
[punch]
material = "bronze"
top_thermal = "held"
convection = 5.0
[strip]
height = "10 mm"
material = "structural_steel"
path = "straight"
base = "bonded"
base_thermal = "held"
wear_coefficient = 0.0
convection = 5.0
convection_forced = 0.0
[contact]
geometry = "line"
faces = 1
conductance = 20e3
[holder]
constraint = "translate"
"#;

const GROWING: &str = r#"
name = "growing"
depth = "5 mm"
ambient_temperature = "22 degC"
[punch]
material = "bearing_steel"
top_thermal = "held"
convection = 5.0
[strip]
height = "10 mm"
material = "bearing_steel"
path = "closed"
base = "bonded"
base_thermal = "held"
wear_coefficient = 0.0
convection = 5.0
convection_forced = 0.0
[contact]
geometry = "line"
faces = 1
conductance = 40e3
[holder]
constraint = "translate"
"#;

const EXPONENTS: &str = r#"
name = "exponents"
depth = "5 mm"
ambient_temperature = "22 degC"
[punch]
material = "carbon_steel"
top_thermal = "held"
convection = 5.0
[strip]
height = "10 mm"
material = "grey_cast_iron"
path = "closed"
base = "bonded"
base_thermal = "held"
wear_coefficient = 0.0
convection = 5.0
convection_forced = 0.0
[contact]
geometry = "line"
faces = 1
conductance = 40e3
[holder]
constraint = "translate"
"#;

const TILT: &str = r#"
name = "tilt"
depth = "5 mm"
ambient_temperature = "22 degC"
[punch]
material = "bronze"
top_thermal = "held"
convection = 5.0
[strip]
height = "10 mm"
material = "carbon_steel"
path = "closed"
base = "bonded"
base_thermal = "held"
wear_coefficient = 0.0
convection = 5.0
convection_forced = 0.0
[contact]
geometry = "line"
faces = 1
conductance = 30e3
[holder]
constraint = "translate_and_rotate"
"#;

const POLYMER: &str = r#"
name = "polymer"
depth = "5 mm"
ambient_temperature = "40 degC"
[punch]
material = "ptfe"
top_thermal = "held"
convection = 5.0
[strip]
height = "10 mm"
material = "stainless_steel"
path = "closed"
base = "bonded"
base_thermal = "held"
wear_coefficient = 0.0
convection = 5.0
convection_forced = 0.0
[contact]
geometry = "line"
faces = 1
conductance = 5e3
[holder]
constraint = "translate"
"#;

const INSULATOR: &str = r#"
name = "insulator"
depth = "5 mm"
ambient_temperature = "22 degC"
[punch]
material = "alumina"
top_thermal = "held"
conductivity = 0.0
convection = 5.0
[strip]
height = "10 mm"
material = "structural_steel"
path = "closed"
base = "bonded"
base_thermal = "held"
wear_coefficient = 0.0
convection = 5.0
convection_forced = 0.0
[contact]
geometry = "line"
faces = 1
conductance = 30e3
[holder]
constraint = "translate"
"#;

const NO_WEAR: &str = r#"
name = "no_wear"
depth = "5 mm"
ambient_temperature = "22 degC"
[punch]
material = "silicon_nitride"
top_thermal = "held"
wear_coefficient = 0.0
convection = 5.0
[strip]
height = "10 mm"
material = "bearing_steel"
path = "closed"
base = "bonded"
base_thermal = "held"
wear_coefficient = 0.0
convection = 5.0
convection_forced = 0.0
[contact]
geometry = "line"
faces = 1
conductance = 80e3
[holder]
constraint = "translate"
"#;
