"""Frequency response of a piezoelectric body to a harmonic voltage, from a reduced model."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Complexes, Floats, require_positive
from sonolube.models.fem.solver.reduction import ReducedModel


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class HarmonicResponse:
    """Admittance and displacements per volt over frequency.

    Parameters
    ----------
    frequency : ndarray, shape (n,)
        Frequency of the voltage. [Hz]
    admittance : ndarray of complex, shape (n,)
        Current per volt. [S]
    displacement_per_volt : ndarray of complex, shape (o, n)
        Complex amplitude of each output per volt. [m/V]
    """

    frequency: Floats
    admittance: Complexes
    displacement_per_volt: Complexes


def harmonic_response(model: ReducedModel, *, frequency: ArrayLike) -> HarmonicResponse:
    r"""Frequency response of a reduced model: admittance and displacements per volt.

    Parameters
    ----------
    model : ReducedModel
    frequency : array_like, shape (n,)
        Frequency of the voltage. [Hz]

    Returns
    -------
    HarmonicResponse

    Raises
    ------
    InvalidInput
        If a frequency is not positive.

    Notes
    -----
    In the notation of `ReducedModel`

    .. math::

        Y = i\omega \left(C + b^\mathsf{T} (K - \omega^2)^{-1} b\right), \qquad
        \frac{x}{V} = d\, (K - \omega^2)^{-1} b
    """
    f = np.atleast_1d(require_positive(frequency=frequency))
    omega = 2 * np.pi * f
    dynamic_stiffness = model.stiffness - omega[:, np.newaxis, np.newaxis] ** 2 * np.eye(len(model.drive))
    forces = np.broadcast_to(model.drive[:, np.newaxis], (f.size, len(model.drive), 1))
    coordinates = np.linalg.solve(dynamic_stiffness, forces)[..., 0]
    return HarmonicResponse(
        frequency=f,
        admittance=1j * omega * (model.clamped_capacitance + coordinates @ model.drive),
        displacement_per_volt=np.asarray(model.participation @ coordinates.T, dtype=np.complex128),
    )
