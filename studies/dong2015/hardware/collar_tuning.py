"""Model updating of the collar: its main resonance, and dimensions fitted to resonances."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import least_squares

from dong2015.hardware.collar import Collar
from dong2015.hardware.collar_analysis import ELEMENT_SIZE, ORDER, reduced_collar_model
from sonolube.checks import Floats
from sonolube.errors import InvalidInput
from sonolube.models.fem import ReducedModel, coupled_resonances

LOWEST_FREQUENCY, HIGHEST_FREQUENCY = 15e3, 40e3
"""Frequency range of the main resonance in Hz; D reports none outside it."""

_STEP = 0.04  # relative change of a dimension in a difference quotient, large against the scatter between meshes
_FREQUENCY_SCALE = 0.002  # relative deviation of a frequency of unit weight in the fit
_DIMENSION_SCALE = 0.1  # relative change of a dimension of unit weight
_SPURIOUS_SCALE = 0.5  # spurious coupling ratio of unit weight


@dataclass(frozen=True, kw_only=True, slots=True)
class Resonance:
    """Resonance in the impedance of a collar.

    Parameters
    ----------
    series_frequency : float
        Frequency of least impedance. [Hz]
    parallel_frequency : float
        Frequency of greatest impedance. [Hz]
    coupling_factor : float
        Effective coupling factor. []
    """

    series_frequency: float
    parallel_frequency: float
    coupling_factor: float


def resonances_in_range(model: ReducedModel, *, least_coupling: float) -> tuple[Resonance, ...]:
    """Resonances from 15 to 40 kHz with at least a given effective coupling factor, in order of frequency.

    Parameters
    ----------
    model : ReducedModel
    least_coupling : float
        Least effective coupling factor.

    Returns
    -------
    tuple of Resonance
    """
    found = zip(*(values.tolist() for values in coupled_resonances(model)), strict=True)
    return tuple(
        Resonance(series_frequency=low, parallel_frequency=high, coupling_factor=k)
        for low, high, k in found
        if LOWEST_FREQUENCY < low < HIGHEST_FREQUENCY and k >= least_coupling
    )


def main_resonance(model: ReducedModel) -> Resonance:
    """Resonance from 15 to 40 kHz with the largest effective coupling factor, the most prominent in the impedance.

    Parameters
    ----------
    model : ReducedModel

    Returns
    -------
    Resonance
    """
    return max(resonances_in_range(model, least_coupling=0.0), key=lambda found: found.coupling_factor)


def spurious_coupling_ratio(model: ReducedModel) -> float:
    r"""Strength of the spurious resonances from 15 to 40 kHz relative to the main one.

    Parameters
    ----------
    model : ReducedModel

    Returns
    -------
    float
        Zero where the main resonance is the only one.

    Notes
    -----
    With the effective coupling factor k of the main resonance and those of the others

    .. math:: \frac{1}{k} \sqrt{\sum_i k_i^2}
    """
    squares = sorted(found.coupling_factor**2 for found in resonances_in_range(model, least_coupling=0.0))
    return float(np.sqrt(sum(squares[:-1]) / squares[-1]))


def tuned_collar(
    guess: Collar,
    *,
    closed_frequency: float,
    open_frequency: float,
    bounds: Mapping[str, tuple[float, float]],
    element_size: float = ELEMENT_SIZE,
    order: int = ORDER,
) -> Collar:
    r"""Collar nearest to an initial one with given main resonances closed and open, by regularised least squares.

    Parameters
    ----------
    guess : Collar
        Initial dimensions.
    closed_frequency, open_frequency : float
        Main resonance with the top and without it, in Hz.
    bounds : mapping of str to tuple of two float
        Least and greatest value in m of each dimension to be fitted.
    element_size : float
        Largest edge of an element. [m]
    order : int
        Degree of the polynomials in an element, from 2 to 8.

    Returns
    -------
    Collar

    Raises
    ------
    InvalidInput
        If no dimension is to be fitted, or an initial one lies outside its bounds.

    Notes
    -----
    Two frequencies cannot determine more than two dimensions, so that their changes are penalised. Minimised is

    .. math::

        \sum_{c} \left(\frac{f_c/f_c^* - 1}{0.002}\right)^2 + \left(\frac{s}{0.5}\right)^2
        + \sum_i \left(\frac{\ln x_i/x_i^0}{0.1}\right)^2

    over the cases c with and without the top, with the spurious coupling ratio s of the closed collar, as D observed
    one resonance. Of the many sets of dimensions that have these resonances the result is the nearest to the initial
    one, not necessarily the real one. The Jacobian is that at the initial dimensions throughout, as these change by a
    few percent only.
    """
    names = tuple(bounds)
    if not names:
        raise InvalidInput("no dimension to fit: bounds name no dimension")
    start = np.array([getattr(guess, name) for name in names])
    low, high = np.log(np.array([bounds[name] for name in names]).T / start)
    if np.any(low >= 0) or np.any(high <= 0):
        raise InvalidInput("each initial dimension must lie within its bounds")

    def residuals(changes: Floats) -> Floats:
        collar = _scaled(guess, dict(zip(names, np.exp(changes).tolist(), strict=True)))
        closed, opened = (
            reduced_collar_model(collar, open_top=is_open, element_size=element_size, order=order)
            for is_open in (False, True)
        )
        found = np.array([main_resonance(model).series_frequency for model in (closed, opened)])
        target = np.array([closed_frequency, open_frequency])
        return np.concatenate(
            [
                (found / target - 1) / _FREQUENCY_SCALE,
                [spurious_coupling_ratio(closed) / _SPURIOUS_SCALE],
                changes / _DIMENSION_SCALE,
            ]
        )

    initial = np.zeros(len(names))
    at_initial = residuals(initial)
    steps = np.diag(np.where(high > _STEP, _STEP, -_STEP))
    jacobian = np.column_stack([(residuals(step) - at_initial) / step.sum() for step in steps])
    solution = least_squares(
        lambda changes: residuals(changes) if changes.any() else at_initial,
        initial,
        jac=lambda _: jacobian,
        bounds=(low, high),
        xtol=1e-2,
        ftol=1e-2,
    )
    return _scaled(guess, dict(zip(names, np.exp(solution.x).tolist(), strict=True)))


def _scaled(collar: Collar, factors: Mapping[str, float]) -> Collar:
    """Collar with some dimensions multiplied by factors."""
    return replace(collar, **{name: getattr(collar, name) * factor for name, factor in factors.items()})
