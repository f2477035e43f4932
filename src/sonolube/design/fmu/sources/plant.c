/* Slow envelope of a vibrated rig: the level that maintains the vibration follows the drive as one resonance does;
   friction, amplitude and velocity are Chebyshev polynomials of level, frequency, load and sliding speed. */
#include "model_data.h"

#define MODEL_BEYOND "the vibration exceeds that of the highest level at this frequency: it is held there"
#define LARGEST_ORDER 96
#define TWO_PI 6.283185307179586

typedef struct {
    double value[MODEL_VARIABLES];
    double real, imaginary; /* envelope: the level that maintains it at resonance, in phase with the drive and across */
    double bulk_rise;       /* K */
} model;

typedef struct {
    double rate, detuning, conductance, capacitance; /* 1/s, rad/s, S, F */
} resonance;

/* Chebyshev polynomials of the first kind at x between two ends. */
static void polynomials(double x, const double ends[2], int count, double *values) {
    const double half = 0.5 * (ends[1] - ends[0]);
    const double y = half > 0.0 ? fmin(fmax((x - 0.5 * (ends[0] + ends[1])) / half, -1.0), 1.0) : 0.0;
    values[0] = 1.0;
    if (count > 1) values[1] = y;
    for (int i = 2; i < count; i++) values[i] = 2.0 * y * values[i - 1] - values[i - 2];
}

/* Value of a table whose rows over the last axis follow each other. */
static double tabulated(const double *coefficients, const int *shape, const double *const *ends, int axes,
                        const double *point) {
    double basis[4][LARGEST_ORDER];
    int index[4] = {0, 0, 0, 0};
    int rows = 1;
    for (int a = 0; a < axes; a++) polynomials(point[a], ends[a], shape[a], basis[a]);
    for (int a = 0; a + 1 < axes; a++) rows *= shape[a];
    const int last = shape[axes - 1];
    double total = 0.0;
    for (int row = 0; row < rows; row++) {
        double weight = 1.0, sum = 0.0;
        for (int a = 0; a + 1 < axes; a++) weight *= basis[a][index[a]];
        const double *along = coefficients + (size_t)row * (size_t)last;
        for (int k = 0; k < last; k++) sum += along[k] * basis[axes - 1][k];
        total += weight * sum;
        for (int a = axes - 2; a >= 0 && ++index[a] == shape[a]; a--) index[a] = 0;
    }
    return total;
}

#define TABLE(name, axes, point) tabulated(name, name##_shape, name##_ends, axes, point)

static resonance resonance_at(double frequency, double load) {
    resonance r;
    r.rate = TABLE(decay_rate, 1, &load);
    r.detuning = TWO_PI * (frequency - TABLE(natural_frequency, 1, &load));
    r.conductance = TABLE(motional_conductance, 1, &load);
    r.capacitance = TABLE(parallel_capacitance, 1, &load);
    return r;
}

/* Level whose steady vibration an envelope is; whether that is beyond the table is written. */
static double level_of(double real, double imaginary, resonance r, bool *beyond) {
    const double level = hypot(real, imaginary) * hypot(r.rate, r.detuning) / r.rate;
    *beyond = level > level_ends[1] * (1.0 + 1e-9);
    return fmin(level, level_ends[1]);
}

/* Friction with vibration over that without. */
static double friction_ratio(double level, double frequency, double load, double speed) {
    const double drive[3] = {level, frequency, load};
    const double velocity = level * TABLE(velocity_per_level, 3, drive);
    const double scale = velocity * TABLE(threshold, 1, &load);
#if HAS_THRESHOLD
    if (speed >= scale) return TABLE(fast_ratio, 3, drive);
    const double x = sqrt(sqrt(speed / scale));
#else
    const double x = sqrt(speed / (speed + scale));
#endif
    const double point[4] = {level, frequency, load, x};
    return TABLE(slow_ratio, 4, point);
}

static void model_reset(model *m) {
    memset(m, 0, sizeof *m);
    for (int i = 0; i < MODEL_VARIABLES; i++) m->value[i] = variables[i].start;
}

/* Writes the outputs of inputs and state; whether the vibration is beyond the tables. */
static bool model_outputs(model *m) {
    double *v = m->value;
    const double frequency = v[FREQUENCY], load = v[NORMAL_LOAD], speed = v[SLIDING_SPEED];
    const resonance r = resonance_at(frequency, load);
    bool beyond;
    const double level = level_of(m->real, m->imaginary, r, &beyond);
    const double drive[3] = {level, frequency, load};
    const double ratio = friction_ratio(level, frequency, load, speed);
    v[FRICTION_RATIO] = ratio;
    v[FRICTION_COEFFICIENT] = ratio * INTRINSIC_COEFFICIENT;
    v[FRICTION_FORCE] = ratio * INTRINSIC_COEFFICIENT * load;
    v[VIBRATION_AMPLITUDE] = level * TABLE(amplitude_per_level, 3, drive);
#if HAS_CURRENT
    const double conducted = r.conductance * m->real;
    const double displaced = TWO_PI * frequency * r.capacitance * v[LEVEL] + r.conductance * m->imaginary;
    v[PEAK_CURRENT] = 0.5 * hypot(conducted, displaced);
    v[PHASE] = v[PEAK_CURRENT] > 0.0 ? -atan2(displaced, conducted) : -0.25 * TWO_PI;
#endif
#if HAS_HEAT
    v[TEMPERATURE_RISE] = m->bulk_rise + TABLE(flash_rise_per_heat, 1, &speed) * v[FRICTION_FORCE] * speed;
#endif
    return beyond;
}

#if HAS_HEAT
/* Heat into the pin at a deviation of the envelope from its steady state, in W. */
static double heat_into_pin(const model *m, resonance r, const double *steady, const double *deviation, double time) {
    const double frequency = m->value[FREQUENCY], load = m->value[NORMAL_LOAD], speed = m->value[SLIDING_SPEED];
    const double decay = exp(-r.rate * time), c = cos(r.detuning * time), s = sin(r.detuning * time);
    bool beyond;
    const double level = level_of(steady[0] + decay * (deviation[0] * c + deviation[1] * s),
                                  steady[1] + decay * (deviation[1] * c - deviation[0] * s), r, &beyond);
    const double force = friction_ratio(level, frequency, load, speed) * INTRINSIC_COEFFICIENT * load;
    return TABLE(heat_partition, 1, &speed) * force * speed;
}

/* Bulk rise after a time: exactly for constant heat, by Gauss' quadrature while the envelope settles. */
static double bulk_rise_after(const model *m, resonance r, const double *steady, const double *deviation, double duration) {
    static const double node[3] = {0.1127016653792583, 0.5, 0.8872983346207417};
    static const double weight[3] = {0.2777777777777778, 0.4444444444444444, 0.2777777777777778};
    const double loss = THERMAL_CONDUCTANCE / HEAT_CAPACITY;
    const bool settled = hypot(deviation[0], deviation[1]) <= 1e-12 * level_ends[1];
    const double settling = settled ? 0.0 : fmin(duration, 30.0 / r.rate);
    const int panels = (int)ceil(settling * hypot(r.rate, r.detuning));
    double rise = m->bulk_rise * exp(-loss * duration);
    for (int i = 0; i < panels; i++) {
        const double width = settling / panels;
        for (int k = 0; k < 3; k++) {
            const double time = (i + node[k]) * width;
            const double heat = heat_into_pin(m, r, steady, deviation, time);
            rise += weight[k] * width * heat / HEAT_CAPACITY * exp(-loss * (duration - time));
        }
    }
    const double still[2] = {0.0, 0.0}, rest = duration - settling;
    if (rest > 0.0) {
        rise += heat_into_pin(m, r, steady, still, 0.0) / HEAT_CAPACITY * (loss > 0.0 ? -expm1(-loss * rest) / loss : rest);
    }
    return rise;
}
#endif

/* Envelope and bulk after a time under constant inputs. */
static void model_advance(model *m, double now, double duration) {
    (void)now;
    const resonance r = resonance_at(m->value[FREQUENCY], m->value[NORMAL_LOAD]);
    const double square = r.rate * r.rate + r.detuning * r.detuning, level = m->value[LEVEL];
    const double steady[2] = {r.rate * r.rate * level / square, -r.rate * r.detuning * level / square};
    const double deviation[2] = {m->real - steady[0], m->imaginary - steady[1]};
    const double decay = exp(-r.rate * duration), c = cos(r.detuning * duration), s = sin(r.detuning * duration);
#if HAS_HEAT
    m->bulk_rise = bulk_rise_after(m, r, steady, deviation, duration);
#endif
    m->real = steady[0] + decay * (deviation[0] * c + deviation[1] * s);
    m->imaginary = steady[1] + decay * (deviation[1] * c - deviation[0] * s);
}
