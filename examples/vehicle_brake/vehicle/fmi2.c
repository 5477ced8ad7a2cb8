/* The vehicle as a co-simulation FMU (FMI 2.0). Formulas are in vehicle.c. */
#include "fmi2Functions.h"
#include "vehicle.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct {
    VehicleState state;
    Table speed, grade;
    fmi2CallbackLogger log;
    fmi2ComponentEnvironment environment;
    char name[128];
    char resources[1024];
} Instance;

static fmi2Status fail(Instance *instance, const char *format, ...)
{
    char text[1400];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    if (instance->log != NULL)
        instance->log(instance->environment, instance->name, fmi2Error, "logStatusError", "%s", text);
    return fmi2Error;
}

const char *fmi2GetTypesPlatform(void) { return fmi2TypesPlatform; }
const char *fmi2GetVersion(void) { return fmi2Version; }

/* Path of a `file:` address with its per cent escapes resolved. */
static void path_of(const char *address, char *path, size_t room)
{
    size_t length = 0;
    if (strncmp(address, "file://", 7) == 0) address += 7;
    else if (strncmp(address, "file:", 5) == 0) address += 5;
#ifdef _WIN32
    if (address[0] == '/' && address[1] != 0 && address[2] == ':') ++address;
#endif
    while (*address != 0 && length + 1 < room) {
        unsigned code;
        if (address[0] == '%' && sscanf(address + 1, "%2x", &code) == 1) {
            path[length++] = (char)code;
            address += 3;
        } else {
            path[length++] = *address++;
        }
    }
    while (length > 0 && path[length - 1] == '/') --length;
    path[length] = 0;
}

fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources,
                              const fmi2CallbackFunctions *functions, fmi2Boolean visible, fmi2Boolean logging)
{
    Instance *instance;
    (void)visible, (void)logging;
    if (type != fmi2CoSimulation || name == NULL || guid == NULL || resources == NULL) return NULL;
    if (strcmp(guid, VEHICLE_GUID) != 0) return NULL;
    instance = calloc(1, sizeof *instance);
    if (instance == NULL) return NULL;
    instance->log = functions != NULL ? functions->logger : NULL;
    instance->environment = functions != NULL ? functions->componentEnvironment : NULL;
    snprintf(instance->name, sizeof instance->name, "%s", name);
    path_of(resources, instance->resources, sizeof instance->resources);
    vehicle_start_values(&instance->state);
    return instance;
}

void fmi2FreeInstance(fmi2Component component)
{
    Instance *instance = component;
    if (instance == NULL) return;
    table_free(&instance->speed);
    table_free(&instance->grade);
    free(instance);
}

fmi2Status fmi2SetDebugLogging(fmi2Component c, fmi2Boolean on, size_t n, const fmi2String categories[])
{
    (void)c, (void)on, (void)n, (void)categories;
    return fmi2OK;
}

fmi2Status fmi2SetupExperiment(fmi2Component component, fmi2Boolean has_tolerance, fmi2Real tolerance, fmi2Real start,
                               fmi2Boolean has_stop, fmi2Real stop)
{
    (void)has_tolerance, (void)tolerance, (void)has_stop, (void)stop;
    ((Instance *)component)->state.time = start;
    return fmi2OK;
}

fmi2Status fmi2EnterInitializationMode(fmi2Component component)
{
    Instance *instance = component;
    char path[1200];
    int i;
    for (i = 0; i < VEHICLE_COUNT; ++i)
        if (!isfinite(instance->state.value[i])) return fail(instance, "variable %d is not finite", i);
    table_free(&instance->speed);
    table_free(&instance->grade);
    snprintf(path, sizeof path, "%s/speed.csv", instance->resources);
    if (table_read(&instance->speed, path)) return fail(instance, "%s is no table of speed over increasing time", path);
    snprintf(path, sizeof path, "%s/road.csv", instance->resources);
    if (table_read(&instance->grade, path)) return fail(instance, "%s is no table of grade over increasing position", path);
    vehicle_initialise(&instance->state, &instance->speed, &instance->grade, instance->state.time);
    return fmi2OK;
}

fmi2Status fmi2ExitInitializationMode(fmi2Component component)
{
    Instance *instance = component;
    vehicle_outputs(&instance->state, &instance->speed, &instance->grade);
    return fmi2OK;
}

fmi2Status fmi2Terminate(fmi2Component component)
{
    (void)component;
    return fmi2OK;
}

fmi2Status fmi2Reset(fmi2Component component)
{
    vehicle_start_values(&((Instance *)component)->state);
    return fmi2OK;
}

fmi2Status fmi2GetReal(fmi2Component component, const fmi2ValueReference reference[], size_t count, fmi2Real value[])
{
    Instance *instance = component;
    size_t i;
    for (i = 0; i < count; ++i) {
        if (reference[i] >= VEHICLE_COUNT) return fail(instance, "there is no Real variable %u", reference[i]);
        value[i] = instance->state.value[reference[i]];
    }
    return fmi2OK;
}

fmi2Status fmi2SetReal(fmi2Component component, const fmi2ValueReference reference[], size_t count, const fmi2Real value[])
{
    Instance *instance = component;
    size_t i;
    for (i = 0; i < count; ++i) {
        if (reference[i] >= VEHICLE_COUNT) return fail(instance, "there is no Real variable %u", reference[i]);
        if (!isfinite(value[i])) return fail(instance, "variable %u is set to %g", reference[i], value[i]);
        instance->state.value[reference[i]] = value[i];
        instance->state.rate[reference[i]] = 0.0;
    }
    return fmi2OK;
}

fmi2Status fmi2SetRealInputDerivatives(fmi2Component component, const fmi2ValueReference reference[], size_t count,
                                       const fmi2Integer order[], const fmi2Real value[])
{
    Instance *instance = component;
    size_t i;
    for (i = 0; i < count; ++i) {
        if (reference[i] < VEHICLE_FIRST_INPUT || reference[i] > VEHICLE_LAST_INPUT)
            return fail(instance, "variable %u is no input", reference[i]);
        if (order[i] != 1) return fail(instance, "input derivatives are taken of order 1, not %d", order[i]);
        if (!isfinite(value[i])) return fail(instance, "the derivative of input %u is %g", reference[i], value[i]);
        instance->state.rate[reference[i]] = value[i];
    }
    return fmi2OK;
}

fmi2Status fmi2DoStep(fmi2Component component, fmi2Real time, fmi2Real step, fmi2Boolean no_return)
{
    Instance *instance = component;
    (void)no_return;
    if (!(step >= 0.0) || !isfinite(step)) return fail(instance, "the step is %g s", step);
    instance->state.time = time;
    vehicle_step(&instance->state, &instance->speed, &instance->grade, step);
    return fmi2OK;
}

fmi2Status fmi2GetFMUstate(fmi2Component component, fmi2FMUstate *state)
{
    if (*state == NULL) *state = malloc(sizeof(VehicleState));
    if (*state == NULL) return fail(component, "no memory for a state");
    memcpy(*state, &((Instance *)component)->state, sizeof(VehicleState));
    return fmi2OK;
}

fmi2Status fmi2SetFMUstate(fmi2Component component, fmi2FMUstate state)
{
    memcpy(&((Instance *)component)->state, state, sizeof(VehicleState));
    return fmi2OK;
}

fmi2Status fmi2FreeFMUstate(fmi2Component component, fmi2FMUstate *state)
{
    (void)component;
    free(*state);
    *state = NULL;
    return fmi2OK;
}

/* The rest of the interface, whose use modelDescription.xml rules out. Importers look for every name when loading. */
#define ABSENT(name, ...) \
    fmi2Status name(fmi2Component c, __VA_ARGS__) { return fail(c, "this FMU has no " #name); }
#define REFERENCES const fmi2ValueReference r[], size_t n
/* Of types without variables, asking for none is fine. */
#define EMPTY(name, ...) \
    fmi2Status name(fmi2Component c, REFERENCES, __VA_ARGS__) \
    { (void)r, (void)v; return n == 0 ? fmi2OK : fail(c, "this FMU has Real variables only"); }

EMPTY(fmi2GetInteger, fmi2Integer v[])
EMPTY(fmi2GetBoolean, fmi2Boolean v[])
EMPTY(fmi2GetString, fmi2String v[])
EMPTY(fmi2SetInteger, const fmi2Integer v[])
EMPTY(fmi2SetBoolean, const fmi2Boolean v[])
EMPTY(fmi2SetString, const fmi2String v[])
ABSENT(fmi2SerializedFMUstateSize, fmi2FMUstate s, size_t *n)
ABSENT(fmi2SerializeFMUstate, fmi2FMUstate s, fmi2Byte b[], size_t n)
ABSENT(fmi2DeSerializeFMUstate, const fmi2Byte b[], size_t n, fmi2FMUstate *s)
ABSENT(fmi2GetDirectionalDerivative, REFERENCES, const fmi2ValueReference k[], size_t m, const fmi2Real d[], fmi2Real v[])
ABSENT(fmi2GetRealOutputDerivatives, REFERENCES, const fmi2Integer o[], fmi2Real v[])
ABSENT(fmi2GetStatus, const fmi2StatusKind s, fmi2Status *v)
ABSENT(fmi2GetRealStatus, const fmi2StatusKind s, fmi2Real *v)
ABSENT(fmi2GetIntegerStatus, const fmi2StatusKind s, fmi2Integer *v)
ABSENT(fmi2GetBooleanStatus, const fmi2StatusKind s, fmi2Boolean *v)
ABSENT(fmi2GetStringStatus, const fmi2StatusKind s, fmi2String *v)
fmi2Status fmi2CancelStep(fmi2Component c) { return fail(c, "this FMU has no fmi2CancelStep"); }
