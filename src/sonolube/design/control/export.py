"""Export of a tuned controller: C99 source for embedded targets, and its lookup table as CSV."""

from collections.abc import Sequence

from sonolube.design.control.controller import FrictionController
from sonolube.design.control.resonance_tracking import FrequencyTracker
from sonolube.rig import CommandedQuantity


def controller_source(controller: FrictionController, tracker: FrequencyTracker | None, *, title: str) -> str:
    """C99 source of a controller and a frequency tracker, in double precision.

    Parameters
    ----------
    controller : FrictionController
    tracker : FrequencyTracker or None
        None for a fixed frequency.
    title : str
        Title in the first comment.

    Returns
    -------
    str
        One translation unit without dependencies, allocation or global state. Call `sonolube_step` once every
        `SONOLUBE_INTERVAL` seconds; inputs must be finite.

    See Also
    --------
    lookup_table, next_level, next_frequency
    """
    quantity = controller.quantity
    values = {
        "INTERVAL": (controller.process.sample_interval, "s"),
        "INTRINSIC_FRICTION": (controller.intrinsic_friction_force, "N"),
        "PROPORTIONAL_GAIN": (controller.gains.proportional_gain, "N/N"),
        "INTEGRAL_GAIN": (controller.integral_gain, "N/N per interval"),
        "ANTI_WINDUP_GAIN": (controller.anti_windup_gain, "N/N per interval"),
        "LAG_COEFFICIENT": (controller.lag_coefficient, "per interval"),
        f"HIGHEST_{quantity.word.upper()}": (controller.level_maximum, _unit(quantity)),
    }
    defines = [f"#define SONOLUBE_{name} ({_number(value)}) /* {unit} */" for name, (value, unit) in values.items()]
    counts = [
        f"#define SONOLUBE_DEAD_TIME {controller.process.dead_time_samples} /* intervals */",
        f"#define SONOLUBE_POINTS {len(controller.force_reduction)}",
        f"#define SONOLUBE_FEED_FORWARD {int(controller.feed_forward)}",
    ]
    safe_title = " ".join(title.replace("*/", "* /").replace("/*", "/ *").split())
    parts = [
        f"/* Friction controller: {safe_title}. SI units; {quantity.word}s {quantity.qualifier}. */",
        "\n".join([*defines, *counts]),
        _array("force_reduction", controller.force_reduction),
        _array(quantity.word, controller.level),
        _step_source(quantity),
    ]
    if tracker is not None:
        parts.append(_tracker_source(tracker))
    return "\n\n".join(parts) + "\n"


def lookup_table(controller: FrictionController) -> str:
    """Lookup table of a controller as CSV: friction force, and peak-to-peak drive voltage or vibration amplitude.

    Parameters
    ----------
    controller : FrictionController

    Returns
    -------
    str
        A line of names with units, then the points by decreasing friction force; interpolate linearly.

    See Also
    --------
    controller_source
    """
    rows = [
        f"{controller.intrinsic_friction_force - reduction!r},{level!r}"
        for reduction, level in zip(controller.force_reduction, controller.level, strict=True)
    ]
    quantity = controller.quantity
    return "\n".join([f"friction_force [N],{quantity.name} [{quantity.unit}]", *rows]) + "\n"


def _unit(quantity: CommandedQuantity) -> str:
    """Unit of the commanded quantity in a comment, such as "V peak to peak"."""
    return f"{quantity.unit} {quantity.qualifier}"


def _step_source(quantity: CommandedQuantity) -> str:
    """C source of the controller's step, which returns the commanded quantity."""
    source = _STEP_SOURCE.strip().replace("LEVEL_MAXIMUM", f"SONOLUBE_HIGHEST_{quantity.word.upper()}")
    return source.replace("LEVEL_IN_UNITS", f"{quantity.word} in {_unit(quantity)}").replace("LEVEL", quantity.word)


def _number(value: float) -> str:
    """C literal of a double that restores it exactly."""
    return repr(float(value))


def _array(name: str, values: Sequence[float]) -> str:
    """C definition of a constant array."""
    rows = [", ".join(map(_number, values[i : i + 4])) for i in range(0, len(values), 4)]
    return f"static const double {name}[SONOLUBE_POINTS] = {{\n    " + ",\n    ".join(rows) + "\n};"


def _tracker_source(tracker: FrequencyTracker) -> str:
    """C source of the frequency tracker."""
    return f"""/* Drive frequency of the next interval in Hz, from the last and the phase of the impedance in rad. */
double sonolube_next_frequency(double frequency, double phase) {{
    const double unlimited = frequency + {_number(tracker.frequency_gain)} * ({_number(tracker.phase)} - phase);
    const double lowest = {_number(tracker.lowest_frequency)}, highest = {_number(tracker.highest_frequency)};
    return unlimited < lowest ? lowest : unlimited > highest ? highest : unlimited;
}}"""


_STEP_SOURCE = """
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
"""
