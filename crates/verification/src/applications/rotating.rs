//! Clutches and rings, at speeds below and above the critical one.

use super::Family;
use super::courses::{engagements, held};

pub(super) static FAMILIES: &[Family] = &[
    // Engagements of dry clutches.
    Family {
        name: "clutch",
        file: CLUTCH,
        columns: &[
            "contact.mean_radius",
            "punch.width",
            "depth",
            "punch.height",
            "strip.height",
            "punch.conductivity",
            "punch.youngs_modulus",
            "contact.friction_coefficient",
            "V",
            "slip",
            "count",
            "F",
            "nominal.load",
            "nominal.velocity",
            "nominal.duration",
        ],
        rows: &[
            &[0.094, 0.028, 0.5906, 0.0037, 0.011, 4.4, 1.5e8, 0.38, 7.2, 1.4, 2.0, 1800.0, 1800.0, 4.3, 2.0],
            &[0.11, 0.047, 0.6911, 0.0055, 0.0092, 0.67, 1.4e9, 0.41, 17.0, 1.3, 4.0, 10000.0, 10000.0, 10.0, 3.6],
            &[0.13, 0.035, 0.8168, 0.0034, 0.0077, 1.5, 5.1e8, 0.44, 8.2, 1.1, 1.0, 6300.0, 6300.0, 4.9, 0.77],
            &[0.073, 0.023, 0.4586, 0.0052, 0.0062, 3.6, 1.9e8, 0.27, 19.0, 0.99, 2.0, 1700.0, 1700.0, 11.0, 1.4],
            &[0.089, 0.042, 0.5592, 0.0031, 0.015, 0.55, 1.8e9, 0.3, 9.3, 0.87, 4.0, 2800.0, 2800.0, 5.6, 2.4],
            &[0.1, 0.03, 0.3769, 0.0049, 0.013, 1.3, 6.6e8, 0.33, 22.0, 0.77, 1.0, 3800.0, 3800.0, 13.0, 0.54],
        ],
        course: |v| engagements(v("V"), v("F"), v("slip"), v("count")),
    },
    // Face seals: a ring on a ring, from a third of the critical speed to twice it.
    Family {
        name: "ring",
        file: RING,
        columns: &[
            "contact.friction_coefficient",
            "V",
            "time",
            "F",
            "nominal.load",
            "nominal.velocity",
            "nominal.duration",
        ],
        rows: &[
            &[0.2, 0.19, 25.0, 300.0, 300.0, 0.2, 25.0],
            &[0.12, 0.75, 12.0, 500.0, 450.0, 0.8, 12.0],
            &[0.3, 0.55, 8.0, 150.0, 200.0, 0.5, 8.0],
            &[0.25, 1.0, 2.0, 400.0, 350.0, 1.0, 3.0],
        ],
        course: |v| held(v("V"), v("F"), v("time"), 60),
    },
    // Sintered pads on discs, from a third of the critical speed to twice it.
    Family {
        name: "unstable",
        file: UNSTABLE,
        columns: &[
            "punch.width",
            "depth",
            "contact.mean_radius",
            "contact.friction_coefficient",
            "strip.height",
            "V",
            "time",
            "F",
            "nominal.load",
            "nominal.velocity",
            "nominal.duration",
        ],
        rows: &[
            &[0.06, 0.04, 0.12, 0.4, 0.011, 1.5, 4.0, 1500.0, 1500.0, 1.5, 4.0],
            &[0.04, 0.03, 0.1, 0.35, 0.008, 3.0, 2.0, 900.0, 1000.0, 3.0, 2.0],
            &[0.09, 0.05, 0.16, 0.3, 0.012, 6.0, 1.5, 2500.0, 2500.0, 6.0, 1.5],
            &[0.05, 0.04, 0.13, 0.42, 0.01, 9.0, 0.6, 1200.0, 600.0, 9.0, 0.6],
        ],
        course: |v| held(v("V"), v("F"), v("time"), 60),
    },
];

const CLUTCH: &str = r#"
name = "clutch"
depth = "400 mm"
ambient_temperature = "50 degC"
[punch]
material = "brake_lining"
wear_coefficient = "1e-5 mm3/(N.m)"
top_thermal = "insulated"
convection = 8.0
[strip]
material = "structural_steel"
path = "closed"
base = "bonded"
base_thermal = "convecting"
wear_coefficient = "3e-7 mm3/(N.m)"
convection = 12.0
convection_forced = 4.0
[contact]
geometry = "annular"
faces = 2
shear_coupling = false
conductance = 15e3
[holder]
constraint = "translate"
"#;

const RING: &str = r#"
name = "ring"
depth = "8 mm"
[punch]
width = "125.66 mm"
height = "30 mm"
material = "stainless_steel"
wear_coefficient = "2e-7 mm3/(N.m)"
top_thermal = "held"
convection = 0.0
[strip]
length = "125.66 mm"
height = "30 mm"
material = "alumina"
path = "closed"
base = "bonded"
base_thermal = "held"
wear_coefficient = 0.0
convection = 0.0
convection_forced = 0.0
[contact]
geometry = "periodic"
mean_radius = "20 mm"
faces = 1
shear_coupling = false
conductance = 2e5
initial_shape = "tabulated"
initial_gap = [
  68.32e-9, 62.04e-9, 55.97e-9, 51.03e-9, 47.52e-9, 45.20e-9, 43.46e-9, 41.60e-9,
  39.14e-9, 35.98e-9, 32.38e-9, 28.89e-9, 26.05e-9, 24.19e-9, 23.27e-9, 22.90e-9,
  22.48e-9, 21.51e-9, 19.77e-9, 17.56e-9, 15.65e-9, 15.12e-9, 17.00e-9, 21.97e-9,
  30.05e-9, 40.48e-9, 51.88e-9, 62.52e-9, 70.78e-9, 75.49e-9, 76.27e-9, 73.53e-9,
  68.32e-9,
]
[holder]
constraint = "translate"
"#;

const UNSTABLE: &str = r#"
name = "unstable"
depth = "40 mm"
[punch]
height = "11 mm"
material = "brake_lining"
youngs_modulus = "1.5 GPa"
wear_coefficient = "8e-6 mm3/(N.m)"
top_thermal = "convecting"
convection = 8.0
[strip]
height = "9 mm"
material = "grey_cast_iron"
path = "closed"
base = "bonded"
base_thermal = "insulated"
wear_coefficient = "6e-7 mm3/(N.m)"
convection = 12.0
convection_forced = 6.0
emissivity = 0.0
[contact]
geometry = "line"
faces = 2
conductance = 15e3
[holder]
constraint = "translate"
"#;
