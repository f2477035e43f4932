typedef struct {
    double integral;                             /* N */
    double model_output[SONOLUBE_DEAD_TIME + 1]; /* N, the latest last */
} sonolube_state;

void sonolube_reset(sonolube_state *state) {
    state->integral = 0.0;
    for (int i = 0; i <= SONOLUBE_DEAD_TIME; i++) state->model_output[i] = SONOLUBE_INTRINSIC_FRICTION;
}

static double interpolated(double x, const double *abscissa, const double *ordinate) {
    if (x <= abscissa[0]) return ordinate[0];
    if (x >= abscissa[SONOLUBE_POINTS - 1]) return ordinate[SONOLUBE_POINTS - 1];
    int low = 0, high = SONOLUBE_POINTS - 1;
    while (high - low > 1) {
        const int middle = low + (high - low) / 2;
        if (abscissa[middle] <= x) low = middle;
        else high = middle;
    }
    return ordinate[low]
        + (ordinate[high] - ordinate[low]) / (abscissa[high] - abscissa[low]) * (x - abscissa[low]);
}

/* The LEVEL_IN_UNITS of the next interval, from the set-point and the measured friction force in N. */
double sonolube_step(sonolube_state *state, double setpoint, double measured) {
    const double base = SONOLUBE_FEED_FORWARD ? setpoint : SONOLUBE_INTRINSIC_FRICTION;
    const double error = (SONOLUBE_FEED_FORWARD ? state->model_output[0] : setpoint) - measured;
    const double command = base + SONOLUBE_PROPORTIONAL_GAIN * error + state->integral;
    const double unsaturated = interpolated(SONOLUBE_INTRINSIC_FRICTION - command, force_reduction, LEVEL);
    const double allowed = unsaturated < LEVEL_MAXIMUM ? unsaturated : LEVEL_MAXIMUM;
    const double saturated = SONOLUBE_INTRINSIC_FRICTION - interpolated(allowed, LEVEL, force_reduction);
    state->integral += SONOLUBE_INTEGRAL_GAIN * error + SONOLUBE_ANTI_WINDUP_GAIN * (saturated - command);
    const double latest = state->model_output[SONOLUBE_DEAD_TIME];
    for (int i = 0; i < SONOLUBE_DEAD_TIME; i++) state->model_output[i] = state->model_output[i + 1];
    state->model_output[SONOLUBE_DEAD_TIME] = latest + SONOLUBE_LAG_COEFFICIENT * (setpoint - latest);
    return allowed;
}
