"""The amplifier that a design needs, and the inductors that spare it the reactive part."""

from dataclasses import dataclass, replace

import numpy as np

from sonolube.actuator import (
    AmplifierRequirements,
    MatchingNetwork,
    amplifier_requirements,
    l_match,
    matched_band,
    matched_power_factor,
    parallel_inductor,
    series_inductor,
    voltage_gain,
)
from sonolube.checks import Complexes, Floats
from sonolube.design.optimisation.local_search import Point, driven
from sonolube.design.optimisation.screening import Task
from sonolube.design.optimisation.space import rig_of
from sonolube.dynamics import electrical_admittance
from sonolube.errors import InvalidInput
from sonolube.rig import steady_states, structure_in_contact
from sonolube.rig.driven_rig import DrivenRig

CAPACITANCE_TOLERANCE = 0.2
"""Relative tolerance of the capacitance that data sheets state."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Matched:
    """A network for a design.

    Parameters
    ----------
    name : str
        "parallel inductor", "series inductor" or "L network".
    network : MatchingNetwork
    band : pair of float
        Frequencies between which the power factor stays above 0.9, in Hz.
    off_capacitance : float
        Power factor at the drive's frequency, the capacitance off by its tolerance: the worse of both sides.
    gain : float
        Voltage of the actuator over that of the amplifier at the drive's frequency.
    """

    name: str
    network: MatchingNetwork
    band: tuple[float, float]
    off_capacitance: float
    gain: float


@dataclass(frozen=True, kw_only=True, slots=True)
class Electrical:
    """What a design asks of its electronics.

    Parameters
    ----------
    need : AmplifierRequirements
        Without a network.
    matched : tuple of Matched
        Networks that draw no reactive power; empty where the motion makes the actuator inductive.
    """

    need: AmplifierRequirements
    matched: tuple[Matched, ...]


def design_rig(task: Task, point: Point) -> DrivenRig:
    """Return the rig that a design is, driven as it says.

    Parameters
    ----------
    task : Task
    point : Point

    Returns
    -------
    DrivenRig
    """
    amplitude = float(point.assessment.numbers["vibration_amplitude"][0])
    return replace(driven(rig_of(task.space, point.choice), point), vibration_amplitude=amplitude)


def admittance_of(rig: DrivenRig, *, frequency: Floats, capacitance_change: float = 0.0) -> Complexes:
    """Return current per voltage of a rig's stack under small voltages, the contact a spring. [S]

    Parameters
    ----------
    rig : DrivenRig
    frequency : ndarray
        Frequency of the voltage. [Hz]
    capacitance_change : float
        By what share of itself the free capacitance is off.

    Returns
    -------
    ndarray of complex, shape of `frequency`
    """
    own = electrical_admittance(structure_in_contact(rig), frequency=frequency)
    return own + 2j * np.pi * frequency * capacitance_change * rig.stack.free_capacitance


def electrical(task: Task, point: Point, *, source_resistance: float | None = None) -> Electrical:
    """Return the amplifier and the networks for a design.

    Parameters
    ----------
    task : Task
    point : Point
    source_resistance : float or None
        Input resistance of the matched network, for a network of two elements. [ohm]

    Returns
    -------
    Electrical

    Notes
    -----
    The amplifier's need is that of the vibration as it is; networks match the actuator's admittance under small
    voltages, the branch of the motion included.
    """
    rig = design_rig(task, point)
    states = steady_states(rig)
    volts, current = states.voltage_harmonics[0], states.current_harmonics[0]
    there = np.abs(volts) > 1e-9 * np.abs(volts).max()
    y = np.divide(current, volts, out=np.zeros_like(current), where=there)
    need = amplifier_requirements(
        admittance=y,
        voltage_amplitude=np.where(there, volts, 0),
        frequency=point.frequency,
        voltage_offset=rig.drive.voltage_offset,
    )
    at = complex(admittance_of(rig, frequency=np.array([point.frequency]))[0])
    networks: list[tuple[str, MatchingNetwork]] = []
    if at.imag > 0:
        networks.append(("parallel inductor", parallel_inductor(admittance=at, frequency=point.frequency)))
        networks.append(("series inductor", series_inductor(admittance=at, frequency=point.frequency)))
    if source_resistance is not None:
        if at.real <= 0:
            raise InvalidInput("source_resistance: the actuator takes no power, and cannot be matched to a resistance")
        network = l_match(admittance=at, frequency=point.frequency, source_resistance=source_resistance)
        networks.append(("L network", network))
    return Electrical(need=need, matched=tuple(_matched(rig, point.frequency, *named) for named in networks))


def _matched(rig: DrivenRig, frequency: float, name: str, network: MatchingNetwork) -> Matched:
    f = np.array([frequency])
    off = [
        float(
            matched_power_factor(
                network, admittance=admittance_of(rig, frequency=f, capacitance_change=share), frequency=f
            )[0]
        )
        for share in (-CAPACITANCE_TOLERANCE, CAPACITANCE_TOLERANCE)
    ]
    return Matched(
        name=name,
        network=network,
        band=matched_band(network, lambda at: admittance_of(rig, frequency=at), frequency=frequency),
        off_capacitance=min(off),
        gain=float(np.abs(voltage_gain(network, admittance=admittance_of(rig, frequency=f), frequency=f))[0]),
    )
