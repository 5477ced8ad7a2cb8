//! Parameters. The start values are those of the front disc brake of examples/disc_brake without its tables, radiation, limits and
//! nominal conditions (test in `scene-file`), so that the stock FMU runs as it is.

use super::super::units::*;
use super::super::{EnumerationType, TOLERANCES};
use super::{Row, boolean, choice, integer, real};

static MECHANICAL_BODY: EnumerationType = EnumerationType {
    name: "MechanicalBody",
    description: "Elastic model of a body; every body conducts heat as a block of its own height",
    items: &[
        ("rigid", "No elastic deformation"),
        ("winkler", "Independent springs"),
        ("half_plane", "Elastic half-plane"),
        ("elastic", "Elastic body of the given height"),
    ],
};
pub(crate) static PATH: EnumerationType = EnumerationType {
    name: "Path",
    description: "Path of the punch on the strip",
    items: &[("straight", "Open track"), ("closed", "Closed track of the length strip.length")],
};
static STRIP_BASE: EnumerationType = EnumerationType {
    name: "StripBase",
    description: "Mechanical support of the strip",
    items: &[("bonded", "Fixed to a rigid base"), ("smooth", "Free to slide on a rigid base")],
};
static THERMAL_BOUNDARY: EnumerationType = EnumerationType {
    name: "ThermalBoundary",
    description: "Thermal condition of the face opposite to the contact",
    items: &[
        ("held", "Constant prescribed temperature"),
        ("convecting", "Convection to ambient air"),
        ("insulated", "Adiabatic"),
        ("external", "Temperature prescribed by an input"),
    ],
};
pub(crate) static GEOMETRY: EnumerationType = EnumerationType {
    name: "ContactGeometry",
    description: "Geometry of the contact",
    items: &[
        ("line", "x runs along the sliding direction"),
        ("annular", "x runs along the radius, velocity grows with it"),
        ("periodic", "The punch covers the whole closed path: no edges"),
    ],
};
static INITIAL_SHAPE: EnumerationType = EnumerationType {
    name: "InitialShape",
    description: "Gap between the undeformed bodies at initialisation",
    items: &[
        ("flat", "No gap"),
        ("parabolic", "Rounded with contact.initial_radius"),
        ("run_in", "Shape of the steady state at nominal conditions"),
        ("tabulated", "contact.initial_gap at 33 stations"),
    ],
};
static CONSTRAINT: EnumerationType = EnumerationType {
    name: "HolderConstraint",
    description: "Degrees of freedom of the punch in its holder",
    items: &[
        ("translate", "Approach only"),
        ("translate_and_rotate", "Approach and rotation about a pivot at holder.pivot_height"),
    ],
};
static FIDELITY: EnumerationType = EnumerationType {
    name: "Fidelity",
    description: "Model level",
    items: &[
        ("auto", "Lumped where a comparison at nominal conditions shows that it is enough, else line"),
        ("lumped", "Uniform pressure, a few thermal states"),
        ("line", "Pressure, temperature, wear and shape on cells along the contact"),
    ],
};
pub(crate) static HEAT: EnumerationType = EnumerationType {
    name: "Heat",
    description: "Heat of a contact line",
    items: &[
        ("resolved", "Flux and temperature of every cell"),
        ("mean", "One mean flux and temperature: for pressure and wear alone"),
    ],
};
static ERROR_ESTIMATE: EnumerationType = EnumerationType {
    name: "ErrorEstimate",
    description: "What estimated_error is measured with",
    items: &[
        ("automatic", "Companion where the level is chosen automatically, off where it is named"),
        ("off", "Of reduction and time steps alone"),
        ("companion", "Difference from a contact line on half of the cells on the same inputs"),
    ],
};
static TANGENTIAL_COMPLIANCE: EnumerationType = EnumerationType {
    name: "TangentialCompliance",
    description: "Elastic displacement of the bodies along the sliding direction",
    items: &[
        ("neglected", "The bodies slide by the whole sliding distance"),
        ("elastic", "They deform before they slide, by a bristle of their tangential compliance"),
    ],
};

/// Temperatures of a fade table at start; the factors beside them are 1.
const FADE_TEMPERATURES: &[f64] = &[300.0, 400.0, 500.0, 600.0, 700.0, 800.0, 900.0, 1000.0];

/// Sliding speeds of the friction table at start, m/s.
const FRICTION_SPEEDS: &[f64] = &[0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 10.0, 11.0, 12.0, 13.0, 14.0, 15.0];

/// Temperatures of a property table at start, K.
const PROPERTY_TEMPERATURES: &[f64] = &[
    300.0, 400.0, 500.0, 600.0, 700.0, 800.0, 900.0, 1000.0, 1100.0, 1200.0, 1300.0, 1400.0, 1500.0, 1600.0, 1700.0,
    1800.0,
];

/// Start value of temperatures that act only where chosen, K: 20 degC, as of the air.
const ROOM: f64 = 293.15;

/// Start values in which the two bodies differ.
struct BodyRows {
    height: f64,
    youngs_modulus: f64,
    poissons_ratio: f64,
    density: f64,
    specific_heat: f64,
    conductivity: f64,
    thermal_expansion: f64,
    wear_coefficient: f64,
    convection: f64,
    convection_forced: f64,
    body: i32,
}

const PAD: BodyRows = BodyRows {
    height: 0.012,
    youngs_modulus: 1e9,
    poissons_ratio: 0.25,
    density: 2600.0,
    specific_heat: 1000.0,
    conductivity: 1.2,
    thermal_expansion: 1.5e-5,
    wear_coefficient: 2e-14,
    convection: 10.0,
    convection_forced: 0.0,
    body: 4,
};

const DISC: BodyRows = BodyRows {
    height: 0.011,
    youngs_modulus: 1.1e11,
    poissons_ratio: 0.26,
    density: 7200.0,
    specific_heat: 460.0,
    conductivity: 54.0,
    thermal_expansion: 1.1e-5,
    wear_coefficient: 1e-15,
    convection: 10.0,
    convection_forced: 8.0,
    body: 4,
};

macro_rules! body_rows {
    ($body:literal, $start:expr) => {
        &[
            real(concat!($body, ".height"), &METRE, 1e-2, concat!("Height of the ", $body, " normal to the contact"))
                .shown("mm")
                .within(1e-6, 10.0)
                .start($start.height),
            choice(concat!($body, ".body"), &MECHANICAL_BODY, $start.body, concat!("Elastic model of the ", $body)),
            real(concat!($body, ".youngs_modulus"), &PASCAL, 1e11, concat!("Young's modulus of the ", $body))
                .of_type("ModulusOfElasticity")
                .shown("GPa")
                .within(1e3, 1e13)
                .start($start.youngs_modulus),
            real(concat!($body, ".poissons_ratio"), &ONE, 0.3, concat!("Poisson's ratio of the ", $body))
                .of_type("PoissonNumber")
                .within(0.0, 0.4999)
                .start($start.poissons_ratio),
            real(
                concat!($body, ".foundation_stiffness"),
                &PASCAL_PER_METRE,
                1e12,
                concat!(
                    "Pressure per normal displacement of the ",
                    $body,
                    " where it is winkler; 0: (lambda + 2G)/height"
                ),
            )
            .shown("MPa/mm")
            .within(0.0, 1e18),
            real(concat!($body, ".density"), &DENSITY, 1e3, concat!("Density of the ", $body))
                .shown("g/cm3")
                .within(1.0, 1e5)
                .start($start.density),
            real(concat!($body, ".specific_heat"), &SPECIFIC_HEAT, 1e3, concat!("Specific heat of the ", $body))
                .within(1.0, 1e5)
                .start($start.specific_heat),
            real(
                concat!($body, ".conductivity"),
                &CONDUCTIVITY,
                50.0,
                concat!("Thermal conductivity of the ", $body, "; 0: an insulator"),
            )
            .within(0.0, 1e5)
            // Below, the temperature of a surface has no meaning; still air has 0.026.
            .zero_or_from(1e-6)
            .start($start.conductivity),
            integer(
                concat!($body, ".property_table.points"),
                0,
                PROPERTY_TEMPERATURES.len() as i32,
                0,
                concat!(
                    "Number of points of the table of conductivity and specific heat of the ",
                    $body,
                    " over temperature, which replaces both constants; 0: none"
                ),
            ),
            real(
                concat!($body, ".property_table.temperature"),
                &KELVIN,
                500.0,
                concat!(
                    "Temperatures of the property table of the ",
                    $body,
                    ", increasing; those behind the last point are not used"
                ),
            )
            .shown("degC")
            .within(0.0, 1e5)
            .starts(PROPERTY_TEMPERATURES)
            .may_be_shorter(),
            real(
                concat!($body, ".property_table.conductivity"),
                &CONDUCTIVITY,
                50.0,
                concat!(
                    "Thermal conductivities of the ",
                    $body,
                    " at these temperatures, linear between, constant beyond the ends"
                ),
            )
            .within(1e-6, 1e5)
            .array(PROPERTY_TEMPERATURES.len() as u32)
            .start(50.0)
            .may_be_shorter(),
            real(
                concat!($body, ".property_table.specific_heat"),
                &SPECIFIC_HEAT,
                1e3,
                concat!(
                    "Specific heats of the ",
                    $body,
                    " at these temperatures, linear between, constant beyond the ends"
                ),
            )
            .within(1.0, 1e5)
            .array(PROPERTY_TEMPERATURES.len() as u32)
            .start(500.0)
            .may_be_shorter(),
            real(
                concat!($body, ".thermal_expansion"),
                &PER_KELVIN,
                1e-5,
                concat!("Linear thermal expansion of the ", $body, "; 0 in both bodies switches distortion off"),
            )
            .shown("um/(m.K)")
            .within(0.0, 1e-2)
            .start($start.thermal_expansion),
            real(
                concat!($body, ".wear_coefficient"),
                &SQUARE_METRE_PER_NEWTON,
                1e-14,
                concat!(
                    "Wear coefficient k of the ",
                    $body,
                    ": depth rate k p0 v0 (p/p0)^b (v/v0)^a with p0 = 1 MPa and v0 = 1 m/s; 0 switches its wear off"
                ),
            )
            .shown("mm3/(N.m)")
            .within(0.0, 1e-6)
            .start($start.wear_coefficient)
            .tunable(),
            real(
                concat!($body, ".wear_pressure_exponent"),
                &ONE,
                1.0,
                concat!("Exponent b of the pressure in the wear law of the ", $body),
            )
            .within(0.3, 3.0)
            .start(1.0),
            real(
                concat!($body, ".wear_threshold"),
                &PASCAL,
                1e6,
                concat!(
                    "Pressure up to which the ",
                    $body,
                    " does not wear; above it p less the threshold takes the place of p in the wear law"
                ),
            )
            .shown("MPa")
            .within(0.0, 1e10),
            real(
                concat!($body, ".wear_velocity_exponent"),
                &ONE,
                1.0,
                concat!("Exponent a of the velocity in the wear law of the ", $body),
            )
            .within(0.0, 2.0)
            .start(1.0),
            real(
                concat!($body, ".wear_fade.temperature"),
                &KELVIN,
                500.0,
                concat!("Temperatures, increasing, of the table that multiplies the wear coefficient of the ", $body),
            )
            .shown("degC")
            .within(0.0, 1e5)
            .starts(FADE_TEMPERATURES)
            .may_be_shorter(),
            real(
                concat!($body, ".wear_fade.factor"),
                &ONE,
                1.0,
                concat!("Factors of the table that multiplies the wear coefficient of the ", $body, ", linear between"),
            )
            .within(0.0, 1e3)
            .array(8)
            .start(1.0)
            .may_be_shorter(),
            real(
                concat!($body, ".initial_wear"),
                &METRE,
                1e-3,
                concat!("Depth already worn off the ", $body, " at start; counts against its limit"),
            )
            .shown("mm")
            .within(0.0, 1.0),
            real(
                concat!($body, ".wear_limit"),
                &METRE,
                1e-3,
                concat!("Worn depth of the ", $body, " at which its life ends; 0: no limit"),
            )
            .shown("mm")
            .within(0.0, 1.0),
            boolean(
                concat!($body, ".initial_at_ambient"),
                true,
                concat!("Whether the ", $body, " has the ambient temperature at initialisation"),
            ),
            real(
                concat!($body, ".initial_temperature"),
                &KELVIN,
                300.0,
                concat!(
                    "Temperature of the ",
                    $body,
                    " at initialisation where ",
                    $body,
                    ".initial_at_ambient = false"
                ),
            )
            .within(1.0, 1e4)
            .start(ROOM)
            .instead_of_zero(concat!($body, ".initial_at_ambient = true")),
            real(
                concat!($body, ".convection"),
                &HEAT_TRANSFER,
                10.0,
                concat!("Heat transfer coefficient from the free surfaces of the ", $body, " to ambient air"),
            )
            .within(0.0, 1e6)
            .start($start.convection)
            .tunable(),
            real(
                concat!($body, ".convection_forced"),
                &HEAT_TRANSFER,
                10.0,
                concat!(
                    "Forced part of the heat transfer coefficient of the ",
                    $body,
                    ", times (v_c/v0)^0.8, v_c = abs(sliding velocity) + cooling_velocity, v0 = 1 m/s"
                ),
            )
            .within(0.0, 1e6)
            .start($start.convection_forced),
            real(
                concat!($body, ".emissivity"),
                &ONE,
                0.5,
                concat!("Emissivity of the free surfaces of the ", $body, "; 0: no radiation"),
            )
            .of_type("Emissivity")
            .within(0.0, 1.0),
            real(
                concat!($body, ".cooled_area"),
                &SQUARE_METRE,
                1e-2,
                concat!(
                    "Cooled area of the ",
                    $body,
                    " beside the contact, per face, without top and base; 0: from the geometry"
                ),
            )
            .shown("cm2")
            .within(0.0, 1e4),
            real(
                concat!($body, ".external_conductance"),
                &CONDUCTANCE,
                10.0,
                concat!(
                    "Conductance of the heat path from the face of the ",
                    $body,
                    " opposite to the contact (insulated or convecting) to ",
                    $body,
                    ".external_temperature, all faces and punches together; 0: none"
                ),
            )
            .within(0.0, 1e9)
            .tunable(),
            real(
                concat!($body, ".airborne_fraction"),
                &ONE,
                1.0,
                concat!("Fraction of the mass worn off the ", $body, " that becomes airborne; 0: not counted"),
            )
            .within(0.0, 1.0),
        ]
    };
}

const PUNCH_BODY: &[Row] = body_rows!("punch", PAD);
const STRIP_BODY: &[Row] = body_rows!("strip", DISC);

/// The rows of `body`, then those of `more`; N is their number.
const fn joined<const N: usize>(body: &[Row], more: &[Row]) -> [Row; N] {
    assert!(body.len() + more.len() == N);
    let mut rows = [body[0]; N];
    let mut index = 0;
    while index < N {
        rows[index] = if index < body.len() { body[index] } else { more[index - body.len()] };
        index += 1;
    }
    rows
}

pub(crate) const PUNCH: &[Row] = &joined::<{ PUNCH_BODY.len() + PUNCH_OWN.len() }>(PUNCH_BODY, PUNCH_OWN);

const PUNCH_OWN: &[Row] = &[
    real("punch.width", &METRE, 1e-2, "Width of the punch along the sliding direction (annular: along the radius)")
        .shown("mm")
        .within(1e-6, 10.0)
        .start(0.095),
    choice("punch.top_thermal", &THERMAL_BOUNDARY, 2, "Thermal condition at the punch's top"),
    boolean("punch.top_at_ambient", true, "Whether a held top of the punch has the ambient temperature"),
    real(
        "punch.top_temperature",
        &KELVIN,
        300.0,
        "Temperature of the punch's top where it is held and punch.top_at_ambient = false",
    )
    .within(1.0, 1e4)
    .start(ROOM)
    .instead_of_zero("punch.top_at_ambient = true"),
    integer(
        "punch.count",
        1,
        1000,
        1,
        "Equal punches spread over a closed path; they share the normal load of their face",
    ),
];

pub(crate) const STRIP: &[Row] = &joined::<{ STRIP_BODY.len() + STRIP_OWN.len() }>(STRIP_BODY, STRIP_OWN);

const STRIP_OWN: &[Row] = &[
    choice("strip.path", &PATH, 2, "Path of the punch on the strip"),
    real("strip.length", &METRE, 1.0, "Circumference of a closed path; 0: 2 pi contact.mean_radius")
        .shown("mm")
        .within(0.0, 1e5),
    choice("strip.base", &STRIP_BASE, 1, "Mechanical support of the strip"),
    choice("strip.base_thermal", &THERMAL_BOUNDARY, 3, "Thermal condition at the strip's base"),
    boolean("strip.base_at_ambient", true, "Whether a held base of the strip has the ambient temperature"),
    real(
        "strip.base_temperature",
        &KELVIN,
        300.0,
        "Temperature of the strip's base where it is held and strip.base_at_ambient = false",
    )
    .within(1.0, 1e4)
    .start(ROOM)
    .instead_of_zero("strip.base_at_ambient = true"),
];

pub(crate) const CONTACT: &[Row] = &[
    real("depth", &METRE, 1e-2, "Out-of-plane depth of both bodies (annular: arc length at the mean radius)")
        .shown("mm")
        .within(1e-6, 100.0)
        .start(0.055),
    choice("contact.geometry", &GEOMETRY, 1, "Geometry of the contact"),
    real("contact.mean_radius", &METRE, 0.1, "Mean radius of the track").shown("mm").within(0.0, 1e3).start(0.1175),
    boolean("contact.shear_coupling", true, "Whether friction shear displaces the surfaces normally"),
    integer(
        "contact.faces",
        1,
        1000,
        2,
        "Faces in contact: scales force, torque, power, heat flows and volumes; pressure, temperature and depth are per face",
    ),
    real("contact.friction_coefficient", &ONE, 0.3, "Friction coefficient before fade and Stribeck effect")
        .of_type("CoefficientOfFriction")
        .within(0.0, 10.0)
        .start(0.4)
        .tunable(),
    real(
        "contact.friction_fade.temperature",
        &KELVIN,
        500.0,
        "Temperatures, increasing, of the table that multiplies the friction coefficient",
    )
    .shown("degC")
    .within(0.0, 1e5)
    .starts(FADE_TEMPERATURES)
    .may_be_shorter(),
    real(
        "contact.friction_fade.factor",
        &ONE,
        1.0,
        "Factors of the table that multiplies the friction coefficient, linear between",
    )
    .within(0.0, 1e3)
    .array(8)
    .start(1.0)
    .may_be_shorter(),
    real(
        "contact.static_friction_ratio",
        &ONE,
        1.0,
        "Ratio r of the Stribeck factor 1 + (r - 1) exp(-|v|/v_s); 1: off",
    )
    .within(0.1, 10.0)
    .start(1.0),
    real("contact.stribeck_velocity", &METRE_PER_SECOND, 0.1, "Velocity v_s of the Stribeck factor")
        .within(1e-6, 1e3)
        .start(0.05),
    integer(
        "contact.friction_table.points",
        0,
        FRICTION_SPEEDS.len() as i32,
        0,
        "Number of points of the table of the friction coefficient over sliding speed, which replaces the Stribeck factor; 0: none",
    ),
    real(
        "contact.friction_table.speed",
        &METRE_PER_SECOND,
        10.0,
        "Sliding speeds of the friction table, increasing, the first 0; those behind the last point are not used",
    )
    .of_type("Velocity")
    .within(0.0, 1e4)
    .starts(FRICTION_SPEEDS)
    .may_be_shorter(),
    real(
        "contact.friction_table.coefficient",
        &ONE,
        0.3,
        "Friction coefficients at these speeds before fade, where contact.friction_coefficient is as at initialisation; \
         between them a monotone cubic with continuous slope, constant above the last",
    )
    .of_type("CoefficientOfFriction")
    .within(0.0, 10.0)
    .array(FRICTION_SPEEDS.len() as u32)
    .start(0.4)
    .may_be_shorter(),
    real(
        "contact.regularization_velocity",
        &METRE_PER_SECOND,
        0.01,
        "Velocity v_reg in v/sqrt(v^2 + v_reg^2), which replaces the sign of the velocity; 0: exact sign",
    )
    .within(0.0, 1e2),
    real(
        "contact.stick_stiffness",
        &NEWTON_PER_METRE,
        1e7,
        "Bristle stiffness of the friction model in stick, all faces together; 0: off",
    )
    .within(0.0, 1e15),
    real(
        "contact.stick_damping",
        &NEWTON_SECOND_PER_METRE,
        1e4,
        "Damping of the bristle, all faces together; an explicit master of step h on a mass m is stable while sticking for \
         h stick_stiffness < stick_damping < 2 m/h - h stick_stiffness/2",
    )
    .within(0.0, 1e12),
    choice(
        "contact.tangential_compliance",
        &TANGENTIAL_COMPLIANCE,
        1,
        "Whether the bodies deform along the sliding direction before they slide; in series with contact.stick_stiffness",
    ),
    real(
        "contact.conductance",
        &HEAT_TRANSFER,
        1e4,
        "Thermal contact conductance h_c between the two surfaces; 0: insulating",
    )
    .within(0.0, 1e15)
    .start(2e4)
    .tunable(),
    choice("contact.initial_shape", &INITIAL_SHAPE, 1, "Gap between the undeformed bodies at initialisation"),
    real("contact.initial_radius", &METRE, 1.0, "Radius of the parabolic initial shape").within(0.0, 1e6).start(1.0),
    real("contact.initial_gap", &METRE, 1e-6, "Tabulated initial gap at the 33 stations of profile.x")
        .shown("um")
        .within(0.0, 1.0)
        .array(33),
    boolean("contact.temperature_limited", false, "Whether contact_temperature_max has the limit contact.temperature_limit"),
    real(
        "contact.temperature_limit",
        &KELVIN,
        1000.0,
        "Limit of contact_temperature_max, above which temperature_limit_exceeded is set, where contact.temperature_limited = true",
    )
    .within(1.0, 1e5)
    .start(1000.0)
    .instead_of_zero("contact.temperature_limited = false"),
];

pub(crate) const HOLDER_AND_SOLVER: &[Row] = &[
    choice("holder.constraint", &CONSTRAINT, 1, "Degrees of freedom of the punch in its holder"),
    real("holder.pivot_height", &METRE, 1e-2, "Height of the pivot above the contact").shown("mm").within(0.0, 10.0),
    real(
        "holder.stiffness",
        &NEWTON_PER_METRE,
        1e8,
        "Stiffness of the caliper between actuator and punch, per face; 0: dead load",
    )
    .within(0.0, 1e15),
    real("ambient_temperature", &KELVIN, 300.0, "Ambient temperature")
        .shown("degC")
        .within(1.0, 1e4)
        .start(ROOM)
        .tunable(),
    real("nominal.load", &NEWTON, 1e3, "Nominal normal load per face, at which solver.fidelity = auto compares levels")
        .shown("kN")
        .within(0.0, 1e9)
        .start(5e3),
    real("nominal.velocity", &METRE_PER_SECOND, 10.0, "Nominal sliding velocity (mean speed if reciprocating)")
        .within(0.0, 1e4)
        .start(10.0),
    real(
        "nominal.duration",
        &SECOND,
        1e3,
        "Total time for which nominal load and velocity act",
    )
    .within(1e-6, 1e10)
    .start(4.0),
    real("nominal.stroke", &METRE, 1e-2, "Length of one stroke of reciprocating sliding; 0: unidirectional")
        .shown("mm")
        .within(0.0, 1e4),
    choice("solver.fidelity", &FIDELITY, 1, "Model level"),
    choice("solver.heat", &HEAT, 1, "Heat of a contact line"),
    choice("solver.error_estimate", &ERROR_ESTIMATE, 1, "What estimated_error is measured with"),
    integer(
        "solver.cells",
        0,
        1025,
        0,
        "Number of cells of the contact line; 0: 17 down to a tolerance of 5e-3, 33 to 5e-4, 65 to 5e-5, 129 below",
    ),
    real(
        "solver.tolerance",
        &ONE,
        1e-3,
        "Relative tolerance, at least 1e-10; 0: the importer's if it gives one, else that of the scene's DefaultExperiment",
    )
    .within(0.0, *TOLERANCES.end())
    .zero_or_from(*TOLERANCES.start()),
    real("wear_acceleration", &ONE, 1.0, "Multiplies wear only; not time, energy or distance")
        .within(1e-9, 1e9)
        .start(1.0)
        .tunable(),
];
