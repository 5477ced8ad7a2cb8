//! The table of hostile cases.

use std::panic::{self, AssertUnwindSafe};
use std::ptr;

use scene::fnv::Fnv;
use sliding_contact::fmi2::exports::*;
use sliding_contact::fmi2::types::Status::{self, Discard, Error, Ok};

use crate::importer::{Importer, reference};
use crate::run::Call::{Initialise, Other, Set, Slope, Step, StepFrom, Steps};
use crate::run::From::{Instantiated, Stepping};
use crate::run::{Call, Case, Level, Runner};

const NAN: f64 = f64::NAN;
const INFINITE: f64 = f64::INFINITY;

// Items of enumerations.
const RIGID: f64 = 1.0;
const STRAIGHT: f64 = 1.0;
const ANNULAR: f64 = 2.0;
const PERIODIC: f64 = 3.0;
const PARABOLIC: f64 = 2.0;
const RUN_IN: f64 = 3.0;
const TABULATED: f64 = 4.0;
const ROTATE: f64 = 2.0;
const HELD: f64 = 1.0;
const CONVECTING: f64 = 2.0;
const EXTERNAL: f64 = 4.0;
const STAGGERED: f64 = 2.0;
const LINE: f64 = 3.0;
const FIELD: f64 = 4.0;

const LUMPED: &[Level] = &[Level::Lumped];
const HOT: &[Level] = &[Level::Hot];
const CELLS: &[Level] = &[Level::Cold, Level::Hot];
const EACH: &[Level] = &[Level::Lumped, Level::Cold, Level::Hot];
const ALL: &[Level] = &[Level::Lumped, Level::Cold, Level::Hot, Level::Auto];

type Says = &'static [&'static str];
type Calls = &'static [Call];

/// While stepping.
const fn stepping(what: &'static str, levels: &'static [Level], calls: Calls, status: Status, says: Says) -> Case {
    Case { what, levels, example: "", scene: &[], from: Stepping, calls, status, says }
}

/// Before initialisation.
const fn before(what: &'static str, levels: &'static [Level], calls: Calls, status: Status, says: Says) -> Case {
    Case { what, levels, example: "", scene: &[], from: Instantiated, calls, status, says }
}

impl Case {
    const fn of(self, scene: &'static [(&'static str, f64)]) -> Case {
        Case { scene, ..self }
    }
    const fn example(self, example: &'static str) -> Case {
        Case { example, ..self }
    }
}

const V: &str = "sliding_velocity";
const F: &str = "normal_load";
const BRISTLE: &[(&str, f64)] = &[("contact.stick_stiffness", 1e7), ("contact.stick_damping", 1e3)];

const NO_NUMBERS: &[Case] = &[
    stepping("velocity NaN", ALL, &[Set(V, NAN), Step(0.01)], Error, &["sliding_velocity = NaN is not a finite"]),
    stepping("velocity infinite", EACH, &[Set(V, INFINITE), Step(0.01)], Error, &["sliding_velocity = inf"]),
    stepping("load NaN", ALL, &[Set(F, NAN), Step(0.01)], Error, &["normal_load = NaN is not a finite"]),
    stepping("load minus infinite", EACH, &[Set(F, -INFINITE), Step(0.01)], Error, &["normal_load = -inf"]),
    stepping(
        "angular velocity NaN",
        EACH,
        &[Set("angular_velocity", NAN), Step(0.01)],
        Error,
        &["angular_velocity = NaN"],
    ),
    stepping(
        "ambient offset NaN",
        EACH,
        &[Set("ambient_temperature_offset", NAN), Step(0.01)],
        Error,
        &["ambient_temperature_offset = NaN"],
    ),
    stepping(
        "air speed infinite",
        EACH,
        &[Set("cooling_velocity", INFINITE), Step(0.01)],
        Error,
        &["cooling_velocity = inf"],
    ),
    stepping(
        "external temperature NaN, where it acts",
        EACH,
        &[Set("punch.external_temperature", NAN), Step(0.01)],
        Error,
        &["punch.external_temperature = NaN"],
    )
    .of(&[
        ("punch.external_conductance", 1.0),
        ("punch.top_thermal", CONVECTING),
        ("punch.external_temperature", 300.0),
    ]),
    stepping(
        "external temperature NaN, where it does not act",
        EACH,
        &[Set("strip.external_temperature", NAN), Step(0.01)],
        Error,
        &["strip.external_temperature = NaN"],
    ),
    stepping(
        "derivative NaN",
        EACH,
        &[Slope(V, NAN), Step(0.01)],
        Error,
        &["the derivative of sliding_velocity = NaN"],
    ),
    stepping(
        "derivative infinite",
        EACH,
        &[Slope(F, INFINITE), Step(0.01)],
        Error,
        &["the derivative of normal_load = inf"],
    ),
    before("input NaN at initialisation", EACH, &[Set(F, NAN), Initialise], Error, &["normal_load = NaN"]),
];

const BEYOND: &[Case] = &[
    stepping(
        "velocity of 2e12 m/s",
        EACH,
        &[Set(V, 2e12), Step(0.01)],
        Error,
        &["sliding_velocity = 2e12 m/s", "1e12 m/s"],
    ),
    stepping(
        "velocity of -1e300 m/s",
        EACH,
        &[Set(V, -1e300), Step(0.01)],
        Error,
        &["sliding_velocity = -1e300 m/s", "-1e12"],
    ),
    stepping("load of 2e12 N", EACH, &[Set(F, 2e12), Step(0.01)], Error, &["normal_load = 2e12 N", "1e12 N"]),
    stepping("load of -1e300 N", EACH, &[Set(F, -1e300), Step(0.01)], Error, &["normal_load = -1e300 N", "-1e12 N"]),
    stepping(
        "a load that passes the limit within the step",
        EACH,
        &[Slope(F, 1e15), Step(0.01)],
        Error,
        &["normal_load = ", "at the end of the step", "1e12 N"],
    ),
    stepping(
        "angular velocity of 1e13 rad/s",
        EACH,
        &[Set("angular_velocity", 1e13), Step(0.01)],
        Error,
        &["angular_velocity = 1e13 rad/s", "1e12 rad/s"],
    ),
    stepping(
        "ambient at 0 K",
        EACH,
        &[Set("ambient_temperature_offset", -293.15), Step(0.01)],
        Error,
        &["ambient_temperature_offset = -293.15 K", "above 0 K"],
    ),
    stepping(
        "ambient below 0 K",
        ALL,
        &[Set("ambient_temperature_offset", -300.0), Step(0.01)],
        Error,
        &["ambient_temperature_offset = -300 K", "-6.85", "above 0 K"],
    ),
    stepping(
        "ambient that falls below 0 K within the step",
        EACH,
        &[Slope("ambient_temperature_offset", -1e5), Step(0.01)],
        Error,
        &["ambient_temperature_offset = -1000 K", "above 0 K"],
    ),
    before(
        "ambient below 0 K at initialisation",
        EACH,
        &[Set("ambient_temperature_offset", -300.0), Initialise],
        Error,
        &["ambient_temperature_offset = -300 K", "above 0 K"],
    ),
    before(
        "an external temperature that is not given",
        EACH,
        &[Set("punch.top_thermal", EXTERNAL), Initialise],
        Error,
        &["punch.external_temperature = 0 K must be above 0 K", "punch.top_thermal = external"],
    ),
    before(
        "an external temperature below 0 K that falls within the step",
        EACH,
        &[
            Set("punch.top_thermal", EXTERNAL),
            Set("punch.external_temperature", 300.0),
            Initialise,
            Slope("punch.external_temperature", -1e5),
            Step(0.01),
        ],
        Error,
        &["punch.external_temperature = -700 K must be above 0 K"],
    ),
    before(
        "a neighbour at 0 K",
        EACH,
        &[Set("strip.external_conductance", 5.0), Initialise],
        Error,
        &["strip.external_temperature = 0 K must be above 0 K", "strip.external_conductance = 5 W/K"],
    ),
];

const EXTREME: &[Case] = &[
    stepping("velocity 5e-324 m/s", EACH, &[Set(V, 5e-324), Step(0.01)], Ok, &[]),
    stepping("velocity 1e-300 m/s", EACH, &[Set(V, 1e-300), Step(0.01)], Ok, &[]),
    stepping("velocity -0", EACH, &[Set(V, -0.0), Step(0.01)], Ok, &[]),
    stepping("load 5e-324 N", EACH, &[Set(F, 5e-324), Step(0.01)], Ok, &[]),
    stepping("load 1e-300 N", EACH, &[Set(F, 1e-300), Step(0.01)], Ok, &[]),
    stepping("load 0", ALL, &[Set(F, 0.0), Step(0.01), Step(1.0)], Ok, &[]),
    stepping("velocity and load 0", EACH, &[Set(V, 0.0), Set(F, 0.0), Step(0.01), Step(10.0)], Ok, &[]),
    stepping(
        "load below 0",
        EACH,
        &[Set(F, -5.0), Step(0.01)],
        Ok,
        &["normal_load = -5 N is below 0 N and counts as 0"],
    ),
    stepping(
        "a load that falls through 0",
        EACH,
        &[Slope(F, -4e5), Step(0.01)],
        Ok,
        &["normal_load = -2000 N", "counts as 0"],
    ),
    stepping(
        "a load that rises through 0",
        EACH,
        &[Set(F, -2e3), Step(0.01), Slope(F, 4e5), Step(0.01)],
        Ok,
        &["normal_load = -2000 N", "counts as 0"],
    ),
    stepping("a slope that reverses the velocity", EACH, &[Slope(V, -400.0), Step(0.01)], Ok, &[]),
    stepping(
        "velocity and load through 0 at once",
        EACH,
        &[Slope(V, -400.0), Slope(F, -4e5), Step(0.01)],
        Ok,
        &["counts as 0"],
    ),
    stepping(
        "velocity and load through 0 at different times",
        EACH,
        &[Slope(V, -800.0), Slope(F, -3e5), Step(0.01)],
        Ok,
        &[],
    ),
    stepping("reversal at rest", ALL, &[Set(V, 0.0), Step(0.01), Set(V, -2.0), Step(0.01)], Ok, &[]),
    stepping(
        "reversal at rest with a bristle",
        EACH,
        &[Set(V, 0.0), Step(0.01), Step(1.0), Set(V, -2.0), Step(0.01)],
        Ok,
        &[],
    )
    .of(BRISTLE),
    stepping("reversal by a slope with a bristle", EACH, &[Slope(V, -400.0), Step(0.01)], Ok, &[]).of(BRISTLE),
    stepping("a jump from 1e4 to -1e4 m/s", EACH, &[Set(V, 1e4), Step(1e-6), Set(V, -1e4), Step(1e-6)], Ok, &[]),
    stepping("a jump of the load by six decades", EACH, &[Set(F, 1e-3), Step(0.01), Set(F, 1e3), Step(0.01)], Ok, &[]),
    stepping("a slope of 1e9 m/s2 over a picosecond", EACH, &[Slope(V, 1e9), Step(1e-12)], Ok, &[]),
    stepping("air at -1e3 m/s", EACH, &[Set("cooling_velocity", -1e3), Step(0.01)], Ok, &[]),
    stepping(
        "velocity given twice",
        EACH,
        &[Set("angular_velocity", 10.0), Step(0.01)],
        Ok,
        &["sliding_velocity = 2 m/s and angular_velocity = 10 rad/s are both given"],
    ),
    stepping("ambient of 1 mK", EACH, &[Set("ambient_temperature_offset", -293.149), Step(0.01)], Ok, &[]),
    stepping(
        "surroundings of 1e4 K on a radiating punch",
        EACH,
        &[Set("ambient_temperature_offset", 9700.0), Step(0.01)],
        Ok,
        &[],
    )
    .of(&[("punch.emissivity", 0.6)]),
    stepping("velocity and load at their limits", EACH, &[Set(V, 1e12), Set(F, 1e12), Step(0.01)], Error, &[]),
    stepping("velocity at its limit without load", EACH, &[Set(V, 1e12), Set(F, 0.0), Step(0.01)], Ok, &[]),
    stepping(
        "load at its limit at rest",
        EACH,
        &[Set(V, 0.0), Set(F, 1e12), Step(0.01)],
        Ok,
        &["outside the model's validity"],
    ),
];

const STEPS: &[Case] = &[
    stepping("a step of 0", ALL, &[Step(0.0)], Ok, &[]),
    stepping("a step of -0", EACH, &[Step(-0.0)], Ok, &[]),
    stepping("a step of 0 with a derivative", EACH, &[Slope(V, 1e3), Step(0.0)], Ok, &[]),
    stepping("a step of -0.01 s", EACH, &[Step(-0.01)], Error, &["the step -0.01 s must be a finite number >= 0"]),
    stepping("a step of NaN", EACH, &[Step(NAN)], Error, &["the step NaN s must be a finite number >= 0"]),
    stepping("an infinite step", EACH, &[Step(INFINITE)], Error, &["the step inf s must be a finite number >= 0"]),
    stepping("a step of 1e-310 s", EACH, &[Step(1e-310)], Error, &["1e-310 s", "shorter than 1e-24 s"]),
    stepping("the shortest step", EACH, &[Step(1e-24)], Ok, &[]),
    stepping("a step of a picosecond", EACH, &[Step(1e-12)], Ok, &[]),
    stepping("a step of 1e300 s", EACH, &[Step(1e300)], Error, &["1e300 s", "longer than 1e9 s"]),
    stepping("a step a little too long", EACH, &[Step(1.1e9)], Error, &["1.1e9 s", "longer than 1e9 s"]),
    stepping("the longest step, at rest", EACH, &[Set(V, 0.0), Step(1e9)], Ok, &[]),
    stepping("a step from a point ahead", EACH, &[StepFrom(1.0, 0.01)], Error, &["communication point 1 s", "0.03"]),
    stepping("a step from NaN", EACH, &[StepFrom(NAN, 0.01)], Error, &["communication point NaN s"]),
    before(
        "a step past the stop time",
        EACH,
        &[Other(|x| x.setup(None, 0.0, Some(1.0))), Initialise, Step(1.1)],
        Error,
        &["1.1 s", "stop time 1 s"],
    ),
    before(
        "a start at 1e15 s, whose rounding is longer than the step",
        EACH,
        &[Other(|x| x.setup(None, 1e15, None)), Initialise, Step(1e-3), Step(1e-3)],
        Ok,
        &[],
    ),
];

const PARAMETERS: &[Case] = &[
    before(
        "a length below its minimum",
        LUMPED,
        &[Set("punch.height", -1.0)],
        Discard,
        &["punch.height: -1 m", "minimum 1e-6 m"],
    ),
    before(
        "a length above its maximum",
        LUMPED,
        &[Set("punch.width", 11.0)],
        Discard,
        &["punch.width: 11 m", "maximum 10 m"],
    ),
    before("a parameter NaN", LUMPED, &[Set("depth", NAN)], Discard, &["depth: NaN is not a finite number"]),
    before(
        "Poisson's ratio of a half",
        LUMPED,
        &[Set("punch.poissons_ratio", 0.5)],
        Discard,
        &["punch.poissons_ratio: 0.5", "0.4999"],
    ),
    before(
        "an item that does not exist",
        LUMPED,
        &[Set("strip.path", 3.0)],
        Discard,
        &["strip.path: 3", "1 = straight"],
    ),
    before("a Boolean of 2", LUMPED, &[Set("contact.shear_coupling", 2.0)], Discard, &["contact.shear_coupling: 2"]),
    before("too many cells", LUMPED, &[Set("solver.cells", 1026.0)], Discard, &["solver.cells: 1026", "maximum 1025"]),
    before(
        "a tolerance of 1e-11",
        LUMPED,
        &[Set("solver.tolerance", 1e-11)],
        Discard,
        &["solver.tolerance: 1e-11", "1e-10"],
    ),
    before(
        "0 K for the ambient",
        LUMPED,
        &[Set("ambient_temperature", 0.0)],
        Discard,
        &["ambient_temperature: 0 K", "minimum 1 K"],
    ),
    stepping(
        "negative friction",
        EACH,
        &[Set("contact.friction_coefficient", -0.1)],
        Discard,
        &["contact.friction_coefficient: -0.1", "minimum 0"],
    ),
    stepping(
        "friction NaN",
        EACH,
        &[Set("contact.friction_coefficient", NAN)],
        Discard,
        &["contact.friction_coefficient: NaN"],
    ),
    stepping("friction of 10", EACH, &[Set("contact.friction_coefficient", 10.0), Step(0.01)], Ok, &[]),
    stepping("no friction any more", EACH, &[Set("contact.friction_coefficient", 0.0), Step(0.01)], Ok, &[]),
    stepping(
        "wear slowed down",
        EACH,
        &[Set("wear_acceleration", 0.5)],
        Discard,
        &["wear_acceleration: 0.5", "minimum 1"],
    ),
    stepping(
        "wear a billion times as fast",
        &[Level::Lumped, Level::Cold],
        &[Set("wear_acceleration", 1e9), Step(1.0)],
        Error,
        &["worn through", "punch.height = 0.012 m"],
    ),
    stepping(
        "wear so fast that it hides instability",
        HOT,
        &[Set("wear_acceleration", 1e6), Step(1.0)],
        Error,
        &["wear_acceleration = 1e6 hides thermoelastic instability", "11948.1", "the limit is 0.5"],
    ),
    stepping(
        "a fixed parameter while stepping",
        EACH,
        &[Set("punch.height", 0.02)],
        Error,
        &["punch.height is a fixed parameter"],
    ),
];

const GEOMETRY: &[Case] = &[
    before(
        "a closed path without a length",
        EACH,
        &[Set("contact.mean_radius", 0.0), Initialise],
        Error,
        &["strip.length", "contact.mean_radius", "both are 0"],
    ),
    before(
        "a punch wider than the strip",
        ALL,
        &[Set("strip.length", 0.05), Initialise],
        Error,
        &["punch.width = 0.095 m", "strip.length = 0.05 m"],
    ),
    before(
        "more punches than there is room for",
        EACH,
        &[Set("punch.count", 8.0), Initialise],
        Error,
        &["punch.count", "0.76 m", "strip.length = 0.738"],
    ),
    before(
        "two punches on a straight track",
        EACH,
        &[Set("strip.path", STRAIGHT), Set("punch.count", 2.0), Initialise],
        Error,
        &["punch.count = 2 needs strip.path = closed"],
    ),
    before(
        "a straight track shorter than punch and stroke",
        EACH,
        &[Set("strip.path", STRAIGHT), Set("strip.length", 0.1), Set("nominal.stroke", 0.01), Initialise],
        Error,
        &["strip.length = 0.1 m", "nominal.stroke = 0.105 m"],
    ),
    before(
        "an annulus on a straight track",
        EACH,
        &[Set("contact.geometry", ANNULAR), Set("strip.path", STRAIGHT), Initialise],
        Error,
        &["annular needs strip.path = closed"],
    ),
    before(
        "an annulus whose inner radius is negative",
        EACH,
        &[Set("contact.geometry", ANNULAR), Set("contact.mean_radius", 0.04), Initialise],
        Error,
        &["contact.mean_radius = 0.04 m", "punch.width/2 = 0.0475 m"],
    ),
    before(
        "annular punches longer than the circumference",
        EACH,
        &[Set("contact.geometry", ANNULAR), Set("depth", 0.8), Initialise],
        Error,
        &["punch.count x depth = 0.8 m", "0.738"],
    ),
    before(
        "an annulus of two radii",
        EACH,
        &[Set("contact.geometry", ANNULAR), Set("strip.length", 0.7), Initialise],
        Error,
        &["strip.length = 0.7 m differs", "0.738"],
    ),
    before(
        "a periodic contact that does not cover the path",
        EACH,
        &[Set("contact.geometry", PERIODIC), Initialise],
        Error,
        &["punch.width = 0.095 m", "strip.length = 0.738"],
    ),
    before(
        "a periodic contact that rotates",
        EACH,
        &[Set("contact.geometry", PERIODIC), Set("strip.length", 0.095), Set("holder.constraint", ROTATE), Initialise],
        Error,
        &["contact.geometry = periodic", "holder.constraint must be translate"],
    ),
    before(
        "a periodic contact",
        EACH,
        &[
            Set("contact.geometry", PERIODIC),
            Set("strip.length", 0.095),
            Initialise,
            Set(F, 2e3),
            Set(V, 0.5),
            Step(0.01),
            Slope(V, -100.0),
            Step(0.01),
        ],
        Ok,
        &[],
    ),
    before(
        "a run-in periodic contact above its critical speed",
        CELLS,
        &[
            Set("contact.geometry", PERIODIC),
            Set("strip.length", 0.095),
            Set("contact.mean_radius", 0.01512),
            Set("contact.initial_shape", RUN_IN),
            Initialise,
        ],
        Error,
        &["no steady state"],
    )
    .example("disc_brake"),
    before(
        "a punch that tips over",
        EACH,
        &[Set("holder.constraint", ROTATE), Set("holder.pivot_height", 0.2), Initialise],
        Error,
        &["holder.pivot_height = 0.08 m", "punch.width/2 = 0.0475 m"],
    ),
    before(
        "a rounded punch without a radius",
        EACH,
        &[Set("contact.initial_shape", PARABOLIC), Set("contact.initial_radius", 0.0), Initialise],
        Error,
        &["contact.initial_radius > 0 m; it is 0"],
    ),
    before(
        "a gap of 1 m at one station",
        CELLS,
        &[
            Set("contact.initial_shape", TABULATED),
            Set("contact.initial_gap[17]", 1.0),
            Initialise,
            Set(F, 2e3),
            Set(V, 1.0),
            Step(0.01),
        ],
        Ok,
        &[],
    ),
    before(
        "a radius of a micrometre",
        CELLS,
        &[
            Set("contact.initial_shape", PARABOLIC),
            Set("contact.initial_radius", 1e-6),
            Initialise,
            Set(F, 2e3),
            Set(V, 1.0),
            Step(0.01),
        ],
        Ok,
        &[],
    ),
    before(
        "a punch of a micrometre",
        LUMPED,
        &[Set("punch.width", 1e-6), Initialise, Set(F, 1e-3), Set(V, 1.0), Step(0.01)],
        Ok,
        &[],
    ),
    before(
        "a slender punch on cells",
        CELLS,
        &[Set("punch.width", 1e-6), Initialise],
        Error,
        &["punch.height = 0.012 m and punch.width = 1e-6 m", "12000", "at most 20"],
    ),
    before(
        "a strip of a micrometre",
        LUMPED,
        &[Set("strip.height", 1e-6), Initialise, Set(F, 1.0), Set(V, 1.0), Step(0.01)],
        Ok,
        &[],
    ),
    before(
        "a strip of a micrometre on cells",
        CELLS,
        &[Set("strip.height", 1e-6), Initialise],
        Error,
        &["strip.height = 1e-6 m and punch.width = 0.095 m", "must be at least 0.00005"],
    ),
    before("a depth of 100 m", EACH, &[Set("depth", 100.0), Initialise, Set(F, 2e3), Set(V, 1.0), Step(0.01)], Ok, &[]),
];

const OPTIONS: &[Case] = &[
    before(
        "rigid bodies on cells",
        CELLS,
        &[Set("punch.body", RIGID), Set("strip.body", RIGID), Initialise],
        Error,
        &["punch.body = rigid on strip.body = rigid", "solver.fidelity"],
    ),
    before(
        "rigid bodies, lumped",
        LUMPED,
        &[Set("punch.body", RIGID), Set("strip.body", RIGID), Initialise, Set(F, 2e3), Set(V, 1.0), Step(0.01)],
        Ok,
        &[],
    ),
    before(
        "the field level of an annulus",
        LUMPED,
        &[Set("solver.fidelity", FIELD), Set("contact.geometry", ANNULAR), Initialise],
        Error,
        &["solver.fidelity = field", "contact.geometry = line"],
    ),
    before(
        "an operator split without cells",
        LUMPED,
        &[Set("solver.scheme", STAGGERED), Initialise],
        Error,
        &["solver.scheme = staggered", "solver.fidelity = line"],
    ),
    before(
        "two cells",
        LUMPED,
        &[Set("solver.fidelity", LINE), Set("solver.cells", 2.0), Initialise],
        Error,
        &["solver.cells = 2", "at least 3"],
    ),
    before(
        "two insulators",
        EACH,
        &[Set("punch.conductivity", 0.0), Set("strip.conductivity", 0.0), Initialise],
        Error,
        &["punch.conductivity = 0 and strip.conductivity = 0", "at least one must be > 0 W/(m.K)"],
    ),
    before(
        "an insulator behind an insulating contact",
        EACH,
        &[Set("punch.conductivity", 0.0), Set("contact.conductance", 0.0), Initialise],
        Error,
        &["contact.conductance = 0", "must be > 0 W/(m2.K)"],
    ),
    before(
        "a neighbour at a held face",
        EACH,
        &[
            Set("punch.top_thermal", HELD),
            Set("punch.external_conductance", 5.0),
            Set("punch.external_temperature", 300.0),
            Initialise,
        ],
        Error,
        &["punch.external_conductance = 5 W/K", "insulated or convecting"],
    ),
    before(
        "a neighbour behind an insulator",
        EACH,
        &[
            Set("punch.conductivity", 0.0),
            Set("punch.external_conductance", 5.0),
            Set("punch.external_temperature", 300.0),
            Initialise,
        ],
        Error,
        &["punch.external_conductance = 5 W/K", "punch.conductivity > 0 W/(m.K); it is 0"],
    ),
    before(
        "a neighbour of a straight track",
        EACH,
        &[
            Set("strip.path", STRAIGHT),
            Set("strip.external_conductance", 5.0),
            Set("strip.external_temperature", 300.0),
            Initialise,
        ],
        Error,
        &["strip.external_conductance = 5 W/K", "strip.path = closed"],
    ),
    before(
        "an initial temperature without effect",
        EACH,
        &[Set("punch.initial_temperature", 400.0), Initialise],
        Error,
        &["punch.initial_temperature = 400 K", "punch.initial_at_ambient = false"],
    ),
    before(
        "a temperature limit without effect",
        EACH,
        &[Set("contact.temperature_limit", 400.0), Initialise],
        Error,
        &["contact.temperature_limit = 400 K", "contact.temperature_limited = true"],
    ),
    before(
        "friction fading at temperatures that fall",
        EACH,
        &[Set("contact.friction_fade.temperature[2]", 250.0), Initialise],
        Error,
        &["contact.friction_fade.temperature[2] = 250 K must be above", "300 K"],
    ),
    before(
        "wear fading at equal temperatures",
        EACH,
        &[Set("strip.wear_fade.temperature[8]", 900.0), Initialise],
        Error,
        &["strip.wear_fade.temperature[8] = 900 K must be above strip.wear_fade.temperature[7] = 900 K"],
    ),
    before(
        "a friction table of one point",
        EACH,
        &[Set("contact.friction_table.points", 1.0), Initialise],
        Error,
        &["contact.friction_table.points = 1", "at least 2"],
    ),
    before(
        "a friction table that does not start at 0",
        EACH,
        &[Set("contact.friction_table.points", 3.0), Set("contact.friction_table.speed[1]", 0.5), Initialise],
        Error,
        &["contact.friction_table.speed[1] = 0.5 m/s must be 0 m/s"],
    ),
    before(
        "a friction table that does not increase",
        EACH,
        &[Set("contact.friction_table.points", 3.0), Set("contact.friction_table.speed[3]", 1.0), Initialise],
        Error,
        &["contact.friction_table.speed[3] = 1 m/s must be above contact.friction_table.speed[2] = 1 m/s"],
    ),
    before(
        "a friction table and a static ratio",
        EACH,
        &[Set("contact.friction_table.points", 3.0), Set("contact.static_friction_ratio", 1.3), Initialise],
        Error,
        &["contact.static_friction_ratio = 1.3 and contact.friction_table.points = 3"],
    ),
    before(
        "a friction table of no friction",
        EACH,
        &[Set("contact.friction_table.points", 3.0), Set("contact.friction_coefficient", 0.0), Initialise],
        Error,
        &["contact.friction_coefficient = 0 with contact.friction_table.points = 3"],
    ),
    before(
        "a point behind the friction table",
        EACH,
        &[Set("contact.friction_table.points", 3.0), Set("contact.friction_table.coefficient[7]", 0.1), Initialise],
        Error,
        &["contact.friction_table.coefficient[7] = 0.1 has no effect", "points = 3"],
    ),
    before(
        "a body worn off before it starts",
        EACH,
        &[Set("punch.initial_wear", 0.012), Initialise],
        Error,
        &["punch.initial_wear = 0.012 m must be below punch.height = 0.012 m"],
    ),
    before(
        "a run-in shape without wear",
        EACH,
        &[
            Set("contact.initial_shape", RUN_IN),
            Set("punch.wear_coefficient", 0.0),
            Set("strip.wear_coefficient", 0.0),
            Initialise,
        ],
        Error,
        &["contact.initial_shape = run_in", "punch.wear_coefficient and strip.wear_coefficient are 0"],
    ),
    before(
        "a tolerance of 0 by the importer",
        EACH,
        &[Other(|x| x.setup(Some(0.0), 0.0, None))],
        Error,
        &["tolerance 0"],
    ),
    before(
        "a tolerance of 1e-30 by the importer",
        EACH,
        &[Other(|x| x.setup(Some(1e-30), 0.0, None)), Initialise, Step(1e-6)],
        Ok,
        &["tolerance 1e-30", "1e-10"],
    ),
];

const LIMITS: &[Case] = &[
    before(
        "a wear limit that is reached",
        EACH,
        &[Set("punch.wear_limit", 1e-12), Initialise, Set(F, 2e3), Set(V, 2.0), Step(1.0)],
        Ok,
        &["a wear limit is reached (limit_reached bit 1)"],
    ),
    before(
        "a wear limit that is reached at start",
        EACH,
        &[Set("punch.wear_limit", 1e-6), Set("punch.initial_wear", 1e-5), Initialise, Step(0.01)],
        Ok,
        &["a wear limit is reached"],
    ),
    before(
        "a punch that is worn through",
        EACH,
        &[
            Set("punch.height", 1e-3),
            Set("punch.wear_coefficient", 1e-8),
            Initialise,
            Set(F, 2e3),
            Set(V, 2.0),
            Step(10.0),
        ],
        Error,
        &["the punch is worn through", "punch.height = 0.001 m"],
    ),
    before(
        "a temperature limit that is exceeded",
        EACH,
        &[
            Set("contact.temperature_limited", 1.0),
            Set("contact.temperature_limit", 293.2),
            Initialise,
            Set(F, 2e3),
            Set(V, 2.0),
            Step(1.0),
        ],
        Ok,
        &["contact.temperature_limit = 293.2 K is exceeded (limit_reached bit 2)"],
    ),
    stepping(
        "far above the nominal load",
        EACH,
        &[Set(F, 1e8), Step(1e-3)],
        Ok,
        &["outside the model's validity (limit_reached bit 4)"],
    ),
    before(
        "above the critical speed, with resolved heat",
        HOT,
        &[Initialise, Set(V, 20.0), Set(F, 2e3), Step(0.01), Step(0.1)],
        Ok,
        &["thermoelastically unstable"],
    ),
    stepping(
        "above the critical speed, without resolved heat",
        &[Level::Lumped, Level::Cold],
        &[Set(V, 20.0), Set(F, 2e3), Step(0.01), Step(0.1)],
        Ok,
        &[],
    ),
    stepping(
        "above the critical speed, as planned",
        &[Level::Auto],
        &[Set(V, 20.0), Set(F, 2e3), Step(0.01), Step(0.1)],
        Ok,
        &[],
    ),
    before(
        "a thin punch with a cooled area of 1000 m2",
        EACH,
        &[
            Set("punch.width", 0.00187),
            Set("punch.top_thermal", HELD),
            Set("punch.cooled_area", 1000.0),
            Initialise,
            Set(F, 100.0),
            Set(V, 2.0),
            Step(0.01),
        ],
        Ok,
        &[],
    ),
    before(
        "a radiating punch behind fading friction, whose bristle releases heat without a solution",
        LUMPED,
        &[
            Set("punch.top_thermal", EXTERNAL),
            Set("punch.external_temperature", 467.89),
            Set("punch.emissivity", 0.27877),
            Set("strip.conductivity", 0.0),
            Set("contact.friction_fade.factor[1]", 1.0867),
            Set("contact.stick_stiffness", 3631.2),
            Set("solver.tolerance", 0.0284834),
            Initialise,
            Set(V, 10.0),
            Set(F, 5e3),
            Steps(0.01, 11),
            Step(0.01),
        ],
        Error,
        &["no solution of heat", "contact temperature", "sliding velocity 10 m/s, normal load 5000 N"],
    ),
    before(
        "an air speed of 1e12 m/s at initialisation",
        EACH,
        &[Set("cooling_velocity", 1e12), Set("ambient_temperature_offset", 12.0), Initialise, Step(0.01)],
        Ok,
        &[],
    ),
    before(
        "a velocity of 1e12 m/s at initialisation",
        EACH,
        &[Set(V, 1e12), Set("ambient_temperature_offset", -0.2), Initialise, Step(0.01)],
        Ok,
        &[],
    )
    .example("disc_brake"),
    before(
        "a stiff caliper in a step of a minute",
        &[Level::Lumped, Level::Hot],
        &[
            Set("punch.youngs_modulus", 2.08e11),
            Set("holder.stiffness", 1e10),
            Initialise,
            Set(V, 100.0),
            Set(F, 10.0),
            Step(60.6),
        ],
        Error,
        &["no solution", "sliding velocity 100 m/s"],
    ),
];

const STATES: &[Case] = &[
    stepping(
        "a state cut short by a byte",
        EACH,
        &[Other(|x| {
            restored(x, |bytes| {
                bytes.pop();
            })
        })],
        Error,
        &["bytes", "were given"],
    ),
    stepping(
        "half of a state",
        EACH,
        &[Other(|x| restored(x, |bytes| bytes.truncate(bytes.len() / 2)))],
        Error,
        &["were given"],
    ),
    stepping("no bytes", EACH, &[Other(|x| restored(x, Vec::clear))], Error, &["0 were given"]),
    stepping(
        "a state with a flipped bit",
        EACH,
        &[Other(|x| restored(x, |bytes| bytes[200] ^= 1))],
        Error,
        &["checksum"],
    ),
    stepping(
        "a state of another FMU",
        EACH,
        &[Other(|x| {
            restored(x, |bytes| {
                bytes[22] ^= 1;
                forge(bytes)
            })
        })],
        Error,
        &["of the FMU", "this is"],
    ),
    stepping(
        "a state of an older layout",
        EACH,
        &[Other(|x| {
            restored(x, |bytes| {
                bytes[4] = 1;
                forge(bytes)
            })
        })],
        Error,
        &["layout 1", "layout 2"],
    ),
    stepping(
        "noise as a state",
        EACH,
        &[Other(|x| restored(x, |bytes| bytes.fill(0x5a)))],
        Error,
        &["no serialised FMU state"],
    ),
    stepping(
        "a state with a load of NaN among its numbers",
        EACH,
        &[Other(|x| {
            restored(x, |bytes| {
                last_number(bytes, NAN);
                forge(bytes)
            })
        })],
        Error,
        &["state"],
    ),
    stepping(
        "a state with an infinite number",
        EACH,
        &[Other(|x| {
            restored(x, |bytes| {
                last_number(bytes, INFINITE);
                forge(bytes)
            })
        })],
        Error,
        &["damaged"],
    ),
    stepping(
        "a state with a number too many",
        EACH,
        &[Other(|x| {
            restored(x, |bytes| {
                bytes.extend([0; 8]);
                forge(bytes)
            })
        })],
        Error,
        &["state"],
    ),
    stepping(
        "a state of no phase",
        EACH,
        &[Other(|x| {
            restored(x, |bytes| {
                let at = phase(bytes);
                bytes[at] = 3;
                forge(bytes)
            })
        })],
        Error,
        &["3 is no phase"],
    ),
    stepping(
        "a state saved before initialisation",
        EACH,
        &[Other(|x| restored_from(x, &Importer::new().bytes())), Initialise, Step(0.01)],
        Ok,
        &[],
    ),
    stepping(
        "a lumped state on cells",
        CELLS,
        &[Other(|x| restored_from(x, &Importer::at(crate::importer::Stage::Stepping).bytes())), Step(0.01)],
        Ok,
        &[],
    ),
    stepping("no state", EACH, &[Other(|x| x.restore(ptr::null_mut()))], Error, &["NULL"]),
    stepping(
        "an instance as a state",
        EACH,
        &[Other(|x| x.restore(x.component))],
        Error,
        &["never came from this FMU"],
    ),
    stepping("a state that was freed", EACH, &[Other(|x| x.restore(freed(x)))], Error, &["freed"]),
    stepping("a state that is freed twice", EACH, &[Other(|x| x.free(&mut freed(x)))], Error, &["freed"]),
    stepping("serialised into too few bytes", EACH, &[Other(serialised_short)], Error, &["bytes"]),
];

const ORDER: &[Case] = &[
    before("a step before initialisation", EACH, &[Step(0.01)], Error, &["fmi2DoStep", "not allowed in the phase"]),
    before(
        "the end of an initialisation that has not begun",
        LUMPED,
        &[Other(Importer::exit)],
        Error,
        &["fmi2ExitInitializationMode"],
    ),
    before(
        "initialisation entered twice",
        LUMPED,
        &[Other(Importer::enter), Other(Importer::enter)],
        Error,
        &["fmi2EnterInitializationMode"],
    ),
    stepping(
        "initialisation entered while stepping",
        EACH,
        &[Other(Importer::enter)],
        Error,
        &["fmi2EnterInitializationMode"],
    ),
    stepping(
        "the experiment set up while stepping",
        EACH,
        &[Other(|x| x.setup(None, 0.0, None))],
        Error,
        &["fmi2SetupExperiment"],
    ),
    stepping("a step after the end", EACH, &[Other(Importer::terminate), Step(0.01)], Error, &["fmi2DoStep"]),
    stepping("an input after the end", EACH, &[Other(Importer::terminate), Set(V, 1.0)], Error, &["fmi2SetReal"]),
    stepping(
        "the end twice",
        EACH,
        &[Other(Importer::terminate), Other(Importer::terminate)],
        Error,
        &["fmi2Terminate"],
    ),
    stepping(
        "a step cancelled that is not running",
        EACH,
        &[Other(|x| unsafe { fmi2CancelStep(x.component) })],
        Error,
        &["fmi2CancelStep"],
    ),
    stepping(
        "a function of model exchange",
        EACH,
        &[Other(|x| unsafe { fmi2EnterEventMode(x.component) })],
        Error,
        &["model exchange"],
    ),
    stepping("a reset in between", EACH, &[Other(Importer::reset), Initialise, Step(0.01)], Ok, &[]),
    stepping("a second derivative of an input", EACH, &[Other(|x| x.set_derivative(V, 2, 1.0))], Error, &["2"]),
    stepping(
        "a derivative of a parameter",
        EACH,
        &[Other(|x| x.set_derivative("depth", 1, 1.0))],
        Error,
        &["depth", "not an input"],
    ),
    stepping(
        "a second derivative of an output",
        EACH,
        &[Other(|x| x.output_derivative("wear_depth", 2))],
        Error,
        &["2"],
    ),
    stepping(
        "a directional derivative by an output",
        EACH,
        &[Other(|x| status(x.directional_derivative("friction_force", "wear_depth", 1.0)))],
        Error,
        &["wear_depth"],
    ),
    stepping(
        "a directional derivative at NaN",
        EACH,
        &[Set(V, NAN), Other(|x| status(x.directional_derivative("friction_force", F, 1.0)))],
        Error,
        &["sliding_velocity"],
    ),
];

const ARRAYS: &[Case] = &[
    stepping(
        "NULL references",
        EACH,
        &[Other(|x| unsafe { fmi2SetReal(x.component, ptr::null(), 1, &1.0) })],
        Error,
        &["vr is NULL"],
    ),
    stepping(
        "NULL values",
        EACH,
        &[Other(|x| unsafe { fmi2SetReal(x.component, &0, 1, ptr::null()) })],
        Error,
        &["value is NULL"],
    ),
    stepping(
        "NULL results",
        EACH,
        &[Other(|x| unsafe { fmi2GetReal(x.component, &0, 1, ptr::null_mut()) })],
        Error,
        &["value is NULL"],
    ),
    stepping(
        "2^61 references",
        EACH,
        &[Other(|x| unsafe { fmi2GetReal(x.component, &0, 1 << 61, ptr::null_mut()) })],
        Error,
        &["2305843009213693952"],
    ),
    stepping(
        "no place for a state",
        EACH,
        &[Other(|x| unsafe { fmi2GetFMUstate(x.component, ptr::null_mut()) })],
        Error,
        &["NULL"],
    ),
    stepping(
        "the highest reference",
        EACH,
        &[Other(|x| x.set_reals(&[u32::MAX], &[1.0]))],
        Error,
        &["4294967295", "unknown"],
    ),
    stepping(
        "an unknown reference behind an input",
        EACH,
        &[Other(|x| x.set_reals(&[reference(V), u32::MAX], &[9.0, 1.0]))],
        Error,
        &["4294967295"],
    ),
    stepping("an output that is set", EACH, &[Set("wear_depth", 0.0)], Error, &["wear_depth is calculated"]),
    stepping(
        "an output behind an input",
        EACH,
        &[Other(|x| x.set_real(&[V, "wear_depth"], &[9.0, 0.0]))],
        Error,
        &["wear_depth"],
    ),
    before(
        "a refused value behind good ones",
        LUMPED,
        &[Other(|x| x.set_real(&["strip.height", V, "punch.height"], &[0.02, 9.0, -1.0]))],
        Discard,
        &["punch.height: -1 m"],
    ),
    before("Real as Integer", LUMPED, &[Other(|x| x.set_integer("depth", 1))], Error, &["depth"]),
    before("Integer as Real", LUMPED, &[Other(|x| x.set_real(&["contact.faces"], &[1.0]))], Error, &["contact.faces"]),
    stepping(
        "an Integer read as Real",
        EACH,
        &[Other(|x| status(x.get_reals(&[reference("limit_reached")])))],
        Error,
        &["limit_reached"],
    ),
    stepping(
        "NULL categories of messages",
        EACH,
        &[Other(|x| unsafe { fmi2SetDebugLogging(x.component, 1, 2, ptr::null()) })],
        Error,
        &["NULL"],
    ),
];

fn status<T>(result: Result<T, Status>) -> Status {
    result.err().unwrap_or(Ok)
}

/// Deserialises and restores the instance's own state after `damage`.
fn restored(importer: &Importer, damage: fn(&mut Vec<u8>)) -> Status {
    let mut bytes = importer.bytes();
    damage(&mut bytes);
    restored_from(importer, &bytes)
}

fn restored_from(importer: &Importer, bytes: &[u8]) -> Status {
    match importer.deserialize(bytes) {
        Result::Ok(mut state) => {
            let status = importer.restore(state);
            assert_eq!(importer.free(&mut state), Ok);
            status
        }
        Err(status) => status,
    }
}

/// Place of the phase in the bytes of a state.
fn phase(bytes: &[u8]) -> usize {
    20 + usize::from(u16::from_le_bytes([bytes[6], bytes[7]]))
}

/// Replaces the last number of a state.
fn last_number(bytes: &mut [u8], number: f64) {
    let at = bytes.len() - 8;
    bytes[at..].copy_from_slice(&number.to_le_bytes());
}

/// Makes length and checksum fit.
fn forge(bytes: &mut [u8]) {
    let payload = (bytes.len() - phase(bytes)) as u32;
    bytes[8..12].copy_from_slice(&payload.to_le_bytes());
    let sum = Fnv::of(bytes[..12].iter().chain(&bytes[20..]).copied()).0;
    bytes[12..20].copy_from_slice(&sum.to_le_bytes());
}

/// A state that was freed.
fn freed(importer: &Importer) -> *mut core::ffi::c_void {
    let mut state = ptr::null_mut();
    assert_eq!(importer.save(&mut state), Ok);
    let handle = state;
    assert_eq!(importer.free(&mut state), Ok);
    handle
}

fn serialised_short(importer: &Importer) -> Status {
    let mut state = ptr::null_mut();
    assert_eq!(importer.save(&mut state), Ok);
    let mut bytes = [0_u8; 40];
    // SAFETY: the array is as long as told.
    let status = unsafe { fmi2SerializeFMUstate(importer.component, state, bytes.as_mut_ptr().cast(), bytes.len()) };
    assert_eq!(importer.free(&mut state), Ok);
    status
}

/// Runs a group of the table.
fn check(cases: &[Case]) {
    let (mut runner, mut failures) = (Runner::default(), Vec::new());
    for case in cases {
        for &level in case.levels {
            let run = panic::catch_unwind(AssertUnwindSafe(|| runner.run(case, level)));
            if let Err(text) = run.unwrap_or_else(|_| Err("panicked".into())) {
                failures.push(format!("{}, {level:?}: {text}", case.what));
            }
        }
    }
    assert!(failures.is_empty(), "{} failures\n{}", failures.len(), failures.join("\n"));
}

macro_rules! groups {
    ($($test:ident: $cases:ident;)*) => {
        const GROUPS: &[&[Case]] = &[$($cases),*];

        $(
            #[test]
            fn $test() {
                check($cases);
            }
        )*
    };
}

groups! {
    inputs_that_are_no_numbers: NO_NUMBERS;
    inputs_beyond_their_limits: BEYOND;
    extreme_inputs_that_are_allowed: EXTREME;
    lengths_of_steps_and_times: STEPS;
    parameters_one_by_one: PARAMETERS;
    geometry: GEOMETRY;
    options_that_contradict_each_other: OPTIONS;
    limits_of_the_model: LIMITS;
    states: STATES;
    order_of_calls: ORDER;
    arrays_references_and_types: ARRAYS;
}

#[test]
fn the_table_has_rows_enough_and_none_twice() {
    let mut names: Vec<&str> = GROUPS.iter().flat_map(|cases| cases.iter().map(|case| case.what)).collect();
    let count = names.len();
    names.sort_unstable();
    names.dedup();
    assert!(count >= 60 && names.len() == count, "{count} rows, {} names", names.len());
}
