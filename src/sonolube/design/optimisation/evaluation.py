"""Evaluation of drives of a rig, and the drive voltage required for a target friction ratio."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from types import MappingProxyType

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Complexes, Floats
from sonolube.design.optimisation.requirements import Limits
from sonolube.models.actuator import PreloadBolt, bolt_stresses
from sonolube.models.actuator.stack import PiezoStack
from sonolube.models.contact import separation
from sonolube.models.dynamics import Status, SteadyStates
from sonolube.rig import point_batch
from sonolube.rig.driven_rig import DrivenRig, DriveVoltage, driven_rig
from sonolube.rig.operating_conditions import steady_states_of
from sonolube.rig.power import electrical_load, larger_power
from sonolube.rig.record import Rig
from sonolube.rig.resolved_rig import resolved_rig

LIMITS: Mapping[str, str] = MappingProxyType(
    {
        "stack_voltage": "voltage the stack bears",
        "voltage": "voltage of the amplifier",
        "current": "current of the amplifier",
        "slew_rate": "slew rate of the amplifier",
        "tension": "tension in the stack",
        "contact_pressure": "stress in the contact",
        "horn_stress": "stress in the horn",
        "temperature": "warming of the actuator",
        "bolt_fatigue": "fatigue of the bolt",
        "bolt_yield": "yielding of the bolt",
    }
)
"""Printed name of each limit, by its name in `Evaluation.utilisation`."""

CONSTRAINTS = ("admissible_vibration", *LIMITS)
"""Constraints of a design; `admissible_vibration` requires a single stable vibration whose mean planes do not meet."""

_PHASES_PER_HARMONIC = 64


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class Evaluation:
    """Objectives and constraints of several drives of one rig; every array has one entry per drive.

    Parameters
    ----------
    voltage_peak_to_peak : ndarray, shape (n,)
        Peak-to-peak drive voltage. [V]
    objectives : dict of str to ndarray
        Objectives by the names of `OBJECTIVES`, in W, W and V.
    utilisation : dict of str to ndarray
        Demand over limit by the names of `CONSTRAINTS`; violated above one, zero without a limit.
    quantities : dict of str to ndarray
        Amplitude, current, tension and further results by the names of the vocabulary, in SI.
    """

    voltage_peak_to_peak: Floats
    objectives: dict[str, Floats]
    utilisation: dict[str, Floats]
    quantities: dict[str, Floats]

    @property
    def maximum_utilisation(self) -> Floats:
        """Largest utilisation of any constraint."""
        return np.asarray(np.max(np.stack(list(self.utilisation.values())), axis=0))


def evaluate(
    rig: Rig, limits: Limits, *, frequency: ArrayLike, voltage_peak_to_peak: ArrayLike, bolt: PreloadBolt | None = None
) -> Evaluation:
    r"""Objectives and constraint utilisation of several drives of a rig.

    Parameters
    ----------
    rig : Rig
        With a stack, a structure and a drive voltage.
    limits : Limits
    frequency : array_like, shape (n,)
        Drive frequencies. [Hz]
    voltage_peak_to_peak : array_like, shape (n,)
        Drive voltages; the offset is scaled in the rig's own ratio. [V]
    bolt : PreloadBolt or None
        Bolt that preloads the stack.

    Returns
    -------
    Evaluation
        With an infinite utilisation of `admissible_vibration` where there is no stable vibration, or several.

    Notes
    -----
    The power is that which the amplifier has to supply, :func:`sonolube.rig.larger_power` of both of its parts. With
    the harmonics :math:`V_k` and :math:`I_k` of voltage and current, the heat is the electrical power dissipated
    in stack, dampers and contact, and the dielectric loss of a sine:

    .. math:: P_h = \frac12 \sum_k \operatorname{Re} V_k I_k^* + \frac\pi4 f C \tan\delta\, U_{pp}^2

    The stack force follows from the current through its elongation, with :math:`s = 2 \pi i k f`:

    .. math::

        e_k &= \frac{I_k / s - C^S V_k}{N d_{33} k_p}

        F_k &= N d_{33} k_p V_k - (k_p + s c_p)\, e_k

    The tension is the greatest value of :math:`-F` over a period, its utilisation that over the preload.
    """
    rig = replace(driven_rig(rig), amplitude_source="computed")
    resolved = resolved_rig(rig)
    f, volts = np.broadcast_arrays(np.asarray(frequency, dtype=float), np.asarray(voltage_peak_to_peak, dtype=float))
    offset = rig.drive.offset_ratio * volts
    load = np.full(f.shape, rig.normal_load)
    settings = (volts, offset, f, load)
    states = steady_states_of(resolved, settings, separation(rig.contact, normal_load=load))
    stack = rig.stack
    charge = resolved.voltage.charging_power(
        capacitance=stack.free_capacitance, voltage_peak_to_peak=volts, voltage_offset=offset, frequency=f
    )
    power = larger_power(charging_power=charge, dissipated_power=states.dissipated_power)
    dielectric_loss = np.pi / 4 * f * stack.free_capacitance * limits.loss_tangent * volts**2
    heat = states.dissipated_power + dielectric_loss
    quantities = _vibration_quantities(rig, stack, states, bolt) | {
        "heat_rate": heat,
        "power_to_supply": power,
        "charging_power": charge,
        "dissipated_power": states.dissipated_power,
        "apparent_power": electrical_load(states)["apparent_power"],
        "vibration_amplitude": states.vibration_amplitude,
    }
    extremes = resolved.voltage.range(voltage_peak_to_peak=volts, voltage_offset=offset)
    utilisation = _utilisation(stack, limits, quantities, f, extremes)
    admissible = (states.status == Status.PERIODIC) & ~states.gap_closed
    utilisation["admissible_vibration"] = np.where(admissible, 0.0, np.inf)
    if bolt is not None:
        stresses = bolt_stresses(
            bolt,
            elongation_amplitude=np.nan_to_num(quantities["elongation"]),
            elongation=stack.free_stroke_per_volt * offset,
        )
        utilisation["bolt_fatigue"] = limits.fatigue_safety / stresses.fatigue_safety
        utilisation["bolt_yield"] = limits.yield_safety / stresses.yield_safety
    return Evaluation(
        voltage_peak_to_peak=volts,
        objectives={"power": power, "heat": heat, "voltage": volts},
        utilisation={name: np.nan_to_num(utilisation.get(name, np.zeros(f.shape)), nan=np.inf) for name in CONSTRAINTS},
        quantities=quantities,
    )


def _vibration_quantities(
    rig: DrivenRig, stack: PiezoStack, states: SteadyStates, bolt: PreloadBolt | None
) -> dict[str, Floats]:
    """Greatest current, slew rate, elongation and tension of the stack over a period, and pressure of the contact."""
    orders = np.arange(1, states.voltage_harmonics.shape[-1] + 1)
    s = 2j * np.pi * states.frequency[:, np.newaxis] * orders
    volts, current = states.voltage_harmonics, states.current_harmonics
    elongation = (current / s - stack.clamped_capacitance * volts) / stack.charge_per_elongation
    force = stack.charge_per_elongation * volts - (stack.stack_stiffness + s * stack.stack_damping) * elongation
    if bolt is not None:
        force = force + bolt.stiffness * elongation  # the ceramic carries what the parallel bolt does not
    return {
        "peak_current": _periodic_maximum(current),
        "slew_rate": _periodic_maximum(s * volts),
        "elongation": _periodic_maximum(elongation),
        "dynamic_tension": _periodic_maximum(-force),
        "nominal_pressure": states.highest_normal_force / rig.contact.nominal_area,
    }


def _periodic_maximum(harmonics: Complexes) -> Floats:
    """Greatest value over a period of functions given by their harmonics."""
    if harmonics.shape[-1] == 1:
        return np.abs(harmonics[..., 0])
    phases = np.linspace(0, 2 * np.pi, _PHASES_PER_HARMONIC * harmonics.shape[-1], endpoint=False)
    waves = np.exp(1j * np.multiply.outer(np.arange(1, harmonics.shape[-1] + 1), phases))
    return np.asarray((harmonics @ waves).real.max(axis=-1))


def _utilisation(
    stack: PiezoStack, limits: Limits, quantities: dict[str, Floats], f: Floats, extremes: tuple[Floats, Floats]
) -> dict[str, Floats]:
    """Utilisation of the limits that are set; temperature rise and horn stress are added to the quantities."""
    lowest, highest = extremes
    voltage = np.maximum(np.abs(lowest), np.abs(highest))
    utilisation = {"stack_voltage": np.zeros(f.shape)}
    if stack.highest_voltage is not None:
        utilisation["stack_voltage"] = highest / stack.highest_voltage
    if stack.lowest_voltage is not None:
        violation = np.where(lowest < stack.lowest_voltage, np.inf, 0.0)
        negative = lowest / stack.lowest_voltage if stack.lowest_voltage < 0 else violation
        utilisation["stack_voltage"] = np.maximum(utilisation["stack_voltage"], negative)
    if stack.preload is not None:
        utilisation["tension"] = quantities["dynamic_tension"] / max(stack.preload, 1e-300)
    for name, demand, limit in (
        ("voltage", voltage, limits.voltage_maximum),
        ("current", quantities["peak_current"], limits.current_maximum),
        ("slew_rate", quantities["slew_rate"], limits.slew_rate_maximum),
        ("contact_pressure", quantities["nominal_pressure"], limits.nominal_pressure),
    ):
        if limit is not None:
            utilisation[name] = demand / limit
    if limits.thermal_conductance is not None:
        quantities["temperature_rise"] = quantities["heat_rate"] / limits.thermal_conductance
        if limits.temperature_rise is not None:
            utilisation["temperature"] = quantities["temperature_rise"] / limits.temperature_rise
    if limits.horn is not None:
        velocity = 2 * np.pi * f * quantities["vibration_amplitude"]
        quantities["horn_stress"] = np.sqrt(limits.horn.density * limits.horn.youngs_modulus) * velocity
        utilisation["horn_stress"] = quantities["horn_stress"] / limits.horn.stress_limit
    return utilisation


DEFAULT_MAXIMUM_SWING = 200.0
"""Highest peak-to-peak voltage that is tried where neither stack nor amplifier limits it. [V]"""

_LEVELS, _SECANT_STEPS = 24, 2
_LOWEST = 2e-3  # of the highest swing, where friction is hardly reduced
_MAX_STEPS = 40
_LOG_TOLERANCE = 1e-7  # of the logarithm of the voltage
_RATIO_TOLERANCE = 1e-9  # of the friction ratio
_FIRST_BRACKET = 0.05  # in the logarithm of the voltage; doubled until the root is bracketed


def maximum_swing(rig: Rig, limits: Limits) -> float:
    """Highest peak-to-peak voltage (swing) within the limits of stack and amplifier, offset included, in V.

    Parameters
    ----------
    rig : Rig
        With a stack, a structure and a drive voltage.
    limits : Limits

    Returns
    -------
    float
    """
    rig = replace(driven_rig(rig), amplitude_source="computed")
    drive, stack = rig.drive, rig.stack
    ends = DriveVoltage(drive=drive).range(voltage_peak_to_peak=1.0, voltage_offset=drive.offset_ratio)
    low, high = (float(end) for end in ends)
    bounds = [DEFAULT_MAXIMUM_SWING] if stack.highest_voltage is None and limits.voltage_maximum is None else []
    if stack.highest_voltage is not None and high > 0:
        bounds.append(stack.highest_voltage / high)
    if stack.lowest_voltage is not None and low < 0:
        bounds.append(stack.lowest_voltage / low)
    if limits.voltage_maximum is not None:
        bounds.append(limits.voltage_maximum / max(abs(low), abs(high)))
    return max(min(bounds, default=DEFAULT_MAXIMUM_SWING), 0.0) * (1 - 1e-9)


def estimate_swings(rig: Rig, limits: Limits, *, frequency: ArrayLike, friction_ratio: float) -> Floats:
    """Lowest peak-to-peak voltage for a target friction ratio at each frequency, to about 1e-3 of the ratio.

    Parameters
    ----------
    rig : Rig
        With a stack, a structure and a drive voltage.
    limits : Limits
        Those of the amplifier bound the voltage.
    frequency : array_like, shape (n,)
        Drive frequencies. [Hz]
    friction_ratio : float
        Target of friction with vibration over friction without. []

    Returns
    -------
    ndarray, shape (n,)
        In V; NaN where no voltage within the limits gives the ratio.

    See Also
    --------
    refine_swing

    Notes
    -----
    The friction ratio at 24 voltages in geometric sequence brackets the first crossing; two steps of false position
    over the logarithm of the voltage follow.
    """
    rig = replace(driven_rig(rig), amplitude_source="computed")
    f = np.atleast_1d(np.asarray(frequency, dtype=float))
    highest = maximum_swing(rig, limits)
    if highest <= 0:
        return np.full(f.shape, np.nan)
    levels = np.log(np.geomspace(_LOWEST * highest, highest, _LEVELS))
    ratios = _friction_ratios(rig, f[:, np.newaxis], np.exp(levels))
    reached = ratios <= friction_ratio
    first = np.argmax(reached, axis=1)
    swings = np.full(f.shape, np.nan)
    rows = np.flatnonzero(reached.any(axis=1) & np.isfinite(ratios[:, 0]))
    upper = np.maximum(first[rows], 1)
    low, high = levels[upper - 1], levels[upper]
    above, below = ratios[rows, upper - 1] - friction_ratio, ratios[rows, upper] - friction_ratio
    estimate = low
    for step in range(_SECANT_STEPS + 1):
        with np.errstate(invalid="ignore", divide="ignore"):
            fraction = np.clip(above / (above - below), 0, 1)
        estimate = low + np.where(np.isfinite(fraction), fraction, 1.0) * (high - low)
        if step == _SECANT_STEPS or not rows.size:
            break
        residual = _friction_ratios(rig, f[rows], np.exp(estimate)) - friction_ratio
        positive = residual > 0
        low, above = np.where(positive, estimate, low), np.where(positive, residual, above)
        high, below = np.where(positive, high, estimate), np.where(positive, below, residual)
    swings[rows] = np.exp(estimate)
    return swings


def refine_swing(rig: Rig, *, frequency: float, friction_ratio: float, near: float, highest: float) -> float:
    """Peak-to-peak voltage at which a target friction ratio is reached, to a relative tolerance of 1e-7, in V.

    Parameters
    ----------
    rig : Rig
        With a stack, a structure and a drive voltage.
    frequency : float
        Drive frequency. [Hz]
    friction_ratio : float
        Target of friction with vibration over friction without. []
    near : float
        Initial estimate, in V.
    highest : float
        Highest voltage to try, in V.

    Returns
    -------
    float
        NaN where the target is out of reach.

    See Also
    --------
    estimate_swings

    Notes
    -----
    The root is bracketed by steps from the initial estimate that double, then found by the Illinois variant of false
    position over the logarithm of the voltage.
    """
    rig = replace(driven_rig(rig), amplitude_source="computed")

    def residual(log_swing: float) -> float:
        ratio = _friction_ratios(rig, np.array([frequency]), np.array([np.exp(log_swing)]))
        return float(ratio[0]) - friction_ratio

    low, high = np.log(near), np.log(near)
    above = below = residual(low)
    step, bottom, top = _FIRST_BRACKET, np.log(_LOWEST * highest), np.log(highest)
    while not above > 0 and low > bottom:
        low, step = max(low - step, bottom), 2 * step
        above = residual(low)
    step = _FIRST_BRACKET
    while not below <= 0 and high < top:
        high, step = min(high + step, top), 2 * step
        below = residual(high)
    if not (above > 0 >= below):
        return float("nan")
    return float(np.exp(_illinois_root(residual, low, high, above, below)))


def _illinois_root(residual: Callable[[float], float], low: float, high: float, above: float, below: float) -> float:
    """Root of a falling function in a bracket by the Illinois variant of false position."""
    last = 0
    for _ in range(_MAX_STEPS):
        if high - low < _LOG_TOLERANCE:
            break
        estimate = low + (high - low) * np.clip(above / (above - below), 1e-3, 1 - 1e-3)
        value = residual(estimate)
        if value > 0:
            low, above = estimate, value
            below = below / 2 if last == 1 else below
            last = 1
        else:
            high, below = estimate, value
            above = above / 2 if last == -1 else above
            last = -1
        if abs(value) < _RATIO_TOLERANCE:
            return float(estimate)
    return high


def _friction_ratios(rig: DrivenRig, frequency: Floats, swing: Floats) -> Floats:
    """Friction ratio of a rig by its model's formula at the broadcast frequencies and peak-to-peak voltages."""
    f, volts = np.broadcast_arrays(frequency, swing)
    points = point_batch(rig, frequency=f, voltage_peak_to_peak=volts, voltage_offset=rig.drive.offset_ratio * volts)
    return np.asarray(points.numbers["raw_friction_ratio"].reshape(f.shape))
