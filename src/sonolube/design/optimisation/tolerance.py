"""How far what is built may be off what was drawn, and the worst or a quantile of it."""

from dataclasses import dataclass
from itertools import product

import numpy as np

from sonolube.checks import Floats, require_within

_DRAWN = 32


@dataclass(frozen=True, kw_only=True, slots=True)
class Deviation:
    """Factors between what is built and what was drawn.

    Parameters
    ----------
    stiffness : float
        On the stack's stiffness, its coupling factor as it was.
    mass : float
        On all masses of the structure.
    gain : float
        On the stroke per volt, and inverse on the damping.
    """

    stiffness: float = 1.0
    mass: float = 1.0
    gain: float = 1.0


NOMINAL = Deviation()
"""Built as drawn."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Tolerance:
    """Tolerances of a rig, all of one size.

    Parameters
    ----------
    built_tolerance : float
        Largest deviation for the worst case, standard deviation for a quantile. []
    quantile : float or None
        Share of built rigs that must do; None for the worst case. []
    seed : int
        Of the random numbers of a quantile.

    Raises
    ------
    InvalidInput
        If the tolerance lies outside 0 to 0.3, or the quantile outside 0.5 to 1.
    """

    built_tolerance: float
    quantile: float | None = None
    seed: int = 0

    def __post_init__(self) -> None:
        require_within(0.0, 0.3, built_tolerance=self.built_tolerance)
        if self.quantile is not None:
            require_within(0.5, 1.0, quantile=self.quantile)


def deviations(tolerance: Tolerance | None) -> tuple[Deviation, ...]:
    """Return the deviations that a design has to stand, the nominal one first.

    Parameters
    ----------
    tolerance : Tolerance or None

    Returns
    -------
    tuple of Deviation

    Notes
    -----
    Stiffness up with masses down moves the resonance up most, and the other way; low gain asks for the most voltage,
    high gain pulls most: four corners besides the nominal rig. A quantile draws 32 rigs from normal distributions.
    """
    if tolerance is None:
        return (NOMINAL,)
    t = tolerance.built_tolerance
    if tolerance.quantile is None:
        corners = [
            Deviation(stiffness=1 + shift * t, mass=1 - shift * t, gain=1 + gain * t)
            for shift, gain in product((-1, 1), (-1, 1))
        ]
        return (NOMINAL, *corners)
    drawn = np.random.default_rng(tolerance.seed).standard_normal((_DRAWN, 3)).clip(-3, 3) * t
    return (NOMINAL, *[Deviation(stiffness=1 + k, mass=1 + m, gain=1 + g) for k, m, g in drawn])


def over_deviations(values: Floats, tolerance: Tolerance | None) -> Floats:
    """Return the worst, or the quantile, of values over the deviations, which are the first axis; infinite is worst.

    Parameters
    ----------
    values : ndarray, shape (deviations, ...)
    tolerance : Tolerance or None

    Returns
    -------
    ndarray, shape (...)
    """
    if tolerance is None or tolerance.quantile is None:
        return np.asarray(values.max(axis=0))
    return np.asarray(np.quantile(values[1:], tolerance.quantile, axis=0, method="higher"))
