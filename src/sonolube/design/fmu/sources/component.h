/* An instance of the model, with its phase, its range checks and its snapshots, as both versions of FMI need it.
   C99; needs no file of the FMI standard. */
#include <math.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#if defined(_WIN32)
#define EXPORT __declspec(dllexport)
#elif defined(__GNUC__)
#define EXPORT __attribute__((visibility("default")))
#else
#define EXPORT
#endif

#define PASTE_NAMES(a, b) a##b
#define PASTE(a, b) PASTE_NAMES(a, b)

typedef enum { INPUT, OUTPUT } causality;

typedef struct {
    const char *name;
    const char *unit;
    causality kind;
    double start, min, max; /* infinite where there is no bound */
} variable;

#include "model.c" /* model, MODEL_VARIABLES, variables, model_reset, model_outputs, model_advance */

typedef enum { OK = 0, WARNING = 1, DISCARD = 2, ERROR = 3 } status;
typedef enum { INSTANTIATED, INITIALIZING, STEPPING, TERMINATED } phase_of_life;

typedef struct component component;
typedef void reporter(const component *, status, const char *category, const char *message);

struct component {
    model state;
    phase_of_life life;
    double start_time, time; /* s */
    bool stale;              /* whether outputs wait for an evaluation */
    bool logging;
    bool outside[MODEL_VARIABLES + 1]; /* inputs that were reported outside of their range; last the state */
    char *name;
    void *environment;
    reporter *report;
    void (*callback)(void); /* of the importer, cast back by the reporter */
};

typedef struct {
    model state;
    double start_time, time;
    uint32_t size;
    int life;
} snapshot;

/* Reports a sentence where the importer wants any. */
static void say(const component *c, status severity, const char *format, ...) {
    char message[512];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(message, sizeof message, format, arguments);
    va_end(arguments);
    if (c->logging && c->callback) {
        c->report(c, severity, severity == WARNING ? "logStatusWarning" : severity == DISCARD ? "logStatusDiscard"
                  : "logStatusError", message);
    }
}

static void restart(component *c) {
    model_reset(&c->state);
    memset(c->outside, 0, sizeof c->outside);
    c->life = INSTANTIATED;
    c->start_time = c->time = 0.0;
    c->stale = true;
}

static component *new_component(const char *name) {
    component *c = calloc(1, sizeof *c);
    if (!c) return NULL;
    const size_t length = name ? strlen(name) : 0;
    c->name = calloc(length + 1, 1);
    if (!c->name) {
        free(c);
        return NULL;
    }
    if (length) memcpy(c->name, name, length);
    restart(c);
    return c;
}

static void free_component(component *c) {
    if (!c) return;
    free(c->name);
    free(c);
}

/* Reports inputs that have left their range, once each time; a warning while one is outside. */
static status check_ranges(component *c) {
    status worst = OK;
    for (int i = 0; i < MODEL_VARIABLES; i++) {
        const variable *v = &variables[i];
        const double value = c->state.value[i];
        const bool outside = v->kind == INPUT && (value < v->min || value > v->max);
        if (outside && !c->outside[i]) {
            say(c, WARNING, "%s is %.9g %s at %.9g s, outside of %.9g to %.9g %s, for which the model was made: it is held"
                " at the nearer end", v->name, value, v->unit, c->time, v->min, v->max, v->unit);
        }
        c->outside[i] = outside;
        if (outside) worst = WARNING;
    }
    return worst;
}

/* Outputs of the present inputs and state. */
static status refresh(component *c) {
    if (c->stale) {
        model held = c->state;
        for (int i = 0; i < MODEL_VARIABLES; i++) {
            if (variables[i].kind == INPUT) held.value[i] = fmin(fmax(held.value[i], variables[i].min), variables[i].max);
        }
        const bool beyond = model_outputs(&held);
        for (int i = 0; i < MODEL_VARIABLES; i++) {
            if (variables[i].kind == OUTPUT) c->state.value[i] = held.value[i];
        }
        if (beyond && !c->outside[MODEL_VARIABLES]) say(c, WARNING, "at %.9g s " MODEL_BEYOND, c->time);
        c->outside[MODEL_VARIABLES] = beyond;
        c->stale = false;
    }
    return c->outside[MODEL_VARIABLES] ? WARNING : OK;
}

static status get_values(component *c, const uint32_t *references, size_t count, double *values) {
    const status found = refresh(c);
    for (size_t i = 0; i < count; i++) {
        if (references[i] > MODEL_VARIABLES) {
            say(c, ERROR, "there is no variable of the value reference %u", (unsigned)references[i]);
            return ERROR;
        }
        values[i] = references[i] ? c->state.value[references[i] - 1] : c->time;
    }
    return found;
}

static status set_values(component *c, const uint32_t *references, size_t count, const double *values) {
    for (size_t i = 0; i < count; i++) {
        if (!references[i] || references[i] > MODEL_VARIABLES || variables[references[i] - 1].kind != INPUT) {
            say(c, ERROR, "the value reference %u is none of an input", (unsigned)references[i]);
            return ERROR;
        }
        if (!isfinite(values[i])) {
            say(c, DISCARD, "%s must be finite; it keeps its value", variables[references[i] - 1].name);
            return DISCARD;
        }
    }
    for (size_t i = 0; i < count; i++) c->state.value[references[i] - 1] = values[i];
    c->stale = true;
    return check_ranges(c);
}

static status begin(component *c, double start_time) {
    if (c->life != INSTANTIATED) {
        say(c, ERROR, "initialization follows instantiation or reset");
        return ERROR;
    }
    c->life = INITIALIZING;
    c->start_time = c->time = start_time;
    return OK;
}

static status finish_initialization(component *c) {
    if (c->life != INITIALIZING) {
        say(c, ERROR, "there is no initialization to leave");
        return ERROR;
    }
    c->life = STEPPING;
    return check_ranges(c);
}

static status do_step(component *c, double now, double duration) {
    if (c->life != STEPPING) {
        say(c, ERROR, "a step follows initialization");
        return ERROR;
    }
    if (!(duration > 0.0) || !isfinite(duration) || !(fabs(now - c->time) <= 1e-9 * (fabs(now) + duration))) {
        say(c, ERROR, "a step of %.9g s from %.9g s does not continue from %.9g s", duration, now, c->time);
        return ERROR;
    }
    const status ranges = check_ranges(c);
    model held = c->state;
    for (int i = 0; i < MODEL_VARIABLES; i++) {
        if (variables[i].kind == INPUT) held.value[i] = fmin(fmax(held.value[i], variables[i].min), variables[i].max);
    }
    model_advance(&held, now - c->start_time, duration);
    for (int i = 0; i < MODEL_VARIABLES; i++) {
        if (variables[i].kind == INPUT) held.value[i] = c->state.value[i];
    }
    c->state = held;
    c->time = now + duration;
    c->stale = true;
    const status inside = refresh(c);
    return ranges > inside ? ranges : inside;
}

/* Snapshots of an instance, whose bytes have a meaning on this platform only. */
static status take_snapshot(component *c, void **target) {
    snapshot *taken = *target ? *target : calloc(1, sizeof *taken);
    if (!taken) {
        say(c, ERROR, "there is no memory for a state");
        return ERROR;
    }
    memset(taken, 0, sizeof *taken);
    taken->state = c->state;
    taken->start_time = c->start_time;
    taken->time = c->time;
    taken->size = (uint32_t)sizeof *taken;
    taken->life = (int)c->life;
    *target = taken;
    return OK;
}

static status restore_snapshot(component *c, const void *source) {
    const snapshot *taken = source;
    if (!taken || taken->size != sizeof *taken) {
        say(c, ERROR, "the state is none of this model");
        return ERROR;
    }
    c->state = taken->state;
    c->start_time = taken->start_time;
    c->time = taken->time;
    c->life = (phase_of_life)taken->life;
    memset(c->outside, 0, sizeof c->outside);
    c->stale = true;
    return OK;
}

static status write_snapshot(component *c, const void *source, unsigned char *bytes, size_t size) {
    if (!source || size < sizeof(snapshot)) {
        say(c, ERROR, "a state takes %u bytes", (unsigned)sizeof(snapshot));
        return ERROR;
    }
    memcpy(bytes, source, sizeof(snapshot));
    return OK;
}

static status read_snapshot(component *c, const unsigned char *bytes, size_t size, void **target) {
    snapshot *taken = size == sizeof *taken ? malloc(sizeof *taken) : NULL;
    if (taken) memcpy(taken, bytes, sizeof *taken);
    if (!taken || taken->size != sizeof *taken) {
        free(taken);
        say(c, ERROR, "the bytes are no state of this model");
        return ERROR;
    }
    *target = taken;
    return OK;
}
