//! Rows of the table: limits of the model, states, order of calls, arrays.

use super::*;

pub const LIMITS: &[Case] = &[
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
        &[Initialise, Set(V, 20.0), Set(F, 2e3), Step(0.01), Step(2.0)],
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
        "a radiating punch behind fading friction, whose bristle releases heat",
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
        Ok,
        &[],
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
        &["step of 60.6 s"],
    ),
];

pub const STATES: &[Case] = &[
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
        &["layout 1", "layout 11"],
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
        &[Other(|x| restored_from(x, &Importer::at(test_support::importer::Stage::Stepping).bytes())), Step(0.01)],
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

pub const ORDER: &[Case] = &[
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

pub const ARRAYS: &[Case] = &[
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
