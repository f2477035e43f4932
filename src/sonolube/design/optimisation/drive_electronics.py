"""Drive electronics of a design: amplifier requirements, and matching networks that compensate the reactive power."""

from dataclasses import dataclass

import numpy as np

from sonolube.checks import Complexes, Floats
from sonolube.design.optimisation.gradient_search import DesignPoint, rig_at_design_point
from sonolube.design.optimisation.screening import DesignProblem
from sonolube.design.optimisation.space import candidate_rig
from sonolube.errors import InvalidInput
from sonolube.models.actuator import (
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
from sonolube.models.dynamics import electrical_admittance
from sonolube.rig import steady_states, structure_in_contact
from sonolube.rig.driven_rig import DrivenRig

CAPACITANCE_TOLERANCE = 0.2
"""Relative tolerance of the capacitance that data sheets state. []"""

_MIN_HARMONIC = 1e-9  # of the largest, below which a voltage harmonic counts as absent


@dataclass(frozen=True, kw_only=True, slots=True)
class MatchedNetwork:
    """Matching network of a design and its performance.

    Parameters
    ----------
    name : str
        "parallel inductor", "series inductor" or "L network".
    network : MatchingNetwork
    band : pair of float
        Frequencies between which the power factor exceeds 0.9, in Hz.
    detuned_power_factor : float
        Lower of the power factors at the drive frequency with the capacitance at either end of its tolerance.
    voltage_gain : float
        Voltage of the actuator over that of the amplifier at the drive frequency. []
    """

    name: str
    network: MatchingNetwork
    band: tuple[float, float]
    detuned_power_factor: float
    voltage_gain: float


@dataclass(frozen=True, kw_only=True, slots=True)
class DriveElectronics:
    """Amplifier and matching networks of a design.

    Parameters
    ----------
    amplifier : AmplifierRequirements
        Required of an amplifier without a network.
    networks : tuple of MatchedNetwork
        Networks that compensate the reactive power; empty where the vibration makes the actuator inductive.
    """

    amplifier: AmplifierRequirements
    networks: tuple[MatchedNetwork, ...]


def design_rig(problem: DesignProblem, point: DesignPoint) -> DrivenRig:
    """Rig of a design point, with its drive; its amplitude is the computed one.

    Parameters
    ----------
    problem : DesignProblem
    point : DesignPoint

    Returns
    -------
    DrivenRig
    """
    return rig_at_design_point(candidate_rig(problem.space, point.candidate), point)


def stack_admittance(rig: DrivenRig, *, frequency: Floats, capacitance_change: float = 0.0) -> Complexes:
    """Small-signal electrical admittance of a rig's stack, the contact replaced by a spring. [S]

    Parameters
    ----------
    rig : DrivenRig
    frequency : ndarray, any shape
        Frequency of the voltage. [Hz]
    capacitance_change : float
        Relative change of the free capacitance.

    Returns
    -------
    ndarray of complex, shape of `frequency`
    """
    nominal = electrical_admittance(structure_in_contact(rig), frequency=frequency)
    return nominal + 2j * np.pi * frequency * capacitance_change * rig.stack.free_capacitance


def required_electronics(
    problem: DesignProblem, point: DesignPoint, *, source_resistance: float | None = None
) -> DriveElectronics:
    """Amplifier requirements and matching networks of a design point.

    Parameters
    ----------
    problem : DesignProblem
    point : DesignPoint
    source_resistance : float or None
        Input resistance of an L network, the optimum load of the amplifier; None for no L network. [ohm]

    Returns
    -------
    DriveElectronics

    Raises
    ------
    InvalidInput
        If an L network is requested for an actuator that takes no real power.

    Notes
    -----
    The amplifier requirements are those of the nonlinear steady vibration with all harmonics. Networks match the
    small-signal admittance of the actuator, its motional branch included.
    """
    rig = design_rig(problem, point)
    states = steady_states(rig)
    volts, current = states.voltage_harmonics[0], states.current_harmonics[0]
    present = np.abs(volts) > _MIN_HARMONIC * np.abs(volts).max()
    y = np.divide(current, volts, out=np.zeros_like(current), where=present)
    amplifier = amplifier_requirements(
        admittance=y,
        voltage_amplitude=np.where(present, volts, 0),
        frequency=point.frequency,
        voltage_offset=rig.drive.voltage_offset,
    )
    load = complex(stack_admittance(rig, frequency=np.array([point.frequency]))[0])
    networks: list[tuple[str, MatchingNetwork]] = []
    if load.imag > 0:
        networks.append(("parallel inductor", parallel_inductor(admittance=load, frequency=point.frequency)))
        networks.append(("series inductor", series_inductor(admittance=load, frequency=point.frequency)))
    if source_resistance is not None:
        if load.real <= 0:
            raise InvalidInput(
                f"source_resistance: the conductance of the actuator is {load.real:.3g} S, and only a positive one can"
                " be matched to a resistance; leave it out"
            )
        network = l_match(admittance=load, frequency=point.frequency, source_resistance=source_resistance)
        networks.append(("L network", network))
    return DriveElectronics(
        amplifier=amplifier, networks=tuple(_matched_network(rig, point.frequency, *named) for named in networks)
    )


def _matched_network(rig: DrivenRig, frequency: float, name: str, network: MatchingNetwork) -> MatchedNetwork:
    """Network with its band, its power factor over the tolerance of the capacitance, and its voltage gain."""
    f = np.array([frequency])

    def power_factor(capacitance_change: float) -> float:
        y = stack_admittance(rig, frequency=f, capacitance_change=capacitance_change)
        return float(matched_power_factor(network, admittance=y, frequency=f)[0])

    gain = voltage_gain(network, admittance=stack_admittance(rig, frequency=f), frequency=f)
    return MatchedNetwork(
        name=name,
        network=network,
        band=matched_band(network, lambda at: stack_admittance(rig, frequency=at), frequency=frequency),
        detuned_power_factor=min(power_factor(-CAPACITANCE_TOLERANCE), power_factor(CAPACITANCE_TOLERANCE)),
        voltage_gain=float(np.abs(gain)[0]),
    )
