/* A brake as it is commonly written by hand: one heat capacity for the pad, one for the disc, a fixed split of the
 * friction heat, explicit Euler, Archard wear; the numbers are those of the stock disc brake. It exports the FMI 2.0
 * functions that the timing needs with their standard signatures, so both components are called in the same way.
 *
 * It is a yardstick for the cost of a step, not for accuracy: no conduction inside the bodies, no flash temperature,
 * no step control.
 */
#include <math.h>
#include <stddef.h>
#include <stdlib.h>

typedef void *fmi2Component;
typedef double fmi2Real;
typedef int fmi2Boolean;
typedef unsigned int fmi2ValueReference;
typedef const char *fmi2String;
typedef enum { fmi2OK, fmi2Warning, fmi2Discard, fmi2Error, fmi2Fatal, fmi2Pending } fmi2Status;
typedef enum { fmi2ModelExchange, fmi2CoSimulation } fmi2Type;

#if defined(_WIN32)
#define EXPORT __declspec(dllexport)
#else
#define EXPORT __attribute__((visibility("default")))
#endif

enum { SLIDING_VELOCITY, NORMAL_LOAD, WEAR_DEPTH, CONTACT_TEMPERATURE, FRICTION_FORCE, VARIABLES };

static const double FRICTION_COEFFICIENT = 0.4;
static const double FACES = 2.0;
static const double CONTACT_AREA = 0.095 * 0.055;                  /* m2 */
static const double PAD_WEAR = 2e-14, DISC_WEAR = 1e-15;           /* m2/N */
static const double PAD_SHARE = 0.07;                              /* of the friction heat */
static const double PAD_CAPACITY = 2600.0 * 1000.0 * 0.012 * 0.095 * 0.055;               /* J/K, one face */
static const double DISC_CAPACITY = 7200.0 * 460.0 * 0.011 * 0.055 * 6.2831853 * 0.1175;  /* J/K, one face */
static const double PAD_COOLING = 10.0 * 0.095 * 0.055;            /* W/K */
static const double DISC_COOLING = 10.0 * 0.055 * 6.2831853 * 0.1175;
static const double AMBIENT = 293.15;                              /* K */
static const double RING = 6.2831853 * 0.1175 / 0.095;             /* track over pad length */

typedef struct {
    double value[VARIABLES];
    double pad, disc; /* K */
} Brake;

static void evaluate(Brake *brake) {
    double velocity = brake->value[SLIDING_VELOCITY];
    double sign = (velocity > 0.0) - (velocity < 0.0);
    brake->value[CONTACT_TEMPERATURE] = 0.5 * (brake->pad + brake->disc);
    brake->value[FRICTION_FORCE] = FACES * FRICTION_COEFFICIENT * sign * brake->value[NORMAL_LOAD];
}

static void start(Brake *brake) {
    for (int i = 0; i < VARIABLES; i++) brake->value[i] = 0.0;
    brake->pad = brake->disc = AMBIENT;
    evaluate(brake);
}

EXPORT fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources,
                                     const void *callbacks, fmi2Boolean visible, fmi2Boolean logging) {
    (void)name, (void)type, (void)guid, (void)resources, (void)callbacks, (void)visible, (void)logging;
    Brake *brake = malloc(sizeof *brake);
    if (brake) start(brake);
    return brake;
}

EXPORT void fmi2FreeInstance(fmi2Component component) { free(component); }

EXPORT fmi2Status fmi2SetupExperiment(fmi2Component component, fmi2Boolean has_tolerance, fmi2Real tolerance,
                                      fmi2Real start_time, fmi2Boolean has_stop, fmi2Real stop_time) {
    (void)component, (void)has_tolerance, (void)tolerance, (void)start_time, (void)has_stop, (void)stop_time;
    return fmi2OK;
}

EXPORT fmi2Status fmi2EnterInitializationMode(fmi2Component component) { (void)component; return fmi2OK; }

EXPORT fmi2Status fmi2ExitInitializationMode(fmi2Component component) { evaluate(component); return fmi2OK; }

EXPORT fmi2Status fmi2Reset(fmi2Component component) { start(component); return fmi2OK; }

EXPORT fmi2Status fmi2SetReal(fmi2Component component, const fmi2ValueReference references[], size_t count,
                              const fmi2Real values[]) {
    Brake *brake = component;
    for (size_t i = 0; i < count; i++) {
        if (references[i] > NORMAL_LOAD || !isfinite(values[i])) return fmi2Error;
        brake->value[references[i]] = values[i];
    }
    return fmi2OK;
}

EXPORT fmi2Status fmi2GetReal(fmi2Component component, const fmi2ValueReference references[], size_t count,
                              fmi2Real values[]) {
    const Brake *brake = component;
    for (size_t i = 0; i < count; i++) {
        if (references[i] >= VARIABLES) return fmi2Error;
        values[i] = brake->value[references[i]];
    }
    return fmi2OK;
}

EXPORT fmi2Status fmi2DoStep(fmi2Component component, fmi2Real time, fmi2Real step, fmi2Boolean no_set_state) {
    (void)time, (void)no_set_state;
    if (!(step >= 0.0)) return fmi2Error;
    Brake *brake = component;
    double speed = fabs(brake->value[SLIDING_VELOCITY]);
    double load = brake->value[NORMAL_LOAD] > 0.0 ? brake->value[NORMAL_LOAD] : 0.0;
    double heat = FRICTION_COEFFICIENT * load * speed;
    double forced = 1.0 + 0.8 * pow(speed, 0.8);
    double pad = PAD_SHARE * heat - PAD_COOLING * (brake->pad - AMBIENT);
    double disc = (1.0 - PAD_SHARE) * heat - DISC_COOLING * forced * (brake->disc - AMBIENT);
    brake->pad += step * pad / PAD_CAPACITY;
    brake->disc += step * disc / DISC_CAPACITY;
    brake->value[WEAR_DEPTH] += step * (PAD_WEAR + DISC_WEAR / RING) * load / CONTACT_AREA * speed;
    evaluate(brake);
    return fmi2OK;
}
