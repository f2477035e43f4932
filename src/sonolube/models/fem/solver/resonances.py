"""Series and parallel resonances of a reduced model, and the effective coupling factor of each mode."""

import numpy as np

from sonolube.checks import Floats
from sonolube.models.fem.solver.reduction import ReducedModel

_RIGID = 1e-9  # squared frequency over the largest, up to which a mode counts as rigid-body mode
_UNCOUPLED = 1e-3  # squared coupling factor up to which a mode counts as not driven


def coupled_resonances(model: ReducedModel) -> tuple[Floats, Floats, Floats]:
    r"""Series and parallel resonances of each mode, without losses; modes that the voltage does not drive have one.

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
    Squared angular frequencies are the eigenvalues of K and, for the driven modes alone, those of a squared coupling
    factor above 0.001, of

    .. math:: K + \frac{b\, b^\mathsf{T}}{C}

    By interlacing, one parallel resonance lies between each series resonance and the next, and

    .. math:: k_\mathrm{eff} = \sqrt{1 - (f_s/f_p)^2}
    """
    squares, shapes = undamped_modes(model)
    drive = shapes.T @ model.drive.real
    capacitance = model.clamped_capacitance.real
    driven = drive**2 > _UNCOUPLED * capacitance * squares
    driven &= squares > 0
    own = drive[driven]
    opened = squares.copy()
    opened[driven] = np.linalg.eigvalsh(np.diag(squares[driven]) + np.outer(own, own) / capacitance)
    ratio = np.divide(squares, opened, out=np.ones_like(opened), where=opened > 0)
    coupling = np.sqrt(np.clip(1 - ratio, 0.0, 1.0))
    return np.sqrt(squares) / (2 * np.pi), np.sqrt(opened) / (2 * np.pi), coupling


def undamped_modes(model: ReducedModel) -> tuple[Floats, Floats]:
    """Squared angular frequencies of the modes without losses, zero for rigid-body ones, and shapes in columns."""
    squares, shapes = np.linalg.eigh(model.stiffness.real)
    return np.where(squares > _RIGID * squares.max(), squares, 0.0), shapes
