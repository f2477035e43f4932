"""The tuned controller for other machines: C99 source, and the lookup table as CSV."""

from collections.abc import Sequence

from sonolube.design.control.controller import FrictionController
from sonolube.design.control.tracking import FrequencyTracker


def controller_source(controller: FrictionController, tracker: FrequencyTracker | None, *, title: str) -> str:
    """Return a C99 translation unit that does what the controller and the tracker do, in double precision.

    Parameters
    ----------
    controller : FrictionController
    tracker : FrequencyTracker or None
        None where the frequency is fixed.
    title : str
        What it is for; goes into the first comment.

    Returns
    -------
    str
        Without dependencies, allocation or global state. Call `sonolube_step` once every `SONOLUBE_INTERVAL` seconds;
        inputs must be finite.
    """
    values = {
        "INTERVAL": (controller.process.sample_interval, "s"),
        "INTRINSIC_FRICTION": (controller.intrinsic_friction_force, "N"),
        "PROPORTIONAL_GAIN": (controller.gains.proportional_gain, "N/N"),
        "INTEGRAL_SHARE": (controller.integral_fraction, "N/N per interval"),
        "WINDUP_SHARE": (controller.windup_fraction, "N/N per interval"),
        "LAG_SHARE": (controller.lag_fraction, "per interval"),
        "HIGHEST_VOLTAGE": (controller.voltage_maximum, "V peak to peak"),
    }
    defines = [f"#define SONOLUBE_{name} ({_number(value)}) /* {unit} */" for name, (value, unit) in values.items()]
    counts = [
        f"#define SONOLUBE_DELAY {controller.process.delayed_samples} /* intervals */",
        f"#define SONOLUBE_POINTS {len(controller.saved_force)}",
        f"#define SONOLUBE_FEED_FORWARD {int(controller.feed_forward)}",
    ]
    safe_title = " ".join(title.replace("*/", "* /").replace("/*", "/ *").split())
    parts = [
        f"/* Friction controller: {safe_title}. SI units; voltages peak to peak. */",
        "\n".join([*defines, *counts]),
        _array("saved_force", controller.saved_force),
        _array("voltage", controller.voltage_peak_to_peak),
        _STEP_SOURCE.strip(),
    ]
    if tracker is not None:
        parts.append(_tracker_source(tracker))
    return "\n\n".join(parts) + "\n"


def lookup_table(controller: FrictionController) -> str:
    """Return the controller's table as CSV: wanted friction force, voltage peak to peak.

    Parameters
    ----------
    controller : FrictionController

    Returns
    -------
    str
        A line of names with units, then the points, friction falling; interpolate by straight lines.
    """
    rows = [
        f"{controller.intrinsic_friction_force - saved!r},{volts!r}"
        for saved, volts in zip(controller.saved_force, controller.voltage_peak_to_peak, strict=True)
    ]
    return "\n".join(["friction_force [N],voltage_peak_to_peak [V]", *rows]) + "\n"


def _number(value: float) -> str:
    return repr(float(value))


def _array(name: str, values: Sequence[float]) -> str:
    rows = [", ".join(map(_number, values[i : i + 4])) for i in range(0, len(values), 4)]
    return f"static const double {name}[SONOLUBE_POINTS] = {{\n    " + ",\n    ".join(rows) + "\n};"


def _tracker_source(tracker: FrequencyTracker) -> str:
    return f"""/* Frequency of the next interval in Hz, from the last and the phase of the impedance in rad. */
double sonolube_next_frequency(double frequency, double phase) {{
    const double moved = frequency + {_number(tracker.frequency_gain)} * ({_number(tracker.phase)} - phase);
    const double lowest = {_number(tracker.lowest_frequency)}, highest = {_number(tracker.highest_frequency)};
    return moved < lowest ? lowest : moved > highest ? highest : moved;
}}"""


_STEP_SOURCE = """
typedef struct {
    double integral;                     /* N */
    double expected[SONOLUBE_DELAY + 1]; /* N, newest last */
} sonolube_state;

void sonolube_reset(sonolube_state *state) {
    state->integral = 0.0;
    for (int i = 0; i <= SONOLUBE_DELAY; i++) state->expected[i] = SONOLUBE_INTRINSIC_FRICTION;
}

static double interpolated(double x, const double *known, const double *of) {
    if (x <= known[0]) return of[0];
    if (x >= known[SONOLUBE_POINTS - 1]) return of[SONOLUBE_POINTS - 1];
    int low = 0, high = SONOLUBE_POINTS - 1;
    while (high - low > 1) {
        const int middle = low + (high - low) / 2;
        if (known[middle] <= x) low = middle;
        else high = middle;
    }
    return of[low] + (of[high] - of[low]) / (known[high] - known[low]) * (x - known[low]);
}

/* Voltage for the next interval, from the friction wanted and the friction measured. */
double sonolube_step(sonolube_state *state, double reference, double measured) {
    const double base = SONOLUBE_FEED_FORWARD ? reference : SONOLUBE_INTRINSIC_FRICTION;
    const double error = (SONOLUBE_FEED_FORWARD ? state->expected[0] : reference) - measured;
    const double command = base + SONOLUBE_PROPORTIONAL_GAIN * error + state->integral;
    const double wanted = interpolated(SONOLUBE_INTRINSIC_FRICTION - command, saved_force, voltage);
    const double allowed = wanted < SONOLUBE_HIGHEST_VOLTAGE ? wanted : SONOLUBE_HIGHEST_VOLTAGE;
    const double given = SONOLUBE_INTRINSIC_FRICTION - interpolated(allowed, voltage, saved_force);
    state->integral += SONOLUBE_INTEGRAL_SHARE * error + SONOLUBE_WINDUP_SHARE * (given - command);
    const double newest = state->expected[SONOLUBE_DELAY];
    for (int i = 0; i < SONOLUBE_DELAY; i++) state->expected[i] = state->expected[i + 1];
    state->expected[SONOLUBE_DELAY] = newest + SONOLUBE_LAG_SHARE * (reference - newest);
    return allowed;
}
"""
