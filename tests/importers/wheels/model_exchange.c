/* Stand-ins for the functions of model exchange, for importers that look them up in an FMU for co-simulation too.
 *
 * The library made of this file depends on the FMU's own library and takes its place in a copy of the FMU: a function
 * that is looked up here and is not found is found there. What the importer drives is the FMU's very binary. */
#include <stddef.h>

typedef void *Component;
typedef double Real;
typedef int Status;
enum { ERROR = 3 };

Status fmi2EnterEventMode(Component c) { (void)c; return ERROR; }
Status fmi2NewDiscreteStates(Component c, void *event) { (void)c; (void)event; return ERROR; }
Status fmi2EnterContinuousTimeMode(Component c) { (void)c; return ERROR; }
Status fmi2CompletedIntegratorStep(Component c, int no_set_prior, int *enter, int *terminate) {
    (void)c; (void)no_set_prior; (void)enter; (void)terminate;
    return ERROR;
}
Status fmi2SetTime(Component c, Real time) { (void)c; (void)time; return ERROR; }
Status fmi2SetContinuousStates(Component c, const Real *x, size_t count) { (void)c; (void)x; (void)count; return ERROR; }
Status fmi2GetDerivatives(Component c, Real *x, size_t count) { (void)c; (void)x; (void)count; return ERROR; }
Status fmi2GetEventIndicators(Component c, Real *x, size_t count) { (void)c; (void)x; (void)count; return ERROR; }
Status fmi2GetContinuousStates(Component c, Real *x, size_t count) { (void)c; (void)x; (void)count; return ERROR; }
Status fmi2GetNominalsOfContinuousStates(Component c, Real *x, size_t count) {
    (void)c; (void)x; (void)count;
    return ERROR;
}
