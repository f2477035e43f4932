"""The controller: what it knows, and what it does once an interval. The exported C does the same, line by line."""

from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass

from sonolube.checks import require_positive
from sonolube.design.control.friction_map import FrictionMap, linear_map
from sonolube.design.control.process import PIGains, Process, simc_gains


@dataclass(frozen=True, kw_only=True, slots=True)
class FrictionController:
    """A PI controller of friction through the inverse of a friction map, with feed-forward and anti-windup.

    It commands a friction force; the map turns that into a voltage. Feedback acts on what the measurement differs
    from that expected of the command fed forward, so that the delay is not taken for an error.

    Parameters
    ----------
    process : Process
        Lag, delay and interval it is made for.
    gains : PIGains
    intrinsic_friction_force : float
        Friction without vibration. [N]
    saved_force : tuple of float
        How far below it friction is to be, rising from zero, in N: the entries of its table.
    voltage_peak_to_peak : tuple of float
        Swing for each, rising from zero. [V]
    voltage_maximum : float
        Largest swing it asks for. [V]
    feed_forward : bool
        Whether the reference is commanded at once; otherwise the integral alone finds it, from no vibration.
    """

    process: Process
    gains: PIGains
    intrinsic_friction_force: float
    saved_force: tuple[float, ...]
    voltage_peak_to_peak: tuple[float, ...]
    voltage_maximum: float
    feed_forward: bool = True

    @property
    def integral_fraction(self) -> float:
        """Share of the error that the integral takes up in an interval."""
        return self.gains.proportional_gain * self.process.sample_interval / self.gains.integral_time

    @property
    def windup_fraction(self) -> float:
        """Share of what a limit cut off that the integral gives up in an interval."""
        return min(self.process.sample_interval / self.gains.integral_time, 1.0)

    @property
    def lag_fraction(self) -> float:
        """Share of the way to the command that the expected friction goes in an interval."""
        return 1 - self.process.decay


@dataclass(slots=True)
class ControllerState:
    """What a controller remembers between intervals; forces in N.

    Parameters
    ----------
    integral : float
        Integral part of the command.
    expected : list of float
        Friction expected of the command fed forward, newest last, as many as the delay and one.
    """

    integral: float
    expected: list[float]


def designed_controller(
    known: FrictionMap,
    process: Process,
    *,
    voltage_maximum: float,
    closed_loop_time: float | None = None,
    feed_forward: bool = True,
) -> FrictionController:
    """Return the controller that Skogestad's rule gives for a map and a process.

    Parameters
    ----------
    known : FrictionMap
        What it is to look its voltages up in; of which only the ends are used without feed-forward.
    process : Process
    voltage_maximum : float
        Largest swing it may ask for. [V]
    closed_loop_time : float, optional
        Time constant wanted of the closed loop; the effective delay where absent. [s]
    feed_forward : bool
        Whether the reference is commanded at once.

    Returns
    -------
    FrictionController
    """
    table = known if feed_forward else linear_map(known)
    return FrictionController(
        process=process,
        gains=simc_gains(process, closed_loop_time=closed_loop_time),
        intrinsic_friction_force=table.highest_force,
        saved_force=tuple((table.highest_force - table.friction_force).tolist()),
        voltage_peak_to_peak=tuple(table.voltage_peak_to_peak.tolist()),
        voltage_maximum=float(require_positive(voltage_maximum=voltage_maximum)),
        feed_forward=feed_forward,
    )


def at_rest(controller: FrictionController) -> ControllerState:
    """Return the state of a controller before its first interval, friction unreduced."""
    expected = [controller.intrinsic_friction_force] * (controller.process.delayed_samples + 1)
    return ControllerState(integral=0.0, expected=expected)


def next_voltage(controller: FrictionController, state: ControllerState, reference: float, measured: float) -> float:
    """Return the swing to drive with over the next interval, in V, and update the state.

    Parameters
    ----------
    controller : FrictionController
    state : ControllerState
    reference : float
        Friction wanted, in N.
    measured : float
        Friction as measured, in N.
    """
    unreduced = controller.intrinsic_friction_force
    base = reference if controller.feed_forward else unreduced
    error = (state.expected[0] if controller.feed_forward else reference) - measured
    command = base + controller.gains.proportional_gain * error + state.integral
    wanted = _interpolated(unreduced - command, controller.saved_force, controller.voltage_peak_to_peak)
    voltage = min(wanted, controller.voltage_maximum)
    given = unreduced - _interpolated(voltage, controller.voltage_peak_to_peak, controller.saved_force)
    state.integral += controller.integral_fraction * error + controller.windup_fraction * (given - command)
    newest = state.expected[-1]
    state.expected.append(newest + controller.lag_fraction * (reference - newest))
    del state.expected[0]
    return voltage


def _interpolated(x: float, known: Sequence[float], of: Sequence[float]) -> float:
    """Return the polygon through the points (known, of) at x, its ends beyond them."""
    if x <= known[0]:
        return of[0]
    if x >= known[-1]:
        return of[-1]
    i = bisect_right(known, x) - 1
    return of[i] + (of[i + 1] - of[i]) / (known[i + 1] - known[i]) * (x - known[i])
