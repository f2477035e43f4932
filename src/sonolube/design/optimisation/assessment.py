"""What drives ask of a rig: amplifier power, heat, and the share of each limit that they use up."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from sonolube.actuator import PreloadBolt, bolt_stresses
from sonolube.actuator.stack import PiezoStack
from sonolube.checks import Complexes, Floats
from sonolube.contact import separation
from sonolube.design.optimisation.requirements import Limits
from sonolube.dynamics import Status, SteadyStates
from sonolube.rig.driven_rig import DrivenRig, driven_rig
from sonolube.rig.excitation import amplifier_power, voltage_range
from sonolube.rig.operating_point_grid import OperatingConditions, steady_states_of
from sonolube.rig.record import Rig

CONSTRAINTS = (
    "sound",
    "stack_voltage",
    "voltage",
    "current",
    "slew_rate",
    "tension",
    "contact_pressure",
    "horn_stress",
    "temperature",
    "bolt_fatigue",
    "bolt_yield",
)
"""What may rule a design out; `sound` asks for one stable vibration whose mean planes do not meet."""

_PHASES = 64


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class Assessment:
    """Drives of one rig, each array of one axis.

    Parameters
    ----------
    voltage_peak_to_peak : ndarray
        Swing of the drive. [V]
    objectives : dict of str to ndarray
        What may be made least, by its name in `OBJECTIVES`, in W, W and V.
    usage : dict of str to ndarray
        Share of each limit used, by its name in `CONSTRAINTS`; above one it is broken. Those not asked for are nought.
    numbers : dict of str to ndarray
        Amplitude, current, pull and what else was found, by the words of the vocabulary.
    """

    voltage_peak_to_peak: Floats
    objectives: dict[str, Floats]
    usage: dict[str, Floats]
    numbers: dict[str, Floats]

    @property
    def most_used(self) -> Floats:
        """Largest share of any limit."""
        return np.asarray(np.max(np.stack(list(self.usage.values())), axis=0))


def assess(
    rig: Rig,
    limits: Limits,
    *,
    frequency: ArrayLike,
    voltage_peak_to_peak: ArrayLike,
    bolt: PreloadBolt | None = None,
) -> Assessment:
    """Return what drives ask of a rig.

    Parameters
    ----------
    rig : Rig
        With a stack, a structure and a drive voltage.
    limits : Limits
    frequency : array_like, shape (n,)
        Frequency of each drive. [Hz]
    voltage_peak_to_peak : array_like, shape (n,)
        Swing of each; the offset goes with it in the rig's own proportion. [V]
    bolt : PreloadBolt or None
        What presses the stack together.

    Returns
    -------
    Assessment
        With infinite usage of `sound` where no stable vibration was found.

    Notes
    -----
    Heat is the electrical power that stays in stack, dampers and contact, and the dielectric loss
    pi/4 f C tan(delta) U_pp^2 of a sine.
    """
    rig = driven_rig(rig)
    f, volts = np.broadcast_arrays(np.asarray(frequency, dtype=float), np.asarray(voltage_peak_to_peak, dtype=float))
    offset = rig.drive.offset_ratio * volts
    load = np.full(f.shape, rig.normal_load)
    settings = OperatingConditions(voltage_peak_to_peak=volts, voltage_offset=offset, frequency=f, normal_load=load)
    states = steady_states_of(rig, settings, separation(rig.contact, normal_load=load))
    stack, drive = rig.stack, rig.drive
    power = amplifier_power(
        drive, capacitance=stack.free_capacitance, voltage_peak_to_peak=volts, voltage_offset=offset, frequency=f
    )
    dielectric = np.pi / 4 * f * stack.free_capacitance * limits.loss_tangent * volts**2
    heat = states.dissipated_power + dielectric
    numbers = _numbers(rig, stack, states, bolt) | {"heat_rate": heat}
    numbers |= {"actuator_power": power, "dissipated_power": states.dissipated_power}
    numbers["vibration_amplitude"] = states.vibration_amplitude
    lowest, highest = voltage_range(drive, voltage_peak_to_peak=volts, voltage_offset=offset)
    usage = _usage(rig, stack, limits, numbers, f, (lowest, highest))
    sound = (states.status == Status.PERIODIC) & ~states.gap_closed
    usage["sound"] = np.where(sound, 0.0, np.inf)
    if bolt is not None:
        turned = bolt_stresses(
            bolt,
            elongation_amplitude=np.nan_to_num(numbers["elongation"]),
            elongation=stack.free_stroke_per_volt * offset,
        )
        usage["bolt_fatigue"] = limits.fatigue_safety / turned.fatigue_safety
        usage["bolt_yield"] = limits.yield_safety / turned.yield_safety
    return Assessment(
        voltage_peak_to_peak=volts,
        objectives={"power": power, "heat": heat, "voltage": volts},
        usage={name: np.nan_to_num(usage.get(name, np.zeros(f.shape)), nan=np.inf) for name in CONSTRAINTS},
        numbers=numbers,
    )


def _numbers(rig: DrivenRig, stack: PiezoStack, states: SteadyStates, bolt: PreloadBolt | None) -> dict[str, Floats]:
    """Return what the stack does over a period: current, slope of the voltage, elongation, pull."""
    orders = np.arange(1, states.voltage_harmonics.shape[-1] + 1)
    s = 2j * np.pi * states.frequency[:, np.newaxis] * orders
    volts, current = states.voltage_harmonics, states.current_harmonics
    elongation = (current / s - stack.clamped_capacitance * volts) / stack.charge_per_elongation
    force = stack.charge_per_elongation * volts - (stack.stack_stiffness + s * stack.stack_damping) * elongation
    if bolt is not None:
        force = force + bolt.stiffness * elongation  # what the bolt takes is not the ceramic's
    return {
        "peak_current": _highest(current),
        "slew_rate": _highest(s * volts),
        "elongation": _highest(elongation),
        "pull": _highest(-force),
        "nominal_pressure": states.highest_normal_force / rig.contact.nominal_area,
    }


def _highest(harmonics: Complexes) -> Floats:
    """Return the highest value of periodic functions."""
    if harmonics.shape[-1] == 1:
        return np.abs(harmonics[..., 0])
    phases = np.linspace(0, 2 * np.pi, _PHASES * harmonics.shape[-1], endpoint=False)
    waves = np.exp(1j * np.multiply.outer(np.arange(1, harmonics.shape[-1] + 1), phases))
    return np.asarray((harmonics @ waves).real.max(axis=-1))


def _usage(
    rig: DrivenRig,
    stack: PiezoStack,
    limits: Limits,
    numbers: dict[str, Floats],
    f: Floats,
    ends: tuple[Floats, Floats],
) -> dict[str, Floats]:
    lowest, highest = ends
    voltage = np.maximum(np.abs(lowest), np.abs(highest))
    usage = {"stack_voltage": np.zeros(f.shape)}
    if stack.highest_voltage is not None:
        usage["stack_voltage"] = highest / stack.highest_voltage
    if stack.lowest_voltage is not None:
        beyond = np.where(lowest < stack.lowest_voltage, np.inf, 0.0)
        below = lowest / stack.lowest_voltage if stack.lowest_voltage < 0 else beyond
        usage["stack_voltage"] = np.maximum(usage["stack_voltage"], below)
    if stack.preload is not None:
        usage["tension"] = numbers["pull"] / max(stack.preload, 1e-300)
    for name, used, most in (
        ("voltage", voltage, limits.voltage_maximum),
        ("current", numbers["peak_current"], limits.current_maximum),
        ("slew_rate", numbers["slew_rate"], limits.slew_rate_maximum),
        ("contact_pressure", numbers["nominal_pressure"], limits.nominal_pressure),
    ):
        if most is not None:
            usage[name] = used / most
    if limits.thermal_conductance is not None:
        numbers["temperature_rise"] = numbers["heat_rate"] / limits.thermal_conductance
        if limits.temperature_rise is not None:
            usage["temperature"] = numbers["temperature_rise"] / limits.temperature_rise
    if limits.horn is not None:
        velocity = 2 * np.pi * f * numbers["vibration_amplitude"]
        numbers["horn_stress"] = np.sqrt(limits.horn.density * limits.horn.youngs_modulus) * velocity
        usage["horn_stress"] = numbers["horn_stress"] / limits.horn.stress_limit
    return usage
