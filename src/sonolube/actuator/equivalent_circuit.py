"""Butterworth-Van Dyke circuits: a vibrating actuator as its amplifier sees it."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Complexes, Floats, require_non_negative, require_positive


@dataclass(frozen=True, kw_only=True, slots=True)
class MotionalBranch:
    """One mode of vibration: resistance, inductance and capacitance in series.

    Parameters
    ----------
    resistance : float
        Damping of the mode, seen electrically. [ohm]
    inductance : float
        Mass of the mode, seen electrically. [H]
    capacitance : float
        Compliance of the mode, seen electrically. [F]

    Raises
    ------
    InvalidInput
        If an inductance or capacitance is not positive, or a resistance negative.
    """

    resistance: float
    inductance: float
    capacitance: float

    def __post_init__(self) -> None:
        require_non_negative(resistance=self.resistance)
        require_positive(inductance=self.inductance, capacitance=self.capacitance)


@dataclass(frozen=True, kw_only=True, slots=True)
class ButterworthVanDyke:
    """A capacitance with one branch beside it for each mode, behind the resistance of the leads.

    Parameters
    ----------
    parallel_capacitance : float
        Capacitance with all modes held still. [F]
    branches : tuple of Branch
        The modes; their order does not matter.
    series_resistance : float
        Resistance of leads and electrodes. [ohm]

    Raises
    ------
    InvalidInput
        If the capacitance is not positive, or the resistance negative.

    References
    ----------
    .. [1] K. S. Van Dyke, Proc. IRE 16, 742 (1928). doi:10.1109/JRPROC.1928.221466
    """

    parallel_capacitance: float
    branches: tuple[MotionalBranch, ...]
    series_resistance: float = 0.0

    def __post_init__(self) -> None:
        require_positive(parallel_capacitance=self.parallel_capacitance)
        require_non_negative(series_resistance=self.series_resistance)


@dataclass(frozen=True, kw_only=True, slots=True)
class CircuitResonances:
    """The modes of a circuit without losses, in order of frequency.

    Parameters
    ----------
    series_frequency : ndarray, shape (n,)
        Where the admittance peaks: the mode short-circuited. [Hz]
    parallel_frequency : ndarray, shape (n,)
        Where the impedance peaks next: the mode open-circuited. [Hz]
    mechanical_quality_factor : ndarray, shape (n,)
        Quality factor of the branch; infinite without resistance. []
    coupling_factor : ndarray, shape (n,)
        Effective coupling factor, sqrt(1 - (f_s/f_p)^2). []
    """

    series_frequency: Floats
    parallel_frequency: Floats
    mechanical_quality_factor: Floats
    coupling_factor: Floats


def circuit_admittance(circuit: ButterworthVanDyke, *, frequency: ArrayLike) -> Complexes:
    """Return current per voltage, complex. [S]

    Parameters
    ----------
    circuit : ButterworthVanDyke
    frequency : array_like, any shape
        Frequency of the voltage. [Hz]

    Returns
    -------
    ndarray, shape of `frequency`

    Raises
    ------
    InvalidInput
        If a frequency is not positive.
    """
    s = 2j * np.pi * require_positive(frequency=frequency)
    y = s * circuit.parallel_capacitance
    for branch in circuit.branches:
        y = y + s * branch.capacitance / (1 + s * branch.capacitance * (branch.resistance + s * branch.inductance))
    return np.asarray(y / (1 + circuit.series_resistance * y))


def circuit_resonances(circuit: ButterworthVanDyke) -> CircuitResonances:
    """Return the frequencies, quality factors and coupling factors of the circuit's modes.

    Parameters
    ----------
    circuit : ButterworthVanDyke

    Returns
    -------
    Resonances

    Notes
    -----
    Frequencies are those without losses. Between each series resonance and the next lies one parallel one, to which
    every branch and the parallel capacitance contribute: together they are the roots of
    C_0 + sum C_i/(1 - (f/f_i)^2), found as eigenvalues of diag(omega_i^2) + v v^T/C_0 with v_i^2 = 1/L_i.
    """
    modes = sorted(circuit.branches, key=lambda branch: -branch.inductance * branch.capacitance)
    inductance = np.array([branch.inductance for branch in modes])
    squares = 1 / (inductance * np.array([branch.capacitance for branch in modes]))
    v = 1 / np.sqrt(inductance * circuit.parallel_capacitance)
    opened = np.linalg.eigvalsh(np.diag(squares) + np.multiply.outer(v, v)) if modes else squares
    return CircuitResonances(
        series_frequency=np.sqrt(squares) / (2 * np.pi),
        parallel_frequency=np.sqrt(opened) / (2 * np.pi),
        mechanical_quality_factor=np.array([_quality(branch) for branch in modes]),
        coupling_factor=np.sqrt(np.maximum(1 - squares / opened, 0.0)),
    )


def _quality(branch: MotionalBranch) -> float:
    lossless = branch.resistance == 0
    return math.inf if lossless else math.sqrt(branch.inductance / branch.capacitance) / branch.resistance
