//! Brakes: pads on discs in long drags, stops, duty cycles and drives, in stiff and soft calipers, with cooling and fade.

use super::Family;
use super::courses::{duty_cycle, held, stop_and_go, wandering};

pub(super) static FAMILIES: &[Family] = &[
    // A descent at constant power.
    Family {
        name: "drag",
        file: DISC,
        columns: &[
            "punch.width",
            "depth",
            "punch.height",
            "strip.height",
            "contact.mean_radius",
            "contact.friction_coefficient",
            "punch.conductivity",
            "punch.youngs_modulus",
            "V",
            "time",
            "F",
            "nominal.load",
            "nominal.velocity",
            "nominal.duration",
        ],
        rows: &[
            &[0.052, 0.032, 0.0083, 0.01, 0.15, 0.43, 0.7, 3.2e8, 1.3, 190.0, 500.0, 1000.0, 1.3, 190.0],
            &[0.064, 0.051, 0.0074, 0.016, 0.12, 0.23, 4.1, 4.3e8, 4.1, 130.0, 2200.0, 2200.0, 4.1, 130.0],
            &[0.076, 0.034, 0.0065, 0.0067, 0.085, 0.29, 1.4, 5.7e8, 13.0, 93.0, 340.0, 340.0, 13.0, 93.0],
            &[0.088, 0.053, 0.018, 0.012, 0.19, 0.35, 8.1, 7.5e8, 3.4, 65.0, 1400.0, 770.0, 3.4, 65.0],
            &[0.1, 0.037, 0.017, 0.018, 0.16, 0.41, 2.6, 9.9e8, 11.0, 460.0, 110.0, 130.0, 11.0, 460.0],
            &[0.033, 0.056, 0.016, 0.009, 0.13, 0.47, 0.87, 1.3e9, 2.8, 320.0, 780.0, 780.0, 2.8, 320.0],
            &[0.045, 0.04, 0.015, 0.015, 0.096, 0.27, 5.2, 4.6e7, 8.7, 230.0, 78.0, 43.0, 8.7, 230.0],
            &[0.058, 0.059, 0.014, 0.0056, 0.2, 0.33, 1.7, 6.1e7, 2.3, 160.0, 930.0, 1100.0, 2.3, 160.0],
            &[0.07, 0.042, 0.013, 0.011, 0.17, 0.39, 0.56, 8e7, 7.2, 110.0, 1100.0, 1100.0, 7.2, 110.0],
        ],
        course: |v| held(v("V"), v("F"), v("time"), 60),
    },
    // Traffic: stops, holds at rest, run-ups.
    Family {
        name: "stop_and_go",
        file: DISC,
        columns: &[
            "punch.width",
            "depth",
            "strip.height",
            "contact.mean_radius",
            "contact.friction_coefficient",
            "punch.wear_coefficient",
            "V",
            "stop",
            "rest",
            "count",
            "F",
            "nominal.load",
            "nominal.velocity",
            "nominal.duration",
        ],
        rows: &[
            &[0.078, 0.044, 0.01, 0.14, 0.4, 8e-14, 3.6, 5.1, 3.3, 8.0, 4200.0, 2100.0, 2.2, 41.0],
            &[0.099, 0.068, 0.011, 0.19, 0.38, 9.2e-15, 17.0, 6.6, 13.0, 8.0, 3500.0, 4200.0, 10.0, 53.0],
            &[0.12, 0.053, 0.012, 0.13, 0.35, 2.4e-14, 8.4, 1.6, 3.9, 8.0, 5400.0, 5400.0, 5.0, 13.0],
            &[0.05, 0.038, 0.013, 0.18, 0.33, 6.3e-14, 4.3, 2.1, 15.0, 8.0, 4700.0, 3800.0, 2.6, 17.0],
            &[0.071, 0.062, 0.013, 0.12, 0.31, 7.3e-15, 2.2, 2.7, 4.8, 5.0, 11000.0, 5500.0, 1.3, 14.0],
            &[0.092, 0.047, 0.014, 0.17, 0.43, 1.9e-14, 10.0, 3.5, 19.0, 5.0, 3500.0, 4200.0, 6.0, 18.0],
        ],
        course: |v| stop_and_go(v("V"), v("F"), v("stop"), v("rest"), v("count")),
    },
    // A brake of a machine: blocks on and off at constant speed.
    Family {
        name: "duty",
        file: DUTY,
        columns: &[
            "punch.width",
            "depth",
            "punch.height",
            "strip.height",
            "contact.mean_radius",
            "contact.friction_coefficient",
            "punch.conductivity",
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
            &[0.057, 0.035, 0.01, 0.019, 0.26, 0.18, 3.7, 6.8, 5.1, 53.0, 7.0, 0.0, 2200.0, 3100.0, 6.8, 36.0],
            &[0.074, 0.026, 0.012, 0.011, 0.24, 0.28, 1.6, 1.1, 27.0, 2.3, 2.0, 0.0, 4800.0, 4800.0, 1.1, 54.0],
            &[0.036, 0.047, 0.013, 0.02, 0.22, 0.37, 26.0, 1.8, 9.5, 3.0, 7.0, 0.1, 4200.0, 3800.0, 1.8, 66.0],
            &[0.053, 0.037, 0.0053, 0.013, 0.2, 0.22, 11.0, 3.2, 3.4, 3.8, 10.0, 0.1, 1800.0, 720.0, 3.2, 34.0],
            &[0.069, 0.028, 0.0067, 0.022, 0.18, 0.31, 4.9, 5.7, 18.0, 5.0, 4.0, 0.03, 870.0, 870.0, 5.7, 72.0],
            &[0.031, 0.049, 0.0081, 0.014, 0.17, 0.16, 2.1, 0.88, 6.3, 6.5, 10.0, 0.03, 3800.0, 3400.0, 0.88, 63.0],
        ],
        course: |v| duty_cycle(v("V"), v("F"), v("on"), v("off"), v("count"), v("idle")),
    },
    // Residual drag of a released pad.
    Family {
        name: "light",
        file: DISC,
        columns: &[
            "punch.width",
            "depth",
            "strip.height",
            "contact.mean_radius",
            "contact.friction_coefficient",
            "V",
            "time",
            "nominal.load",
            "F",
            "nominal.velocity",
            "nominal.duration",
        ],
        rows: &[
            &[0.081, 0.046, 0.016, 0.18, 0.26, 5.3, 95.0, 1600.0, 51.0, 5.3, 9.5],
            &[0.038, 0.037, 0.019, 0.13, 0.27, 14.0, 63.0, 2800.0, 45.0, 14.0, 6.3],
            &[0.065, 0.028, 0.0087, 0.085, 0.29, 4.5, 41.0, 4800.0, 370.0, 4.5, 4.1],
            &[0.092, 0.058, 0.012, 0.16, 0.3, 12.0, 27.0, 8400.0, 320.0, 12.0, 2.7],
            &[0.049, 0.049, 0.015, 0.11, 0.32, 3.8, 270.0, 2400.0, 46.0, 3.8, 27.0],
        ],
        course: |v| held(v("V"), v("F"), v("time"), 60),
    },
    // A caliper of finite stiffness between actuator and pad.
    Family {
        name: "caliper",
        file: DISC,
        columns: &[
            "punch.width",
            "depth",
            "punch.height",
            "contact.mean_radius",
            "holder.stiffness",
            "contact.initial_shape",
            "contact.initial_radius",
            "punch.wear_coefficient",
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
            &[0.1, 0.054, 0.015, 0.17, 3.2e6, 1.0, 43.0, 1.9e-14, 0.39, 0.009, 11.0, 82.0, 320.0, 260.0, 11.0, 82.0],
            &[0.064, 0.05, 0.0095, 0.14, 8e6, 2.0, 35.0, 7.1e-14, 0.35, 0.011, 5.3, 100.0, 1600.0, 1300.0, 5.3, 100.0],
            &[0.097, 0.045, 0.012, 0.12, 2e7, 2.0, 29.0, 2.6e-13, 0.31, 0.013, 2.5, 120.0, 860.0, 1100.0, 2.5, 120.0],
            &[0.059, 0.04, 0.014, 0.093, 5e7, 1.0, 23.0, 3.2e-14, 0.44, 0.013, 8.3, 150.0, 290.0, 380.0, 8.3, 150.0],
            &[0.091, 0.036, 0.0089, 0.15, 1.3e8, 2.0, 19.0, 1.2e-13, 0.4, 0.009, 3.9, 180.0, 170.0, 170.0, 3.9, 180.0],
            &[
                0.053, 0.031, 0.011, 0.12, 3.2e8, 1.0, 15.0, 1.5e-14, 0.36, 0.011, 13.0, 17.0, 1200.0, 1200.0, 13.0,
                17.0,
            ],
        ],
        course: |v| held(v("V"), v("F"), v("time"), 60),
    },
    // Friction and wear that depend on the temperature.
    Family {
        name: "fade",
        file: FADE,
        columns: &[
            "punch.width",
            "depth",
            "contact.mean_radius",
            "contact.friction_coefficient",
            "strip.height",
            "contact.friction_fade.factor[3]",
            "contact.friction_fade.factor[4]",
            "punch.wear_fade.factor[3]",
            "punch.wear_fade.factor[4]",
            "V",
            "time",
            "F",
            "nominal.load",
            "nominal.velocity",
            "nominal.duration",
        ],
        rows: &[
            &[0.052, 0.059, 0.1, 0.32, 0.0091, 0.87, 0.74, 2.1, 15.0, 7.9, 8.9, 4200.0, 4200.0, 7.9, 8.9],
            &[0.079, 0.057, 0.13, 0.48, 0.01, 0.79, 0.46, 3.3, 11.0, 13.0, 58.0, 1700.0, 1000.0, 13.0, 58.0],
            &[0.056, 0.054, 0.16, 0.43, 0.012, 0.91, 0.48, 2.0, 8.9, 4.3, 25.0, 5700.0, 5700.0, 4.3, 25.0],
            &[0.083, 0.052, 0.12, 0.38, 0.0072, 0.83, 0.51, 3.1, 7.0, 7.0, 11.0, 5700.0, 3400.0, 7.0, 11.0],
        ],
        course: |v| held(v("V"), v("F"), v("time"), 60),
    },
    // Hot drags with forced convection and radiation.
    Family {
        name: "cooled",
        file: DISC,
        columns: &[
            "punch.width",
            "depth",
            "contact.mean_radius",
            "contact.friction_coefficient",
            "strip.height",
            "strip.convection",
            "strip.convection_forced",
            "strip.emissivity",
            "V",
            "time",
            "F",
            "nominal.load",
            "nominal.velocity",
            "nominal.duration",
        ],
        rows: &[
            &[0.042, 0.03, 0.1, 0.33, 0.0085, 50.0, 3.8, 0.55, 20.0, 360.0, 71.0, 71.0, 20.0, 360.0],
            &[0.078, 0.032, 0.16, 0.31, 0.011, 25.0, 5.3, 0.23, 17.0, 660.0, 290.0, 290.0, 17.0, 660.0],
            &[0.055, 0.034, 0.094, 0.42, 0.0058, 13.0, 7.4, 0.6, 15.0, 260.0, 150.0, 150.0, 15.0, 260.0],
            &[0.032, 0.036, 0.15, 0.4, 0.008, 59.0, 10.0, 0.28, 13.0, 460.0, 180.0, 180.0, 13.0, 460.0],
        ],
        course: |v| held(v("V"), v("F"), v("time"), 60),
    },
    // Aperiodic drives.
    Family {
        name: "wander",
        file: DISC,
        columns: &[
            "punch.width",
            "depth",
            "strip.height",
            "contact.mean_radius",
            "contact.friction_coefficient",
            "punch.youngs_modulus",
            "V",
            "time",
            "F",
            "nominal.load",
            "nominal.velocity",
            "nominal.duration",
        ],
        rows: &[
            &[0.061, 0.04, 0.0095, 0.13, 0.4, 7.5e8, 4.6, 210.0, 630.0, 630.0, 4.6, 100.0],
            &[0.042, 0.045, 0.015, 0.12, 0.31, 4.2e8, 6.7, 100.0, 2200.0, 770.0, 2.3, 50.0],
            &[0.084, 0.05, 0.01, 0.11, 0.36, 2.3e8, 9.7, 320.0, 320.0, 180.0, 5.3, 160.0],
            &[0.065, 0.054, 0.016, 0.11, 0.42, 1.3e8, 14.0, 150.0, 820.0, 290.0, 4.9, 75.0],
            &[0.047, 0.059, 0.011, 0.1, 0.33, 9.1e8, 4.1, 75.0, 5300.0, 2900.0, 2.3, 38.0],
        ],
        course: |v| wandering(v("V"), v("F"), v("time"), 240),
    },
];

const DISC: &str = r#"
name = "disc"
depth = "40 mm"
[punch]
height = "11 mm"
material = "brake_lining"
youngs_modulus = "200 MPa"
wear_coefficient = "2.5e-5 mm3/(N.m)"
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

const DUTY: &str = r#"
name = "duty"
depth = "40 mm"
[punch]
height = "11 mm"
material = "brake_lining"
youngs_modulus = "350 MPa"
wear_coefficient = "4e-6 mm3/(N.m)"
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

const FADE: &str = r#"
name = "fade"
depth = "40 mm"
[punch]
height = "11 mm"
material = "brake_lining"
youngs_modulus = "200 MPa"
wear_coefficient = "2.5e-5 mm3/(N.m)"
top_thermal = "convecting"
convection = 8.0
wear_fade.temperature = ["20 degC", "120 degC", "220 degC", "320 degC", "420 degC", "520 degC", "620 degC", "720 degC"]
wear_fade.factor = [1.0, 1.1, 2.0, 6.0, 15.0, 25.0, 40.0, 60.0]
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
friction_fade.temperature = ["20 degC", "140 degC", "260 degC", "380 degC", "500 degC", "600 degC", "700 degC", "800 degC"]
friction_fade.factor = [1.0, 1.03, 0.9, 0.7, 0.5, 0.45, 0.4, 0.4]
conductance = 15e3
[holder]
constraint = "translate"
"#;
