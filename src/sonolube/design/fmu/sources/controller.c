/* Sampled friction controller, whose law is that of the file control_law.c. */
#include "model_data.h"

#include "control_law.c" /* sonolube_state, sonolube_reset, sonolube_step, sonolube_next_frequency */

#define MODEL_BEYOND "the command is beyond its range"

typedef struct {
    double value[MODEL_VARIABLES];
    sonolube_state law;
    double samples; /* taken so far */
} model;

static void model_reset(model *m) {
    memset(m, 0, sizeof *m);
    for (int i = 0; i < MODEL_VARIABLES; i++) m->value[i] = variables[i].start;
    sonolube_reset(&m->law);
}

/* Outputs change at samples only. */
static bool model_outputs(model *m) {
    (void)m;
    return false;
}

/* Takes the samples from a time, counted from the start, up to but without the end of the step. */
static void model_advance(model *m, double now, double duration) {
    const double end = (now + duration) / SONOLUBE_INTERVAL - 1e-6;
    for (; m->samples < end; m->samples += 1.0) {
#if HAS_TRACKER
        if (m->value[LEVEL] > LEAST_TRACKED_LEVEL) {
            m->value[FREQUENCY] = sonolube_next_frequency(m->value[FREQUENCY], m->value[PHASE]);
        }
#endif
        m->value[LEVEL] = sonolube_step(&m->law, m->value[SETPOINT], m->value[FRICTION_FORCE]);
    }
}
