"""Which dimensions of a collar set its resonance, and the set nearest to a first guess that brings it where it was."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import least_squares

from sonolube.checks import Floats
from sonolube.dong2015.collar import Collar
from sonolube.dong2015.collar_analysis import ELEMENT_SIZE, ORDER, reduced_collar_model
from sonolube.errors import InvalidInput
from sonolube.fem.electromechanical_model import coupled_resonances
from sonolube.fem.solver.harmonic_analysis import ReducedModel

LOWEST_FREQUENCY, HIGHEST_FREQUENCY = 15e3, 40e3
"""Frequencies between which a resonance may be the main one, in Hz; D tells of none outside."""

_STEP = 0.04  # relative change of a dimension, large enough for the unevenness of free meshes to matter little
_ACCURACY = 0.002  # relative deviation of a frequency that weighs as much as a dimension's change by its freedom
_FREEDOM = 0.1
_RIVALRY = 0.5


@dataclass(frozen=True, kw_only=True, slots=True)
class Resonance:
    """One resonance seen in the impedance.

    Parameters
    ----------
    series_frequency : float
        Where the impedance is lowest. [Hz]
    parallel_frequency : float
        Where it is highest. [Hz]
    coupling_factor : float
        Effective coupling factor. []
    """

    series_frequency: float
    parallel_frequency: float
    coupling_factor: float


def resonances_in_range(model: ReducedModel, *, least_coupling: float) -> tuple[Resonance, ...]:
    """Return the resonances from 15 to 40 kHz with at least some effective coupling factor, in order of frequency.

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
    """Return the resonance from 15 to 40 kHz with the largest effective coupling factor, which impedance shows best.

    Parameters
    ----------
    model : ReducedModel

    Returns
    -------
    Resonance
    """
    return max(resonances_in_range(model, least_coupling=0.0), key=lambda found: found.coupling_factor)


def spurious_coupling_ratio(model: ReducedModel) -> float:
    """Return how strong the other resonances from 15 to 40 kHz are beside the main one.

    Parameters
    ----------
    model : ReducedModel

    Returns
    -------
    float
        Root of the sum of their squared coupling factors, over the main one's: zero where there is one pair only.
    """
    squares = sorted(found.coupling_factor**2 for found in resonances_in_range(model, least_coupling=0.0))
    return float(np.sqrt(sum(squares[:-1]) / squares[-1]))


def frequency_sensitivities(
    collar: Collar,
    *,
    dimensions: Sequence[str],
    open_top: bool = False,
    element_size: float = ELEMENT_SIZE,
    order: int = ORDER,
) -> dict[str, float]:
    """Return by how many percent the main resonance rises for each percent that a dimension grows.

    Parameters
    ----------
    collar : Collar
    dimensions : sequence of str
        Their names.
    open_top : bool
        Without the top.
    element_size : float
        Largest edge of an element. [m]
    order : int
        Degree of the polynomials in an element, from 2 to 8.

    Returns
    -------
    dict of str to float
        Central differences over eight percent, certain to some 0.01 where the change is even over them.
    """

    def frequency(name: str, factor: float) -> float:
        changed = _scaled(collar, {name: factor})
        return main_resonance(
            reduced_collar_model(changed, open_top=open_top, element_size=element_size, order=order)
        ).series_frequency

    return {
        name: float(np.log(frequency(name, 1 + _STEP) / frequency(name, 1 - _STEP)) / np.log((1 + _STEP) / (1 - _STEP)))
        for name in dimensions
    }


def tuned_collar(
    guess: Collar,
    *,
    closed_frequency: float,
    open_frequency: float,
    bounds: Mapping[str, tuple[float, float]],
    element_size: float = ELEMENT_SIZE,
    order: int = ORDER,
) -> Collar:
    """Return the collar nearest to a guess whose main resonance is at one frequency closed, at another without its top.

    Parameters
    ----------
    guess : Collar
        What the dimensions are supposed to be.
    closed_frequency, open_frequency : float
        Main resonance with the top and without it, in Hz.
    bounds : mapping of str to tuple of two float
        The dimensions that may change, each with its least and greatest value in m.
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
        If nothing may change, or a guess lies outside its bounds.

    Notes
    -----
    Two frequencies cannot determine more than two dimensions: the sum of squares minimised holds both relative
    deviations of frequency over 0.2 %, the rivalry of other resonances of the closed collar over a half, since D saw
    one, and all relative changes of dimensions over 10 %. Of many sets that meet the frequencies it finds the one
    nearest to the guess; nothing says that it is the real one. Slopes are those at the guess all the way, since it
    changes by a few percent.
    """
    names = tuple(bounds)
    if not names:
        raise InvalidInput("nothing may change: bounds name no dimension")
    start = np.array([getattr(guess, name) for name in names])
    low, high = np.log(np.array([bounds[name] for name in names]).T / start)
    if np.any(low >= 0) or np.any(high <= 0):
        raise InvalidInput("each dimension of the guess must lie within its bounds")

    def residuals(changes: Floats) -> Floats:
        collar = _scaled(guess, dict(zip(names, np.exp(changes).tolist(), strict=True)))
        closed, opened = (
            reduced_collar_model(collar, open_top=is_open, element_size=element_size, order=order)
            for is_open in (False, True)
        )
        found = np.array([main_resonance(model).series_frequency for model in (closed, opened)])
        wanted = np.array([closed_frequency, open_frequency])
        return np.concatenate(
            [(found / wanted - 1) / _ACCURACY, [spurious_coupling_ratio(closed) / _RIVALRY], changes / _FREEDOM]
        )

    still = np.zeros(len(names))
    here = residuals(still)
    steps = np.diag(np.where(high > _STEP, _STEP, -_STEP))
    slopes = np.column_stack([(residuals(step) - here) / step.sum() for step in steps])
    solution = least_squares(residuals, still, jac=lambda _: slopes, bounds=(low, high), xtol=1e-2, ftol=1e-2)
    return _scaled(guess, dict(zip(names, np.exp(solution.x).tolist(), strict=True)))


def _scaled(collar: Collar, factors: Mapping[str, float]) -> Collar:
    return replace(collar, **{name: getattr(collar, name) * factor for name, factor in factors.items()})
