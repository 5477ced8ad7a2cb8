/* Smallest host of a co-simulation FMU (FMI 2.0): loads a library, feeds it two inputs and writes what it answers.
 *
 *     host LIBRARY GUID STEP INPUTS OUTPUTS reference reference reference ...
 *
 * INPUTS holds pairs of doubles, one pair for every step, which are set before the step and held over it. OUTPUTS gets
 * one double for every value reference after the first two, which are those of the inputs, after every step. The
 * instance is initialised with the library's own start values. Ends with 0, or says on the error stream what failed.
 */
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>

#if defined(_WIN32)
#include <windows.h>
typedef HMODULE Library;
static Library open_library(const char *path) { return LoadLibraryA(path); }
static void *find(Library library, const char *name) { return (void *)GetProcAddress(library, name); }
static const char *reason(void) {
    static char text[64];
    snprintf(text, sizeof text, "Windows error %lu", (unsigned long)GetLastError());
    return text;
}
#else
#include <dlfcn.h>
typedef void *Library;
static Library open_library(const char *path) { return dlopen(path, RTLD_NOW | RTLD_LOCAL); }
static void *find(Library library, const char *name) { return dlsym(library, name); }
static const char *reason(void) { return dlerror(); }
#endif

enum { FIXED_ARGUMENTS = 6, INPUTS = 2, MOST_OUTPUTS = 256 };

typedef void *Component;
typedef struct {
    void (*logger)(void *, const char *, int, const char *, const char *, ...);
    void *(*allocate)(size_t, size_t);
    void (*release)(void *);
    void (*step_finished)(void *, int);
    void *environment;
} Callbacks;

static void log_message(void *environment, const char *instance, int status, const char *category, const char *format,
                        ...) {
    va_list arguments;
    (void)environment;
    fprintf(stderr, "%s, status %d, %s: ", instance, status, category);
    va_start(arguments, format);
    vfprintf(stderr, format, arguments);
    va_end(arguments);
    fputc('\n', stderr);
}

static int fail(const char *what, const char *why) {
    fprintf(stderr, "error: %s: %s\n", what, why);
    return EXIT_FAILURE;
}

/* Finds a function in the library and returns from main where there is none. */
#define FUNCTION(result, name, ...)                                                                                    \
    result (*name)(__VA_ARGS__) = (result(*)(__VA_ARGS__))find(library, #name);                                        \
    if (!name) return fail(#name, "the library does not export it")
/* Calls a function and returns from main where its status is neither fmi2OK nor fmi2Warning. */
#define CALL(call)                                                                                                     \
    if ((call) > 1) return fail(#call, "status above fmi2Warning")

int main(int count, char **words) {
    static const Callbacks callbacks = {log_message, calloc, free, NULL, NULL};
    if (count <= FIXED_ARGUMENTS + INPUTS || count > FIXED_ARGUMENTS + INPUTS + MOST_OUTPUTS)
        return fail(words[0], "expected LIBRARY GUID STEP INPUTS OUTPUTS and the references of 2 inputs and outputs");
    const double step = strtod(words[3], NULL);
    const size_t outputs = (size_t)(count - FIXED_ARGUMENTS - INPUTS);
    unsigned references[INPUTS + MOST_OUTPUTS];
    for (size_t at = 0; at < INPUTS + outputs; ++at)
        references[at] = (unsigned)strtoul(words[FIXED_ARGUMENTS + at], NULL, 10);

    Library library = open_library(words[1]);
    if (!library) return fail(words[1], reason());
    FUNCTION(Component, fmi2Instantiate, const char *, int, const char *, const char *, const Callbacks *, int, int);
    FUNCTION(int, fmi2SetupExperiment, Component, int, double, double, int, double);
    FUNCTION(int, fmi2EnterInitializationMode, Component);
    FUNCTION(int, fmi2ExitInitializationMode, Component);
    FUNCTION(int, fmi2SetReal, Component, const unsigned *, size_t, const double *);
    FUNCTION(int, fmi2GetReal, Component, const unsigned *, size_t, double *);
    FUNCTION(int, fmi2DoStep, Component, double, double, int);
    FUNCTION(int, fmi2Terminate, Component);
    FUNCTION(void, fmi2FreeInstance, Component);

    FILE *from = fopen(words[4], "rb");
    FILE *to = fopen(words[5], "wb");
    if (!from) return fail(words[4], "cannot be opened");
    if (!to) return fail(words[5], "cannot be opened");
    Component instance = fmi2Instantiate("host", 1, words[2], NULL, &callbacks, 0, 0);
    if (!instance) return fail("fmi2Instantiate", "returned NULL");
    CALL(fmi2SetupExperiment(instance, 0, 0.0, 0.0, 0, 0.0));
    CALL(fmi2EnterInitializationMode(instance));
    CALL(fmi2ExitInitializationMode(instance));
    double pair[INPUTS], values[MOST_OUTPUTS];
    for (unsigned long index = 0; fread(pair, sizeof(double), INPUTS, from) == INPUTS; ++index) {
        CALL(fmi2SetReal(instance, references, INPUTS, pair));
        CALL(fmi2DoStep(instance, (double)index * step, step, 1));
        CALL(fmi2GetReal(instance, references + INPUTS, outputs, values));
        if (fwrite(values, sizeof(double), outputs, to) != outputs) return fail(words[5], "cannot be written");
    }
    CALL(fmi2Terminate(instance));
    fmi2FreeInstance(instance);
    if (fclose(to) != 0) return fail(words[5], "cannot be written");
    fclose(from);
    return EXIT_SUCCESS;
}
