"""Butterworth-Van Dyke equivalent circuit of a vibrating actuator: admittance and resonances."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Complexes, Floats, require_non_negative, require_positive


@dataclass(frozen=True, kw_only=True, slots=True)
class MotionalBranch:
    """Motional branch of one mode: resistance, inductance and capacitance in series.

    Parameters
    ----------
    resistance : float
        Motional resistance, equivalent to the damping of the mode. [ohm]
    inductance : float
        Motional inductance, equivalent to the modal mass. [H]
    capacitance : float
        Motional capacitance, equivalent to the modal compliance. [F]

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
    """Butterworth-Van Dyke circuit: capacitance, motional branches in parallel with it, and leads in series.

    Parameters
    ----------
    parallel_capacitance : float
        Capacitance with all modes blocked. [F]
    branches : tuple of MotionalBranch
        Motional branches, in any order.
    series_resistance : float
        Resistance of leads and electrodes in series with the rest. [ohm]
    series_inductance : float
        Inductance of the leads in series with the rest. [H]
    loss_tangent : float
        Dielectric loss of the parallel capacitance, the same at all frequencies. []

    Raises
    ------
    InvalidInput
        If the capacitance is not positive, or the resistance, the inductance or the loss tangent negative.

    References
    ----------
    .. [1] K. S. Van Dyke, Proc. IRE 16, 742 (1928). doi:10.1109/JRPROC.1928.221466
    """

    parallel_capacitance: float
    branches: tuple[MotionalBranch, ...]
    series_resistance: float = 0.0
    series_inductance: float = 0.0
    loss_tangent: float = 0.0

    def __post_init__(self) -> None:
        require_positive(parallel_capacitance=self.parallel_capacitance)
        require_non_negative(
            series_resistance=self.series_resistance,
            series_inductance=self.series_inductance,
            loss_tangent=self.loss_tangent,
        )


@dataclass(frozen=True, kw_only=True, slots=True)
class CircuitResonances:
    """Resonances of a circuit without losses and leads, in order of frequency.

    Parameters
    ----------
    series_frequency : ndarray, shape (n,)
        Frequency of the admittance peak: short-circuit natural frequency. [Hz]
    parallel_frequency : ndarray, shape (n,)
        Frequency of the next impedance peak of the whole circuit: open-circuit natural frequency. [Hz]
    mechanical_quality_factor : ndarray, shape (n,)
        Quality factor of the motional branch; infinite without resistance. []
    coupling_factor : ndarray, shape (n,)
        Coupling factor of each branch by itself, sqrt(C_i/(C_0 + C_i)). []
    effective_coupling_factor : ndarray, shape (n,)
        Effective coupling factor by the resonances of the whole circuit, sqrt(1 - (f_s/f_p)^2); that of the branch
        where it is the only one. []
    """

    series_frequency: Floats
    parallel_frequency: Floats
    mechanical_quality_factor: Floats
    coupling_factor: Floats
    effective_coupling_factor: Floats


def circuit_admittance(circuit: ButterworthVanDyke, *, frequency: ArrayLike) -> Complexes:
    r"""Complex admittance of a Butterworth-Van Dyke circuit. [S]

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

    Notes
    -----
    With :math:`s = i\omega`, the parallel capacitance :math:`C_0` of loss tangent :math:`\tan\delta`, and the
    resistance :math:`R_s` and inductance :math:`L_s` of the leads

    .. math::

        Y_0 = s C_0 (1 - i \tan\delta) + \sum_i \frac{s C_i}{1 + s C_i (R_i + s L_i)}, \qquad
        Y = \frac{Y_0}{1 + (R_s + s L_s) Y_0}
    """
    s = 2j * np.pi * require_positive(frequency=frequency)
    y = s * circuit.parallel_capacitance * (1 - 1j * circuit.loss_tangent)
    for branch in circuit.branches:
        y = y + s * branch.capacitance / (1 + s * branch.capacitance * (branch.resistance + s * branch.inductance))
    return np.asarray(y / (1 + (circuit.series_resistance + s * circuit.series_inductance) * y))


def circuit_resonances(circuit: ButterworthVanDyke) -> CircuitResonances:
    r"""Series and parallel resonances, quality factors and coupling factors of a circuit.

    Parameters
    ----------
    circuit : ButterworthVanDyke

    Returns
    -------
    CircuitResonances

    Notes
    -----
    Without losses and leads. One parallel resonance lies between each series resonance and the next; all of them are
    the roots of

    .. math:: C_0 + \sum_i \frac{C_i}{1 - (f/f_i)^2} = 0

    and the eigenvalues of :math:`\mathrm{diag}(\omega_i^2) + v v^\mathsf{T}/C_0` with :math:`v_i^2 = 1/L_i`. With
    these

    .. math::

        Q_i = \frac{1}{R_i}\sqrt{\frac{L_i}{C_i}}, \qquad k_i = \sqrt{\frac{C_i}{C_0 + C_i}}, \qquad
        k_\mathrm{eff} = \sqrt{1 - (f_s/f_p)^2} .

    Both coupling factors are those of IEEE Std 176-1987 where a mode is alone and are then equal. Beside other modes
    the parallel resonance of the whole circuit is shifted by these, down to below the next series resonance, so that
    :math:`k_\mathrm{eff}` is no property of the mode, and :math:`k_i` is.

    Examples
    --------
    >>> from sonolube.models.actuator import ButterworthVanDyke, MotionalBranch, circuit_resonances
    >>> branch = MotionalBranch(resistance=50.0, inductance=50e-3, capacitance=1e-9)
    >>> found = circuit_resonances(ButterworthVanDyke(parallel_capacitance=4e-9, branches=(branch,)))
    >>> found.series_frequency.round().tolist(), found.parallel_frequency.round().tolist()  # fp/fs: root of 1 + 1/4
    ([22508.0], [25165.0])
    """
    modes = sorted(circuit.branches, key=lambda branch: -branch.inductance * branch.capacitance)
    inductance = np.array([branch.inductance for branch in modes])
    capacitance = np.array([branch.capacitance for branch in modes])
    squares = 1 / (inductance * capacitance)
    v = 1 / np.sqrt(inductance * circuit.parallel_capacitance)
    opened = np.linalg.eigvalsh(np.diag(squares) + np.multiply.outer(v, v)) if modes else squares
    return CircuitResonances(
        series_frequency=np.sqrt(squares) / (2 * np.pi),
        parallel_frequency=np.sqrt(opened) / (2 * np.pi),
        mechanical_quality_factor=np.array([_quality_factor(branch) for branch in modes]),
        coupling_factor=np.sqrt(
            [each.capacitance / (circuit.parallel_capacitance + each.capacitance) for each in modes]
        ),
        effective_coupling_factor=np.sqrt(np.maximum(1 - squares / opened, 0.0)),
    )


def _quality_factor(branch: MotionalBranch) -> float:
    """Quality factor of a motional branch."""
    lossless = branch.resistance == 0
    return math.inf if lossless else math.sqrt(branch.inductance / branch.capacitance) / branch.resistance
