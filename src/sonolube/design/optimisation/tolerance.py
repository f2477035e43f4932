"""Manufacturing tolerances: deviations of a built rig from its nominal design, by worst case or by Monte Carlo."""

from dataclasses import dataclass
from itertools import product

import numpy as np

from sonolube.checks import Floats, require_within

_SAMPLES = 32
_TRUNCATION = 3  # standard deviations at which the sampled deviations are cut off


@dataclass(frozen=True, kw_only=True, slots=True)
class Deviation:
    """Factors between the parameters of a built rig and those of its nominal design.

    Parameters
    ----------
    stiffness : float
        Factor of the stack's stiffness, at its nominal coupling factor.
    mass : float
        Factor of all masses of the structure.
    gain : float
        Factor of the stroke per volt, and reciprocal factor of the damping.
    """

    stiffness: float = 1.0
    mass: float = 1.0
    gain: float = 1.0


NOMINAL = Deviation()
"""No deviation: the nominal design."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Tolerance:
    """Relative tolerance of stiffness, masses and gain, and the criterion over the deviations within it.

    Parameters
    ----------
    manufacturing_tolerance : float
        Largest relative deviation for the worst case, standard deviation for a quantile. []
    quantile : float or None
        Fraction of manufactured rigs that must meet the requirements; None for the worst case. []
    seed : int
        Seed of the sampled deviations of a quantile.

    Raises
    ------
    InvalidInput
        If the tolerance lies outside 0 to 0.3, or the quantile outside 0.5 to 1.
    """

    manufacturing_tolerance: float
    quantile: float | None = None
    seed: int = 0

    def __post_init__(self) -> None:
        require_within(0.0, 0.3, manufacturing_tolerance=self.manufacturing_tolerance)
        if self.quantile is not None:
            require_within(0.5, 1.0, quantile=self.quantile)


def deviations(tolerance: Tolerance | None) -> tuple[Deviation, ...]:
    """Deviations at which a design is evaluated, the nominal one first.

    Parameters
    ----------
    tolerance : Tolerance or None
        None for the nominal design alone.

    Returns
    -------
    tuple of Deviation

    See Also
    --------
    worst_or_quantile

    Notes
    -----
    Worst case: four corners. Higher stiffness with lower masses raises the resonance frequency most, the reverse lowers
    it most; low gain requires the highest voltage, high gain causes the largest tension. Quantile: 32 deviations from
    independent normal distributions, truncated at three standard deviations.
    """
    if tolerance is None:
        return (NOMINAL,)
    t = tolerance.manufacturing_tolerance
    if tolerance.quantile is None:
        corners = [
            Deviation(stiffness=1 + shift * t, mass=1 - shift * t, gain=1 + gain * t)
            for shift, gain in product((-1, 1), (-1, 1))
        ]
        return (NOMINAL, *corners)
    sample = np.random.default_rng(tolerance.seed).standard_normal((_SAMPLES, 3)).clip(-_TRUNCATION, _TRUNCATION) * t
    return (NOMINAL, *[Deviation(stiffness=1 + k, mass=1 + m, gain=1 + g) for k, m, g in sample])


def worst_or_quantile(values: Floats, tolerance: Tolerance | None) -> Floats:
    """Maximum of values over the deviations, or their quantile over the sampled deviations.

    Parameters
    ----------
    values : ndarray, shape (deviations, ...)
        By the deviations of `deviations`, of which larger is worse; infinite where there is no result.
    tolerance : Tolerance or None

    Returns
    -------
    ndarray, shape (...)

    See Also
    --------
    deviations
    """
    if tolerance is None or tolerance.quantile is None:
        return np.asarray(values.max(axis=0))
    return np.asarray(np.quantile(values[1:], tolerance.quantile, axis=0, method="higher"))
