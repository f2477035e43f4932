/* Co-simulation interface by the Functional Mock-up Interface 3.0, declared here from the text of the standard. */
#include "component.h"

#ifdef FMI3_FUNCTION_PREFIX
#define NAMED(name) PASTE(FMI3_FUNCTION_PREFIX, name)
#else
#define NAMED(name) name
#endif

typedef void *instance;
typedef const char *text;
typedef const uint32_t *references_of;
typedef void log_message(void *environment, int severity, text category, text message);
typedef void any_function(void);

static void report(const component *c, status severity, const char *category, const char *message) {
    ((log_message *)c->callback)(c->environment, (int)severity, category, message);
}

static int refused(component *c, const char *what) {
    say(c, ERROR, "the unit has no %s", what);
    return ERROR;
}

EXPORT text NAMED(fmi3GetVersion)(void) { return "3.0"; }

EXPORT int NAMED(fmi3SetDebugLogging)(instance c, bool logging, size_t count, const text *categories) {
    (void)count, (void)categories;
    ((component *)c)->logging = logging;
    return OK;
}

EXPORT instance NAMED(fmi3InstantiateCoSimulation)(text name, text token, text resources, bool visible, bool logging,
                                                   bool event_mode, bool early_return, references_of intermediate,
                                                   size_t count, void *environment, log_message *logger,
                                                   any_function *update) {
    (void)resources, (void)visible, (void)event_mode, (void)early_return, (void)intermediate, (void)count, (void)update;
    component *c = new_component(name);
    if (!c) return NULL;
    c->report = report;
    c->callback = (any_function *)logger;
    c->environment = environment;
    c->logging = true; /* of what prevents the instance, whatever the categories */
    if (!token || strcmp(token, MODEL_TOKEN) != 0) {
        say(c, ERROR, "the instantiation token is not that of the model description");
        free_component(c);
        return NULL;
    }
    c->logging = logging;
    return c;
}

EXPORT instance NAMED(fmi3InstantiateModelExchange)(text name, text token, text resources, bool visible, bool logging,
                                                    void *environment, log_message *logger) {
    (void)name, (void)token, (void)resources, (void)visible, (void)logging, (void)environment, (void)logger;
    return NULL;
}

EXPORT instance NAMED(fmi3InstantiateScheduledExecution)(text name, text token, text resources, bool visible, bool logging,
                                                         void *environment, log_message *logger, any_function *update,
                                                         any_function *lock, any_function *unlock) {
    (void)name, (void)token, (void)resources, (void)visible, (void)logging, (void)environment, (void)logger;
    (void)update, (void)lock, (void)unlock;
    return NULL;
}

EXPORT void NAMED(fmi3FreeInstance)(instance c) { free_component(c); }

EXPORT int NAMED(fmi3EnterInitializationMode)(instance c, bool has_tolerance, double tolerance, double start,
                                              bool has_stop, double stop) {
    (void)has_tolerance, (void)tolerance, (void)has_stop, (void)stop;
    return begin(c, start);
}

EXPORT int NAMED(fmi3ExitInitializationMode)(instance c) { return finish_initialization(c); }

EXPORT int NAMED(fmi3Terminate)(instance c) {
    ((component *)c)->life = TERMINATED;
    return OK;
}

EXPORT int NAMED(fmi3Reset)(instance c) {
    restart(c);
    return OK;
}

EXPORT int NAMED(fmi3GetFloat64)(instance c, references_of references, size_t count, double *values, size_t number) {
    if (number != count) return refused(c, "arrays");
    return get_values(c, references, count, values);
}

EXPORT int NAMED(fmi3SetFloat64)(instance c, references_of references, size_t count, const double *values, size_t number) {
    if (number != count) return refused(c, "arrays");
    return set_values(c, references, count, values);
}

#define OTHER_TYPE(name, type) \
    EXPORT int NAMED(fmi3Get##name)(instance c, references_of references, size_t count, type *values, size_t number) { \
        (void)references, (void)values, (void)number; \
        return count ? refused(c, "variables but of Float64") : OK; \
    } \
    EXPORT int NAMED(fmi3Set##name)(instance c, references_of references, size_t count, const type *values, \
                                    size_t number) { \
        (void)references, (void)values, (void)number; \
        return count ? refused(c, "variables but of Float64") : OK; \
    }

OTHER_TYPE(Float32, float)
OTHER_TYPE(Int8, int8_t)
OTHER_TYPE(UInt8, uint8_t)
OTHER_TYPE(Int16, int16_t)
OTHER_TYPE(UInt16, uint16_t)
OTHER_TYPE(Int32, int32_t)
OTHER_TYPE(UInt32, uint32_t)
OTHER_TYPE(Int64, int64_t)
OTHER_TYPE(UInt64, uint64_t)
OTHER_TYPE(Boolean, bool)
OTHER_TYPE(String, text)

EXPORT int NAMED(fmi3GetBinary)(instance c, references_of references, size_t count, size_t *sizes,
                                const unsigned char **values, size_t number) {
    (void)references, (void)sizes, (void)values, (void)number;
    return count ? refused(c, "variables but of Float64") : OK;
}

EXPORT int NAMED(fmi3SetBinary)(instance c, references_of references, size_t count, const size_t *sizes,
                                const unsigned char *const *values, size_t number) {
    (void)references, (void)sizes, (void)values, (void)number;
    return count ? refused(c, "variables but of Float64") : OK;
}

EXPORT int NAMED(fmi3GetClock)(instance c, references_of references, size_t count, bool *values) {
    (void)references, (void)values;
    return count ? refused(c, "clocks") : OK;
}

EXPORT int NAMED(fmi3SetClock)(instance c, references_of references, size_t count, const bool *values) {
    (void)references, (void)values;
    return count ? refused(c, "clocks") : OK;
}

EXPORT int NAMED(fmi3GetNumberOfVariableDependencies)(instance c, uint32_t reference, size_t *count) {
    (void)reference, (void)count;
    return refused(c, "dependencies that change");
}

EXPORT int NAMED(fmi3GetVariableDependencies)(instance c, uint32_t dependent, size_t *elements, uint32_t *independents,
                                              size_t *their_elements, int *kinds, size_t count) {
    (void)dependent, (void)elements, (void)independents, (void)their_elements, (void)kinds, (void)count;
    return refused(c, "dependencies that change");
}

EXPORT int NAMED(fmi3GetFMUState)(instance c, void **state) { return take_snapshot(c, state); }

EXPORT int NAMED(fmi3SetFMUState)(instance c, void *state) { return restore_snapshot(c, state); }

EXPORT int NAMED(fmi3FreeFMUState)(instance c, void **state) {
    (void)c;
    free(*state);
    *state = NULL;
    return OK;
}

EXPORT int NAMED(fmi3SerializedFMUStateSize)(instance c, void *state, size_t *size) {
    (void)c, (void)state;
    *size = sizeof(snapshot);
    return OK;
}

EXPORT int NAMED(fmi3SerializeFMUState)(instance c, void *state, unsigned char *bytes, size_t size) {
    return write_snapshot(c, state, bytes, size);
}

EXPORT int NAMED(fmi3DeserializeFMUState)(instance c, const unsigned char *bytes, size_t size, void **state) {
    return read_snapshot(c, bytes, size, state);
}

EXPORT int NAMED(fmi3DoStep)(instance c, double now, double duration, bool no_return, bool *event, bool *terminate,
                             bool *early, double *last) {
    (void)no_return;
    *event = *terminate = *early = false;
    const status found = do_step(c, now, duration);
    *last = ((component *)c)->time;
    return found;
}

/* Functions of other kinds of units, which every library has to have. */
#define WITHOUT_ARGUMENTS(name, what) \
    EXPORT int NAMED(fmi3##name)(instance c) { return refused(c, what); }

WITHOUT_ARGUMENTS(EnterConfigurationMode, "structural parameters")
WITHOUT_ARGUMENTS(ExitConfigurationMode, "structural parameters")
WITHOUT_ARGUMENTS(EnterEventMode, "events")
WITHOUT_ARGUMENTS(EnterContinuousTimeMode, "model exchange")
WITHOUT_ARGUMENTS(EnterStepMode, "events")
WITHOUT_ARGUMENTS(EvaluateDiscreteStates, "discrete states")

#define DERIVATIVE(name) \
    EXPORT int NAMED(fmi3Get##name##Derivative)(instance c, references_of unknown, size_t unknowns, references_of known, \
                                                size_t count, const double *seed, size_t seeds, double *sensitivity, \
                                                size_t sensitivities) { \
        (void)unknown, (void)unknowns, (void)known, (void)count, (void)seed, (void)seeds, (void)sensitivity; \
        (void)sensitivities; \
        return refused(c, "derivatives"); \
    }

DERIVATIVE(Directional)
DERIVATIVE(Adjoint)

EXPORT int NAMED(fmi3GetIntervalDecimal)(instance c, references_of r, size_t count, double *values, int *qualifiers) {
    (void)r, (void)count, (void)values, (void)qualifiers;
    return refused(c, "clocks");
}

EXPORT int NAMED(fmi3GetIntervalFraction)(instance c, references_of r, size_t count, uint64_t *counters,
                                          uint64_t *resolutions, int *qualifiers) {
    (void)r, (void)count, (void)counters, (void)resolutions, (void)qualifiers;
    return refused(c, "clocks");
}

EXPORT int NAMED(fmi3GetShiftDecimal)(instance c, references_of r, size_t count, double *shifts) {
    (void)r, (void)count, (void)shifts;
    return refused(c, "clocks");
}

EXPORT int NAMED(fmi3GetShiftFraction)(instance c, references_of r, size_t count, uint64_t *counters,
                                       uint64_t *resolutions) {
    (void)r, (void)count, (void)counters, (void)resolutions;
    return refused(c, "clocks");
}

EXPORT int NAMED(fmi3SetIntervalDecimal)(instance c, references_of r, size_t count, const double *intervals) {
    (void)r, (void)count, (void)intervals;
    return refused(c, "clocks");
}

EXPORT int NAMED(fmi3SetIntervalFraction)(instance c, references_of r, size_t count, const uint64_t *counters,
                                          const uint64_t *resolutions) {
    (void)r, (void)count, (void)counters, (void)resolutions;
    return refused(c, "clocks");
}

EXPORT int NAMED(fmi3SetShiftDecimal)(instance c, references_of r, size_t count, const double *shifts) {
    (void)r, (void)count, (void)shifts;
    return refused(c, "clocks");
}

EXPORT int NAMED(fmi3SetShiftFraction)(instance c, references_of r, size_t count, const uint64_t *counters,
                                       const uint64_t *resolutions) {
    (void)r, (void)count, (void)counters, (void)resolutions;
    return refused(c, "clocks");
}

EXPORT int NAMED(fmi3UpdateDiscreteStates)(instance c, bool *again, bool *terminate, bool *nominals, bool *states,
                                           bool *has_next, double *next) {
    (void)again, (void)terminate, (void)nominals, (void)states, (void)has_next, (void)next;
    return refused(c, "discrete states");
}

EXPORT int NAMED(fmi3CompletedIntegratorStep)(instance c, bool no_return, bool *event, bool *terminate) {
    (void)no_return, (void)event, (void)terminate;
    return refused(c, "model exchange");
}

EXPORT int NAMED(fmi3SetTime)(instance c, double time) {
    (void)time;
    return refused(c, "model exchange");
}

EXPORT int NAMED(fmi3SetContinuousStates)(instance c, const double *states, size_t count) {
    (void)states, (void)count;
    return refused(c, "model exchange");
}

#define CONTINUOUS(name) \
    EXPORT int NAMED(fmi3Get##name)(instance c, double *values, size_t count) { \
        (void)values, (void)count; \
        return refused(c, "model exchange"); \
    }

CONTINUOUS(ContinuousStateDerivatives)
CONTINUOUS(EventIndicators)
CONTINUOUS(ContinuousStates)
CONTINUOUS(NominalsOfContinuousStates)

EXPORT int NAMED(fmi3GetNumberOfEventIndicators)(instance c, size_t *count) {
    (void)count;
    return refused(c, "model exchange");
}

EXPORT int NAMED(fmi3GetNumberOfContinuousStates)(instance c, size_t *count) {
    (void)count;
    return refused(c, "model exchange");
}

EXPORT int NAMED(fmi3GetOutputDerivatives)(instance c, references_of r, size_t count, const int32_t *orders,
                                           double *values, size_t number) {
    (void)r, (void)count, (void)orders, (void)values, (void)number;
    return refused(c, "derivatives of outputs");
}

EXPORT int NAMED(fmi3ActivateModelPartition)(instance c, uint32_t clock, double time) {
    (void)clock, (void)time;
    return refused(c, "clocks");
}
