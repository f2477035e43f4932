"""Sampled friction controller: PI control with feed-forward and anti-windup, and its export as C99 source and CSV.

The C source `controller_step.c` beside this module repeats the function `next_level` line by line; LEVEL stands there
for the commanded quantity.
"""

from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass
from math import isnan
from pathlib import Path

from sonolube.checks import Floats, require_positive
from sonolube.design.control.friction_characteristic import FrictionCharacteristic, linear_characteristic
from sonolube.design.control.process import PIGains, Process, simc_gains
from sonolube.design.control.resonance_tracking import FrequencyTracker
from sonolube.rig import VOLTAGE, CommandedQuantity
from sonolube.rig.datasets import PREDICTED_FORCE


@dataclass(frozen=True, kw_only=True, slots=True)
class FrictionController:
    r"""PI controller of the friction force with feed-forward and anti-windup, through an inverse static characteristic.

    Parameters
    ----------
    process : Process
        Lag, dead time and sampling interval of the tuning.
    gains : PIGains
    intrinsic_friction_force : float
        Friction without vibration. [N]
    force_reduction : tuple of float
        Reduction of the friction force at the points of the characteristic, increasing from zero, in N.
    level : tuple of float
        Peak-to-peak drive voltages, or vibration amplitudes, at these points, increasing from zero, in V or m.
    level_maximum : float
        Largest of them that is commanded, in V or m.
    quantity : CommandedQuantity
        Voltage or amplitude.
    feed_forward : bool
        Whether the set-point is fed forward; otherwise the integral part alone brings the command to it.

    Notes
    -----
    The command is a friction force, which the inverse characteristic converts to a voltage or an amplitude: a static
    nonlinearity is cancelled by its inverse, so that the gain of the loop does not depend on the set-point. With
    feed-forward, the feedback acts on the difference of the measurement from a reference model, the response of the
    process to the set-point with its dead time (two-degree-of-freedom control). Unlike in a Smith predictor, the model
    receives the set-point rather than the command, so that disturbances see the plain PI loop. See `next_level` for the
    equations.
    """

    process: Process
    gains: PIGains
    intrinsic_friction_force: float
    force_reduction: tuple[float, ...]
    level: tuple[float, ...]
    level_maximum: float
    quantity: CommandedQuantity = VOLTAGE
    feed_forward: bool = True

    @property
    def integral_gain(self) -> float:
        """Change of the integral part per error and interval: K_c T / tau_I."""
        return self.gains.proportional_gain * self.process.sample_interval / self.gains.integral_time

    @property
    def anti_windup_gain(self) -> float:
        """Change of the integral part per saturation and interval, by back-calculation: T / tau_I, at most 1."""
        return min(self.process.sample_interval / self.gains.integral_time, 1.0)

    @property
    def lag_coefficient(self) -> float:
        """Coefficient of the reference model's lag: 1 - exp(-T / tau)."""
        return 1 - self.process.pole


@dataclass(slots=True)
class ControllerState:
    """State of a controller between intervals; forces in N.

    Parameters
    ----------
    integral : float
        Integral part of the command.
    model_output : list of float
        Output of the reference model, the latest last, over the dead time and one interval more.
    """

    integral: float
    model_output: list[float]


def tuned_controller(
    characteristic: FrictionCharacteristic,
    process: Process,
    *,
    level_maximum: float,
    closed_loop_time: float | None = None,
    feed_forward: bool = True,
) -> FrictionController:
    """Friction controller tuned by Skogestad's SIMC rule.

    Parameters
    ----------
    characteristic : FrictionCharacteristic
        Of the plant; without feed-forward only its two ends are used.
    process : Process
    level_maximum : float
        Largest commanded peak-to-peak voltage or amplitude, in V or m.
    closed_loop_time : float, optional
        Desired closed-loop time constant; by default the effective dead time. [s]
    feed_forward : bool
        Whether the set-point is fed forward.

    Returns
    -------
    FrictionController

    See Also
    --------
    simc_gains, next_level
    """
    table = characteristic if feed_forward else linear_characteristic(characteristic)
    return FrictionController(
        process=process,
        gains=simc_gains(process, closed_loop_time=closed_loop_time),
        intrinsic_friction_force=table.highest_force,
        force_reduction=tuple((table.highest_force - table.friction_force).tolist()),
        level=tuple(table.level.tolist()),
        level_maximum=float(require_positive(level_maximum=level_maximum)),
        quantity=table.quantity,
        feed_forward=feed_forward,
    )


def initial_state(controller: FrictionController) -> ControllerState:
    """State of a controller before its first interval, at friction without vibration.

    Parameters
    ----------
    controller : FrictionController

    Returns
    -------
    ControllerState
    """
    model_output = [controller.intrinsic_friction_force] * (controller.process.dead_time_samples + 1)
    return ControllerState(integral=0.0, model_output=model_output)


def next_level(controller: FrictionController, state: ControllerState, setpoint: float, measured: float) -> float:
    r"""Peak-to-peak drive voltage or amplitude over the next interval, in V or m; updates the state.

    Parameters
    ----------
    controller : FrictionController
    state : ControllerState
    setpoint : float
        Commanded friction force, in N.
    measured : float
        Measured friction force, in N.

    Returns
    -------
    float

    Notes
    -----
    With the set-point :math:`r`, the measurement :math:`y`, the output :math:`\hat F` of the reference model and the
    command :math:`w`,

    .. math::

        e &= \hat F - y, \qquad w = r + K_c e + I

        I &\leftarrow I + \frac{K_c T}{\tau_I} e + \frac{T}{\tau_I} (w_{sat} - w)

    where :math:`w_{sat}` is the force at the saturated voltage or amplitude (anti-windup by back-calculation). Without
    feed-forward :math:`e = r - y`, and :math:`w` starts from the intrinsic friction force.
    """
    intrinsic = controller.intrinsic_friction_force
    base = setpoint if controller.feed_forward else intrinsic
    error = (state.model_output[0] if controller.feed_forward else setpoint) - measured
    command = base + controller.gains.proportional_gain * error + state.integral
    unsaturated = _interpolated(intrinsic - command, controller.force_reduction, controller.level)
    level = min(unsaturated, controller.level_maximum)
    saturated = intrinsic - _interpolated(level, controller.level, controller.force_reduction)
    state.integral += controller.integral_gain * error + controller.anti_windup_gain * (saturated - command)
    latest = state.model_output[-1]
    state.model_output.append(latest + controller.lag_coefficient * (setpoint - latest))
    del state.model_output[0]
    return level


def _interpolated(x: float, abscissa: Sequence[float], ordinate: Sequence[float]) -> float:
    """Linear interpolation at x, constant beyond the ends."""
    if x <= abscissa[0]:
        return ordinate[0]
    if x >= abscissa[-1]:
        return ordinate[-1]
    i = bisect_right(abscissa, x) - 1
    return ordinate[i] + (ordinate[i + 1] - ordinate[i]) / (abscissa[i + 1] - abscissa[i]) * (x - abscissa[i])


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


def lookup_table(controller: FrictionController, *, predicted: Floats | None = None) -> str:
    """Lookup table of a controller as CSV: friction force, and peak-to-peak drive voltage or vibration amplitude.

    Parameters
    ----------
    controller : FrictionController
    predicted : ndarray, shape (3, n), optional
        Lower end of the 80 % interval, median and upper end of the predicted friction force at each point, in N; NaN
        where it is not known.

    Returns
    -------
    str
        A line of names with units, then the points by decreasing friction force; interpolate linearly. Cells of what is
        not known are empty.

    See Also
    --------
    controller_source
    """
    quantity = controller.quantity
    columns: dict[str, Sequence[float]] = {
        "friction_force [N]": [controller.intrinsic_friction_force - each for each in controller.force_reduction],
        f"{quantity.name} [{quantity.unit}]": controller.level,
    }
    if predicted is not None:
        columns |= {f"{name} [N]": row.tolist() for name, row in zip(PREDICTED_FORCE, predicted, strict=True)}
    rows = [",".join("" if isnan(each) else repr(each) for each in row) for row in zip(*columns.values(), strict=True)]
    return "\n".join([",".join(columns), *rows]) + "\n"


def _unit(quantity: CommandedQuantity) -> str:
    """Unit of the commanded quantity in a comment, such as "V peak to peak"."""
    return f"{quantity.unit} {quantity.qualifier}"


def _step_source(quantity: CommandedQuantity) -> str:
    """C source of the controller's step, which returns the commanded quantity."""
    source = Path(__file__).with_name("controller_step.c").read_text(encoding="utf-8").strip()
    source = source.replace("LEVEL_MAXIMUM", f"SONOLUBE_HIGHEST_{quantity.word.upper()}")
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
