/* Co-simulation interface by the Functional Mock-up Interface 2.0, declared here from the text of the standard. */
#include "component.h"

#ifdef FMI2_FUNCTION_PREFIX
#define NAMED(name) PASTE(FMI2_FUNCTION_PREFIX, name)
#else
#define NAMED(name) name
#endif

typedef void *instance;
typedef const char *text;
typedef int boolean;

typedef struct {
    void (*logger)(void *environment, text name, int severity, text category, text message, ...);
    void *(*allocate)(size_t count, size_t size);
    void (*release)(void *memory);
    void (*step_finished)(void *environment, int severity);
    void *environment;
} callback_functions;

/* The message is a format of the importer's: a per cent sign is doubled, so that it stands for itself. */
static void report(const component *c, status severity, const char *category, const char *message) {
    typedef void logger(void *, text, int, text, text, ...);
    char format[1024];
    size_t n = 0;
    for (; *message && n + 2 < sizeof format; message++) {
        if (*message == '%') format[n++] = '%';
        format[n++] = *message;
    }
    format[n] = '\0';
    ((logger *)c->callback)(c->environment, c->name, (int)severity, category, format);
}

EXPORT text NAMED(fmi2GetTypesPlatform)(void) { return "default"; }

EXPORT text NAMED(fmi2GetVersion)(void) { return "2.0"; }

EXPORT instance NAMED(fmi2Instantiate)(text name, int type, text guid, text resources, const callback_functions *functions,
                                       boolean visible, boolean logging) {
    (void)resources, (void)visible;
    component *c = new_component(name);
    if (!c) return NULL;
    c->report = report;
    c->logging = true; /* of what prevents the instance, whatever the categories */
    if (functions) {
        c->callback = (void (*)(void))functions->logger;
        c->environment = functions->environment;
    }
    if (type != 1 || !guid || strcmp(guid, MODEL_TOKEN) != 0) {
        say(c, ERROR, type != 1 ? "the unit is for co-simulation only" : "the GUID is not that of the model description");
        free_component(c);
        return NULL;
    }
    c->logging = logging != 0;
    return c;
}

EXPORT void NAMED(fmi2FreeInstance)(instance c) { free_component(c); }

EXPORT int NAMED(fmi2SetDebugLogging)(instance c, boolean logging, size_t count, const text *categories) {
    (void)count, (void)categories;
    ((component *)c)->logging = logging != 0;
    return OK;
}

EXPORT int NAMED(fmi2SetupExperiment)(instance c, boolean has_tolerance, double tolerance, double start, boolean has_stop,
                                      double stop) {
    (void)has_tolerance, (void)tolerance, (void)has_stop, (void)stop;
    ((component *)c)->start_time = ((component *)c)->time = start;
    return OK;
}

EXPORT int NAMED(fmi2EnterInitializationMode)(instance c) { return begin(c, ((component *)c)->start_time); }

EXPORT int NAMED(fmi2ExitInitializationMode)(instance c) { return finish_initialization(c); }

EXPORT int NAMED(fmi2Terminate)(instance c) {
    ((component *)c)->life = TERMINATED;
    return OK;
}

EXPORT int NAMED(fmi2Reset)(instance c) {
    restart(c);
    return OK;
}

EXPORT int NAMED(fmi2GetReal)(instance c, const unsigned *references, size_t count, double *values) {
    return get_values(c, references, count, values);
}

EXPORT int NAMED(fmi2SetReal)(instance c, const unsigned *references, size_t count, const double *values) {
    return set_values(c, references, count, values);
}

/* The model has real variables only. */
static int none_of(component *c, size_t count) {
    if (!count) return OK;
    say(c, ERROR, "all variables are real");
    return ERROR;
}

#define OTHER_TYPE(name, type) \
    EXPORT int NAMED(fmi2Get##name)(instance c, const unsigned *references, size_t count, type *values) { \
        (void)references, (void)values; \
        return none_of(c, count); \
    } \
    EXPORT int NAMED(fmi2Set##name)(instance c, const unsigned *references, size_t count, const type *values) { \
        (void)references, (void)values; \
        return none_of(c, count); \
    }

OTHER_TYPE(Integer, int)
OTHER_TYPE(Boolean, boolean)
OTHER_TYPE(String, text)

EXPORT int NAMED(fmi2GetFMUstate)(instance c, void **state) { return take_snapshot(c, state); }

EXPORT int NAMED(fmi2SetFMUstate)(instance c, void *state) { return restore_snapshot(c, state); }

EXPORT int NAMED(fmi2FreeFMUstate)(instance c, void **state) {
    (void)c;
    free(*state);
    *state = NULL;
    return OK;
}

EXPORT int NAMED(fmi2SerializedFMUstateSize)(instance c, void *state, size_t *size) {
    (void)c, (void)state;
    *size = sizeof(snapshot);
    return OK;
}

EXPORT int NAMED(fmi2SerializeFMUstate)(instance c, void *state, char *bytes, size_t size) {
    return write_snapshot(c, state, (unsigned char *)bytes, size);
}

EXPORT int NAMED(fmi2DeSerializeFMUstate)(instance c, const char *bytes, size_t size, void **state) {
    return read_snapshot(c, (const unsigned char *)bytes, size, state);
}

EXPORT int NAMED(fmi2GetDirectionalDerivative)(instance c, const unsigned *unknown, size_t unknowns, const unsigned *known,
                                               size_t count, const double *seed, double *sensitivity) {
    (void)unknown, (void)unknowns, (void)known, (void)count, (void)seed, (void)sensitivity;
    say(c, ERROR, "the unit has no directional derivatives");
    return ERROR;
}

EXPORT int NAMED(fmi2SetRealInputDerivatives)(instance c, const unsigned *references, size_t count, const int *orders,
                                              const double *values) {
    (void)references, (void)count, (void)orders, (void)values;
    say(c, ERROR, "inputs are held over a step and have no derivatives");
    return ERROR;
}

EXPORT int NAMED(fmi2GetRealOutputDerivatives)(instance c, const unsigned *references, size_t count, const int *orders,
                                               double *values) {
    (void)references, (void)count, (void)orders, (void)values;
    say(c, ERROR, "outputs have no derivatives");
    return ERROR;
}

EXPORT int NAMED(fmi2DoStep)(instance c, double now, double duration, boolean no_return) {
    (void)no_return;
    return do_step(c, now, duration);
}

EXPORT int NAMED(fmi2CancelStep)(instance c) {
    say(c, ERROR, "a step ends before it returns");
    return ERROR;
}

#define STATUS_OF(name, type) \
    EXPORT int NAMED(fmi2Get##name##Status)(instance c, int kind, type *value) { \
        (void)c, (void)kind, (void)value; \
        return DISCARD; \
    }

EXPORT int NAMED(fmi2GetStatus)(instance c, int kind, int *value) {
    (void)c, (void)kind, (void)value;
    return DISCARD;
}

EXPORT int NAMED(fmi2GetRealStatus)(instance c, int kind, double *value) {
    if (kind != 2) return DISCARD; /* 2: the time up to which the last step went */
    *value = ((component *)c)->time;
    return OK;
}

STATUS_OF(Integer, int)
STATUS_OF(Boolean, boolean)
STATUS_OF(String, text)
