"""Series and parallel resonances of a reduced model, and the effective coupling factor of each mode."""

import numpy as np

from sonolube.checks import Floats
from sonolube.models.fem.solver.reduction import ReducedModel

_RIGID = 1e-9  # squared frequency over the largest, up to which a mode counts as rigid-body mode
_UNCOUPLED = 1e-3  # squared coupling factor up to which a mode counts as not driven


def series_parallel_resonances(model: ReducedModel) -> tuple[Floats, Floats, Floats]:
    r"""Series and parallel resonances paired in order of frequency, and the effective coupling factors, without losses.

    Parameters
    ----------
    model : ReducedModel

    Returns
    -------
    series, parallel : ndarray, shape (k,)
        Short-circuit and open-circuit natural frequencies in Hz, zero for rigid-body modes. Beyond the modes requested
        for the reduction they are upper bounds only.
    coupling : ndarray, shape (k,)
        Effective coupling factors.

    Notes
    -----
    Squared angular frequencies are the eigenvalues of K and of

    .. math:: K + \frac{b\, b^\mathsf{T}}{C}

    By interlacing, one parallel resonance lies between each series resonance and the next, and

    .. math:: k_\mathrm{eff} = \sqrt{1 - (f_s/f_p)^2}

    See Also
    --------
    coupled_resonances : Pairs of the driven modes alone.
    """
    b, stiffness = model.drive.real, model.stiffness.real
    shorted, opened = (
        np.linalg.eigvalsh(matrix)
        for matrix in (stiffness, stiffness + np.outer(b, b) / model.clamped_capacitance.real)
    )
    rigid = shorted < _RIGID * shorted.max()
    return _frequencies_and_coupling(np.where(rigid, 0.0, shorted), np.where(rigid, 0.0, opened))


def coupled_resonances(model: ReducedModel) -> tuple[Floats, Floats, Floats]:
    """Series and parallel resonances of each mode, modes that the voltage does not drive being left unpaired.

    Parameters
    ----------
    model : ReducedModel

    Returns
    -------
    series, parallel : ndarray, shape (k,)
        Short-circuit and open-circuit natural frequencies in Hz, in order of the former. Both are the same for a mode
        that is not driven, even where it lies between the two frequencies of one that is.
    coupling : ndarray, shape (k,)
        Effective coupling factors, zero for modes that are not driven.

    Notes
    -----
    As `series_parallel_resonances`, with the eigenvalue problem of the open circuit restricted to modes of a squared
    coupling factor above 0.001.
    """
    squares, shapes = np.linalg.eigh(model.stiffness.real)
    drive = shapes.T @ model.drive.real
    capacitance = model.clamped_capacitance.real
    squares = np.where(squares > _RIGID * squares.max(), squares, 0.0)
    driven = drive**2 > _UNCOUPLED * capacitance * squares
    driven &= squares > 0
    own = drive[driven]
    opened = squares.copy()
    opened[driven] = np.linalg.eigvalsh(np.diag(squares[driven]) + np.outer(own, own) / capacitance)
    return _frequencies_and_coupling(squares, opened)


def _frequencies_and_coupling(shorted: Floats, opened: Floats) -> tuple[Floats, Floats, Floats]:
    """Frequencies in Hz from squared angular ones, and effective coupling factors."""
    ratio = np.divide(shorted, opened, out=np.ones_like(opened), where=opened > 0)
    coupling = np.sqrt(np.clip(1 - ratio, 0.0, 1.0))
    return np.sqrt(shorted) / (2 * np.pi), np.sqrt(opened) / (2 * np.pi), coupling
